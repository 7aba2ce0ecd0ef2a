//! A mirror with its reflections shaken.

use std::f32::consts::TAU;

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode, lobe_effects};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::float::ROUNDING;
use crate::math::{Local, SolidAnglePdf, Spectrum, fresnel, warp};

/// The mirror direction m, plus r times a point on the unit sphere.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),   p = (b² + q²) / (2π r q),   b = m·wi,   q = √(r² − sin²∠(m, wi))
///
/// The line along wi meets the sphere of radius r about m at the distances t = b ± q; each point stands for the
/// density 1/(4π r²) · t²/cos, with cos = q/r between the line and the sphere's normal. p grows without bound at the
/// rim of the cone sin ∠ = r, though not its integral. r = 0 is a mirror; r = 1 a cosine lobe about m, p = b/π.
///
/// What falls below the surface is absorbed. Not reciprocal.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: as defined, so that weight = ρ; the density is that of the rounded direction
///
/// Source: the "metal" of ray-tracing courses; the density is derived here. Tests: matter, proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// ρ: [0, 1].
    pub color: Spectrum,
    /// r: [0, 1].
    pub roughness: f32,
}

impl ScatteringModel for Metal {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        self.color * self.pdf(wo, wi).get()
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let mirror = fresnel::reflect(wo.0);
        // By the sine: 1 − b² would lose narrow cones.
        let (b, q2) = (mirror.dot(wi.0), self.roughness * self.roughness - mirror.cross(wi.0).length_squared());
        let inside = !self.is_mirror() && wo.same_side(wi) && b > 0.0 && q2 > -self.rim();
        if inside { self.density(b, q2.max(self.rim()).sqrt()) } else { SolidAnglePdf::ZERO }
    }

    #[inline(never)]
    fn sample(&self, wo: Local, _choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        if self.is_mirror() {
            return self.delta_lobe(wo);
        }
        let (mirror, shift) = (fresnel::reflect(wo.0), warp::uniform_sphere(u));
        let wi = (mirror + self.roughness * shift).try_normalize()?;
        let pdf = self.pdf(wo, Local(wi));
        (pdf.get() > 0.0).then(|| BsdfSample::of_lobe(Local(wi), self.color, pdf)).flatten()
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

impl Metal {
    /// Narrower than f32 can tell unit vectors apart.
    pub fn is_mirror(&self) -> bool {
        self.roughness < f32::EPSILON
    }

    /// By what rounding may move q²: |2 sin δ| with sin = r and δ the error of the sine, four times 2⁻²⁴ at most.
    ///
    /// Within so much of the rim p is what it is there: what this takes from inside the rim it adds outside, and every
    /// direction that is drawn has a density.
    fn rim(&self) -> f32 {
        8.0 * ROUNDING * self.roughness
    }

    fn density(&self, b: f32, q: f32) -> SolidAnglePdf {
        SolidAnglePdf::new((b * b + q * q) / (TAU * self.roughness * q))
    }

    fn delta_lobe(&self, wo: Local) -> Option<BsdfSample> {
        let found = self.is_mirror() && !self.color.is_black();
        found.then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color))
    }
}

parameters! {
    /// A mirror with shaken reflections: the mirror direction plus `roughness` times a point on the unit sphere. What falls
    /// below the surface is lost. Not reciprocal. For measured metals see `conductor`.
    Metal {
        /// The share of light that is reflected, at most.
        color: Color = Textured::white(),
        /// 0 is a mirror.
        roughness: Share = Textured::black(),
    }

    fn effects(&self) -> Effects {
        lobe_effects(&self.roughness)
    }
}
