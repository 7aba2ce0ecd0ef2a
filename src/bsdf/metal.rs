//! A mirror with reflections that are displaced at random.

use std::f32::consts::TAU;

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode, lobe_effects};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::float::ROUNDING;
use crate::math::{Local, SolidAnglePdf, Spectrum, fresnel, warp};

/// Reflection in the mirror direction m plus r times a random point on the unit sphere.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),   p = (b² + q²) / (2π r q),   b = m·wi,   q = √(r² − sin²∠(m, wi))
///
/// The line along wi intersects the sphere of radius r about m at the distances t = b ± q. Each intersection contributes the
/// density 1/(4π r²) · t²/cos, with cos = q/r between the line and the sphere's normal. p is unbounded at the rim of the cone
/// sin ∠ = r, but its integral is finite. r = 0 is a mirror; r = 1 is a cosine lobe about m, p = b/π.
///
/// Light that is reflected below the surface is absorbed. The model is not reciprocal.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: by the definition, so that weight = ρ; the density is that of the rounded direction
///
/// Source: the "metal" of ray-tracing courses; the density is derived here. Tests: own_models_are_proved,
/// perturbed_mirrors_fill_their_cone, perturbed_mirrors_have_the_derived_density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// ρ, the largest share of light that is reflected: [0, 1].
    pub color: Spectrum,
    /// r, the radius of the sphere: [0, 1].
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
        // The sine by a cross product: 1 − b² would cancel for narrow cones.
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
    /// Whether the lobe is narrower than f32 unit vectors can resolve.
    pub fn is_mirror(&self) -> bool {
        self.roughness < f32::EPSILON
    }

    /// Bound of the rounding error of q²: 2 r δ, where the sine, about r at the rim, has an error δ of at most 4 · 2⁻²⁴.
    ///
    /// Where |q²| is below this bound, `pdf` replaces q² by the bound. That makes p finite: smaller than exact inside the rim, and above 0
    /// just outside of it, so that its integral is kept and every sampled direction has a density above 0.
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
    /// Reflection in the mirror direction plus `roughness` times a random point on the unit sphere. Light reflected below the surface
    /// is lost. Not reciprocal. For measured metals see `conductor`.
    Metal {
        /// The largest share of light that is reflected.
        color: Color = Textured::white(),
        /// The radius of the sphere, from 0 (a mirror) to 1.
        roughness: Share = Textured::black(),
    }

    fn effects(&self) -> Effects {
        lobe_effects(&self.roughness)
    }
}
