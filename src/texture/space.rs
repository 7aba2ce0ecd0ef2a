//! The coordinates that textures vary over.

use glam::DVec3;

use crate::math::Transform;
use crate::shape::SurfacePoint;

/// The coordinates that a texture varies over.
#[derive(Clone, Debug, PartialEq)]
pub enum Space {
    /// The surface's texture coordinates, (u, v, 0).
    Uv,
    /// The position in the world, by the transform from world space (after recentring) to texture space.
    World(Transform),
}

impl Space {
    /// The coordinates of a point of a surface.
    pub fn coordinates(&self, point: &SurfacePoint) -> DVec3 {
        match self {
            Space::Uv => point.uv.extend(0.0).as_dvec3(),
            // The point is moved behind the surface by its error bound, so that a wall on the border of two cells shows only one of them.
            Space::World(to_texture) => to_texture.point((point.p - point.ng * point.offset).as_dvec3()),
        }
    }

    /// The space after the world has been moved by −`origin`.
    pub(super) fn recentred(self, origin: DVec3) -> Space {
        match self {
            Space::Uv => Space::Uv,
            Space::World(to_texture) => Space::World(Transform::translate(origin).map_or(to_texture, |back| back.then(&to_texture))),
        }
    }
}
