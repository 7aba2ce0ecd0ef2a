//! Point lights.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{Density, Rgb, SolidAnglePdf, Spectrum, warp};

/// Point light, with the irradiance E = I / d² on a plane perpendicular to the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position (m).
    pub position: DVec3,
    /// Intensity I, the same in all directions [W·sr⁻¹].
    pub intensity: Rgb,
}

impl Point {
    pub(super) fn sample(&self, from: Vec3) -> Option<LightLiSample> {
        let (wi, d2) = direction_and_square(from, self.position.as_vec3())?;
        Some(LightLiSample {
            wi,
            li: Spectrum::from_illuminant(self.intensity) / d2,
            density: Density::Delta,
            target: ShadowTarget::Point(self.position.as_vec3()),
        })
    }

    /// A ray in a uniformly distributed direction.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let (position, w) = (self.position.as_vec3(), warp::uniform_sphere(cx.direction));
        cx.ray_from_position(position, w, Spectrum::from_illuminant(self.intensity), self.emission_pdf())
    }

    /// Density 1 / 4π of an emitted direction.
    pub(super) fn emission_pdf(&self) -> SolidAnglePdf {
        SolidAnglePdf::new(warp::uniform_sphere_pdf())
    }

    /// Mean intensity of the colours [W·sr⁻¹].
    pub(super) fn intensity(&self) -> f64 {
        f64::from(Spectrum::from_illuminant(self.intensity).average())
    }

    /// Flux Φ = 4π I (W).
    pub(super) fn power(&self) -> f64 {
        4.0 * PI * self.intensity()
    }
}

/// Unit direction from `from` to `to`, and the squared distance (m²); `None` if the points coincide.
pub(super) fn direction_and_square(from: Vec3, to: Vec3) -> Option<(Vec3, f32)> {
    let line = to - from;
    let d2 = line.length_squared();
    (d2 > 0.0).then(|| (line / d2.sqrt(), d2))
}
