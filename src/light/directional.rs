//! Light from one direction, like the sun's.

use std::f64::consts::PI;

use glam::Vec3;

use super::{Offer, Target};
use crate::math::{Density, Spectrum};

/// Parallel light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// The way the light travels; unit.
    pub direction: Vec3,
    /// On a plane across the light [W·m⁻²].
    pub irradiance: Spectrum,
}

impl Directional {
    pub(super) fn sample(&self) -> Option<Offer> {
        Some(Offer { wi: -self.direction, li: self.irradiance, density: Density::Delta, target: Target::Infinity })
    }

    /// Φ = π R² E: what falls on a scene of radius R.
    pub(super) fn power(&self, radius: f64) -> f64 {
        PI * radius * radius * f64::from(self.irradiance.average())
    }
}
