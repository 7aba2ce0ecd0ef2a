//! A sun: a disk of constant radiance, infinitely far away.

use std::f64::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{Density, Frame, Local, Rgb, SolidAnglePdf, Spectrum, float, warp};

/// Light from a small disk in the sky. Its shadows have soft edges, mirrors show it, and the camera sees it.
///
/// Tests: a_sun_lights_as_its_solid_angle_says, densities_of_directions_integrate_to_one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit direction in which the light of its middle travels.
    pub direction: Vec3,
    /// Radiance of the disk [W·m⁻²·sr⁻¹].
    pub radiance: Rgb,
    /// 1 − cos α of the half angle α under which the disk is seen, at most 1.
    pub one_minus_cos: f32,
}

impl Sun {
    /// A sun.
    ///
    /// - `direction`: unit direction in which the light of its middle travels
    /// - `radiance`: radiance L of the disk, which makes an irradiance of π L sin² α [W·m⁻²·sr⁻¹]
    /// - `half_angle`: half of the angle under which the disk is seen, in degrees, in (0, 90]
    pub fn new(direction: Vec3, radiance: Rgb, half_angle: f64) -> Sun {
        let sin_of_half = float::sin_cos_degrees(half_angle / 2.0).0;
        Sun { direction, radiance, one_minus_cos: (2.0 * sin_of_half * sin_of_half) as f32 }
    }

    /// A sun of a given irradiance, for red, green and blue: E = π L sin² α [W·m⁻²].
    pub fn of_irradiance(direction: Vec3, irradiance: [f64; 3], half_angle: f64) -> Sun {
        let sin = float::sin_cos_degrees(half_angle).0;
        Sun::new(direction, Rgb::from_f64(irradiance.map(|irradiance| irradiance / (PI * sin * sin))), half_angle)
    }

    /// Radiance that arrives from a direction.
    pub fn radiance(&self, direction: Vec3) -> Spectrum {
        if self.is_seen_in(direction) { Spectrum::from_illuminant(self.radiance) } else { Spectrum::BLACK }
    }

    /// Samples a direction, uniformly over the disk.
    pub(super) fn sample(&self, u: Vec2) -> Option<LightLiSample> {
        let li = Spectrum::from_illuminant(self.radiance);
        Some(LightLiSample { wi: self.towards(u), li, density: Density::Smooth(self.uniform()), target: ShadowTarget::Infinity })
    }

    /// Density of the direction `wi` towards the sun, sampled or emitted.
    pub(super) fn pdf(&self, wi: Vec3) -> SolidAnglePdf {
        if self.is_seen_in(wi) { self.uniform() } else { SolidAnglePdf::ZERO }
    }

    /// A ray through the scene.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        cx.ray_from_infinity(-self.towards(cx.direction), Spectrum::from_illuminant(self.radiance), Density::Smooth(self.uniform()))
    }

    /// Irradiance on a plane perpendicular to the light: E = π L sin² α [W·m⁻²], the mean of the colour components.
    pub(super) fn irradiance(&self) -> f64 {
        let height = f64::from(self.one_minus_cos);
        PI * height * (2.0 - height) * f64::from(Spectrum::from_illuminant(self.radiance).average())
    }

    /// Sine of the half angle of the disk.
    pub(super) fn sine(&self) -> f32 {
        (self.one_minus_cos * (2.0 - self.one_minus_cos)).sqrt()
    }

    /// Flux Φ = π R² · Ω L through a scene of radius R, with the solid angle Ω (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        let solid_angle = TAU * f64::from(self.one_minus_cos);
        PI * radius * radius * solid_angle * f64::from(Spectrum::from_illuminant(self.radiance).average())
    }

    fn towards(&self, u: Vec2) -> Vec3 {
        Frame::around(-self.direction).to_world(Local(warp::uniform_cone(u, self.one_minus_cos))).normalize()
    }

    fn uniform(&self) -> SolidAnglePdf {
        SolidAnglePdf::new(warp::uniform_cone_pdf(self.one_minus_cos))
    }

    fn is_seen_in(&self, direction: Vec3) -> bool {
        // By the distance of the ends of both vectors, |a − b|² = 2 (1 − cos), because the cosine itself is rounded too much.
        (direction + self.direction).length_squared() <= 2.0 * self.one_minus_cos
    }
}
