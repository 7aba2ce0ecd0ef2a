//! A checkerboard.

use glam::{DVec3, Vec3};

use super::Texture;
use crate::math::{Spectrum, Transform};
use crate::shape::SurfacePoint;

/// Cells of size 1 in the space of the texture; `even` where ⌊x⌋ + ⌊y⌋ + ⌊z⌋ is even.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    pub even: Texture,
    pub odd: Texture,
    /// Cells per unit, along each axis.
    pub scale: Vec3,
    pub space: Space,
}

/// Where a texture lives.
#[derive(Clone, Debug, PartialEq)]
pub enum Space {
    /// The surface's own coordinates, (u, v, 0).
    Uv,
    /// The world, through a transform from (recentred) world to texture space.
    World(Transform),
}

impl Checker {
    pub fn at(&self, point: &SurfacePoint) -> Spectrum {
        let q = match &self.space {
            Space::Uv => point.uv.extend(0.0).as_dvec3(),
            // Just behind the surface, by the error bound of the point: a wall between two cells shows one of them.
            Space::World(to_texture) => to_texture.point((point.p - point.ng * point.offset).as_dvec3()),
        };
        let cell = (q * self.scale.as_dvec3()).map(f64::floor);
        if is_even(cell) { self.even.at(point) } else { self.odd.at(point) }
    }

    pub(super) fn recentred(self, origin: DVec3) -> Checker {
        let space = match self.space {
            Space::Uv => Space::Uv,
            Space::World(to_texture) => Space::World(Transform::translate(origin).map_or(to_texture, |back| back.then(&to_texture))),
        };
        Checker { even: self.even.recentred(origin), odd: self.odd.recentred(origin), scale: self.scale, space }
    }
}

/// Of the sum of three whole numbers.
fn is_even(cell: DVec3) -> bool {
    (cell.x + cell.y + cell.z).rem_euclid(2.0) < 1.0
}
