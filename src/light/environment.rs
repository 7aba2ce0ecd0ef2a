//! Environment light, infinitely far away.

use std::f64::consts::PI;

use glam::{Vec2, Vec3};

use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, LightSampleContext, ShadowTarget};
use crate::math::{Density, Frame, Local, Rgb, SolidAnglePdf, Spectrum, warp};

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

    /// Samples a direction for a point.
    pub(super) fn sample(&self, cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        let wi = flat_sample(cx, u);
        Some(LightLiSample { wi, li: self.radiance(wi), density: Density::Smooth(flat_pdf(cx, wi)), target: ShadowTarget::Infinity })
    }

    /// Density of a sampled direction.
    pub(super) fn pdf(&self, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        flat_pdf(cx, wi)
    }

    /// Density 1 / 4π of an emitted direction.
    pub(super) fn emission_pdf(&self) -> SolidAnglePdf {
        SolidAnglePdf::new(warp::uniform_sphere_pdf())
    }

    /// A ray through the scene in a uniformly distributed direction.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let wi = warp::uniform_sphere(cx.direction);
        cx.ray_from_infinity(-wi, self.radiance(wi), Density::Smooth(self.emission_pdf()))
    }

    /// Flux Φ = π R² · 4π L through a scene of radius R (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * f64::from(Spectrum::from_illuminant(self.radiance).average())
    }
}

/// Samples a direction for light that is the same in all directions: in proportion to the cosine on the side of the viewer where only that
/// side counts, else uniformly.
pub(super) fn flat_sample(cx: &LightSampleContext, u: Vec2) -> Vec3 {
    match cx.is_one_sided() {
        true => Frame::around(cx.ns).to_world(Local(warp::cosine_hemisphere(u))).normalize(),
        false => warp::uniform_sphere(u),
    }
}

/// Density of a direction that [`flat_sample`] samples.
pub(super) fn flat_pdf(cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
    SolidAnglePdf::new(match cx.is_one_sided() {
        true => warp::cosine_hemisphere_pdf(Vec3::Z * cx.ns.dot(wi)),
        false => warp::uniform_sphere_pdf(),
    })
}
