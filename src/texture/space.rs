//! The coordinates that textures vary over.

use glam::{DVec3, Vec3};

use super::footprint::{TextureContext, width};
use crate::math::Transform;

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
    pub fn coordinates(&self, at: &TextureContext) -> DVec3 {
        match self {
            Space::Uv => at.uv.extend(0.0).as_dvec3(),
            Space::World(to_texture) => to_texture.point(at.p.as_dvec3()),
        }
    }

    /// The widths along the coordinates of the box that has the variance of the footprint along each; `None` without a footprint.
    ///
    /// Textures that are turned in the world leave out the covariances.
    pub(super) fn widths(&self, at: &TextureContext) -> Option<DVec3> {
        let footprint = at.footprint.as_ref()?;
        Some(match self {
            Space::Uv => width(footprint.uv.map(|side| side.extend(0.0))),
            Space::World(to_texture) => {
                let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| to_texture.vector((axis * footprint.widths).as_dvec3()));
                (x * x + y * y + z * z).map(f64::sqrt)
            }
        })
    }

    /// The space after the world has been moved by −`origin`.
    pub(super) fn recentred(self, origin: DVec3) -> Space {
        match self {
            Space::Uv => Space::Uv,
            Space::World(to_texture) => Space::World(Transform::translate(origin).map_or(to_texture, |back| back.then(&to_texture))),
        }
    }
}
