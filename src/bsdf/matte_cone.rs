//! Reflection into a cone about the mirror direction.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, Lobe, ScatteringModel, TransportMode, lobe_effects};
use crate::effects::Effects;
use crate::math::{Density, Frame, Local, SolidAnglePdf, Spectrum, float, fresnel, warp};

/// Reflection with a uniform distribution over a cone about the mirror direction.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),  p = [wi in cone] / Ω + [wi's mirror image in cone] / Ω,  Ω = 2π (1 − cos α),  α = m · 90°
///
/// Directions below the surface are mirrored to above it, so that no energy is lost: albedo = ρ. m = 0 is a mirror; m = 1 is *not*
/// Lambertian, because the cone follows the mirror direction at every angle. The model is not reciprocal.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: uniform in the cone, so that weight = ρ
///
/// Source: the "mattness" of the Aalto path tracer, a student's work. Tests: own_models_are_proved, cone_is_not_reciprocal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatteCone {
    /// ρ, the share of light that is reflected: [0, 1].
    pub color: Spectrum,
    /// m, the half angle of the cone over 90°: [0, 1].
    pub mattness: f32,
}

impl ScatteringModel for MatteCone {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        self.color * self.pdf(wo, wi).get()
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        if self.is_mirror() || !wo.same_side(wi) {
            return SolidAnglePdf::ZERO;
        }
        let mirror = Local(fresnel::reflect(wo.0));
        let below = Local::new(wi.0.x, wi.0.y, -wi.0.z);
        let ways = [wi, below].into_iter().filter(|&w| self.in_cone(mirror, w)).count();
        SolidAnglePdf::new(ways as f32 / (TAU * self.one_minus_cos()))
    }

    #[inline(never)]
    fn sample(&self, wo: Local, _choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        if self.is_mirror() {
            return self.delta_lobe(wo);
        }
        let mirror = fresnel::reflect(wo.0);
        let w = Frame::around(mirror).to_world(Local(warp::uniform_cone(u, self.one_minus_cos())));
        let wi = Local(w.with_z(w.z.abs().copysign(wo.cos())));
        // At least one direction of the cone leads here by construction, even if rounding at the rim of the cone says otherwise.
        let density = SolidAnglePdf::new(self.pdf(wo, wi).get().max(1.0 / (TAU * self.one_minus_cos())));
        let found = !self.color.is_black() && wo.same_side(wi);
        found.then_some(BsdfSample { wi, weight: self.color, density: Density::Smooth(density), lobe: Lobe::Reflection, eta: 1.0 })
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, _mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [self.delta_lobe(wo), None]
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        !self.is_mirror()
    }

    fn reciprocal(&self) -> bool {
        self.is_mirror()
    }
}

impl MatteCone {
    /// Whether the cone is narrower than f32 unit vectors can resolve: α below about 2⁻²³.
    pub fn is_mirror(&self) -> bool {
        self.one_minus_cos() < 0.5 * f32::EPSILON * f32::EPSILON
    }

    fn delta_lobe(&self, wo: Local) -> Option<BsdfSample> {
        let found = self.is_mirror() && !self.color.is_black();
        found.then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color))
    }

    /// 1 − cos α = 2 sin²(α/2), without cancellation for narrow cones.
    fn one_minus_cos(&self) -> f32 {
        let s = float::sin(0.5 * self.mattness * FRAC_PI_2);
        2.0 * s * s
    }

    /// Whether `w` lies in the cone, by 1 − cos ∠(axis, w) = |axis − w|²/2 for unit vectors, without cancellation for narrow cones.
    fn in_cone(&self, Local(axis): Local, Local(w): Local) -> bool {
        0.5 * (axis - w).length_squared() <= self.one_minus_cos()
    }
}

parameters! {
    /// Reflection distributed uniformly over a cone of half angle 90° · mattness about the mirror direction. Not reciprocal.
    MatteCone {
        /// The share of light that is reflected.
        color: Color,
        /// The half angle of the cone over 90°: 0 is a mirror, 1 a hemisphere about the mirror direction, which is not diffuse.
        mattness: Share,
    }

    fn effects(&self) -> Effects {
        lobe_effects(&self.mattness)
    }
}
