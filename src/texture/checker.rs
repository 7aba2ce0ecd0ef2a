//! A checkerboard.

use glam::{DVec3, Vec3};

use super::{Space, Texture};
use crate::math::Rgb;
use crate::shape::SurfacePoint;

/// A checkerboard: `even` where ⌊x⌋ + ⌊y⌋ + ⌊z⌋ is even, in cells of the texture's space.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// The colour of the even cells.
    pub even: Texture,
    /// The colour of the odd cells.
    pub odd: Texture,
    /// Cells per unit of the coordinates, along each axis.
    pub scale: Vec3,
    /// The coordinates of the cells.
    pub space: Space,
}

impl Checker {
    /// Looks up the colour at a point.
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        let cell = (self.space.coordinates(point) * self.scale.as_dvec3()).map(f64::floor);
        if is_even(cell) { self.even.at(point) } else { self.odd.at(point) }
    }

    pub(super) fn recentred(self, origin: DVec3) -> Checker {
        let space = self.space.recentred(origin);
        Checker { even: self.even.recentred(origin), odd: self.odd.recentred(origin), scale: self.scale, space }
    }
}

/// Whether the sum of three whole numbers is even.
fn is_even(cell: DVec3) -> bool {
    (cell.x + cell.y + cell.z).rem_euclid(2.0) < 1.0
}
