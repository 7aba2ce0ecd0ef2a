//! Parallel light, such as sunlight.

use std::f64::consts::PI;

use glam::Vec3;

use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{Density, Rgb, Spectrum};

/// Parallel light from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit direction in which the light travels.
    pub direction: Vec3,
    /// Irradiance on a plane perpendicular to the light [W·m⁻²].
    pub irradiance: Rgb,
}

impl Directional {
    pub(super) fn sample(&self) -> Option<LightLiSample> {
        Some(LightLiSample {
            wi: -self.direction,
            li: Spectrum::from_illuminant(self.irradiance),
            density: Density::Delta,
            target: ShadowTarget::Infinity,
        })
    }

    /// A ray through the scene.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        cx.ray_from_infinity(self.direction, Spectrum::from_illuminant(self.irradiance), Density::Delta)
    }

    /// Flux Φ = π R² E through a scene of radius R (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        PI * radius * radius * f64::from(Spectrum::from_illuminant(self.irradiance).average())
    }
}
