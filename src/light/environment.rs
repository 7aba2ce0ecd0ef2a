//! Environment light, infinitely far away.

use std::f64::consts::PI;

use glam::{Vec2, Vec3};

use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{Density, Rgb, SolidAnglePdf, Spectrum, warp};

/// Environment with the same radiance from all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Radiance [W·m⁻²·sr⁻¹].
    pub radiance: Rgb,
}

impl Environment {
    /// Radiance that arrives from the direction `_direction`.
    pub fn radiance(&self, _direction: Vec3) -> Spectrum {
        Spectrum::from_illuminant(self.radiance)
    }

    pub(super) fn sample(&self, u: Vec2) -> Option<LightLiSample> {
        let wi = warp::uniform_sphere(u);
        Some(LightLiSample { wi, li: self.radiance(wi), density: Density::Smooth(self.pdf(wi)), target: ShadowTarget::Infinity })
    }

    /// Density 1 / 4π of a sampled direction.
    pub(super) fn pdf(&self, _wi: Vec3) -> SolidAnglePdf {
        SolidAnglePdf::new((0.25 / PI) as f32)
    }

    /// A ray through the scene in a uniformly distributed direction.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let wi = warp::uniform_sphere(cx.direction);
        cx.ray_from_infinity(-wi, self.radiance(wi), Density::Smooth(self.pdf(wi)))
    }

    /// Flux Φ = π R² · 4π L through a scene of radius R (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * f64::from(Spectrum::from_illuminant(self.radiance).average())
    }
}
