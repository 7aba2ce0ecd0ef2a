//! A checkerboard.

use glam::{DVec3, Vec3};

use super::{Space, Texture};
use crate::math::Rgb;
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

impl Checker {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        let cell = (self.space.coordinates(point) * self.scale.as_dvec3()).map(f64::floor);
        if is_even(cell) { self.even.at(point) } else { self.odd.at(point) }
    }

    pub(super) fn recentred(self, origin: DVec3) -> Checker {
        let space = self.space.recentred(origin);
        Checker { even: self.even.recentred(origin), odd: self.odd.recentred(origin), scale: self.scale, space }
    }
}

/// Of the sum of three whole numbers.
fn is_even(cell: DVec3) -> bool {
    (cell.x + cell.y + cell.z).rem_euclid(2.0) < 1.0
}
