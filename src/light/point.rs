//! A light without extent.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{Offer, Target};
use crate::math::{Density, Spectrum};

/// E = I / d² on a plane across the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub position: DVec3,
    /// I, the same into every direction [W·sr⁻¹].
    pub intensity: Spectrum,
}

impl Point {
    pub(super) fn sample(&self, from: Vec3) -> Option<Offer> {
        let (wi, d2) = direction_and_square(from, self.position.as_vec3())?;
        Some(Offer { wi, li: self.intensity / d2, density: Density::Delta, target: Target::Free(self.position.as_vec3()) })
    }

    /// Φ = 4π I
    pub(super) fn power(&self) -> f64 {
        4.0 * PI * f64::from(self.intensity.average())
    }
}

/// The unit direction from `from` to `to`, and their squared distance (m²); `None` where they coincide.
pub(super) fn direction_and_square(from: Vec3, to: Vec3) -> Option<(Vec3, f32)> {
    let line = to - from;
    let d2 = line.length_squared();
    (d2 > 0.0).then(|| (line / d2.sqrt(), d2))
}
