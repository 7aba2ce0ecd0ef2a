//! The coordinates of textures.

use glam::DVec3;

use crate::math::Transform;
use crate::shape::SurfacePoint;

/// Where a texture lives.
#[derive(Clone, Debug, PartialEq)]
pub enum Space {
    /// The surface's own coordinates, (u, v, 0).
    Uv,
    /// The world, through a transform from (recentred) world to texture space.
    World(Transform),
}

impl Space {
    pub fn coordinates(&self, point: &SurfacePoint) -> DVec3 {
        match self {
            Space::Uv => point.uv.extend(0.0).as_dvec3(),
            // Just behind the surface, by the error bound of the point: a wall between two cells shows one of them.
            Space::World(to_texture) => to_texture.point((point.p - point.ng * point.offset).as_dvec3()),
        }
    }

    /// The same space after the world has moved by −`origin`.
    pub(super) fn recentred(self, origin: DVec3) -> Space {
        match self {
            Space::Uv => Space::Uv,
            Space::World(to_texture) => Space::World(Transform::translate(origin).map_or(to_texture, |back| back.then(&to_texture))),
        }
    }
}
