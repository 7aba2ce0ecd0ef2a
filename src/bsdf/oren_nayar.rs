//! Rough matte surfaces: unglazed clay, sand, plaster.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Local, SolidAnglePdf, Spectrum, float, warp};

/// Oren–Nayar reflection of rough matte surfaces, in a form that preserves energy.
///
/// f = ρ/π · A (1 + σ s/t)  +  ρₘ/π · (1 − E(μo)) (1 − E(μi)) / (1 − Ē)                                  [sr⁻¹]
///
/// s = wo·wi − μo μi,   t = max(μo, μi) if s > 0, else 1,   A = 1 / (1 + (1/2 − 2/3π) σ)
/// E(μ) = A (1 + σ/π · G(μ)): the albedo of the first term at ρ = 1;   Ē: its mean
/// ρₘ = ρ² Ē / (1 − ρ (1 − Ē)): the albedo of light that was reflected between the grooves
///
/// At ρ = 1 all light is reflected, for any σ. σ = 0 is Lambert's law.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: cosine-weighted
///
/// Source: Fujii's form, and Portsmouth, Kutz and Hill, *EON: A Practical Energy-Preserving Rough Diffuse BRDF*
/// (JCGT 14(1), 2025). Tests: own_models_are_proved, rough_matte_is_white, dark_grooves_follow_fujii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    /// ρ, about the share of light that is reflected: [0, 1].
    pub albedo: Spectrum,
    /// σ, the roughness: [0, 1].
    pub roughness: f32,
}

/// 1/2 − 2/(3π)
const C1: f32 = 0.5 - 2.0 / (3.0 * PI);
/// 2/3 − 28/(15π)
const C2: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

impl ScatteringModel for OrenNayar {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        if !wo.same_side(wi) {
            return Spectrum::BLACK;
        }
        let (mu_o, mu_i) = (wo.abs_cos(), wi.abs_cos());
        let s = wo.0.truncate().dot(wi.0.truncate());
        let t = if s > 0.0 { mu_o.max(mu_i) } else { 1.0 };
        let once = self.a() * (1.0 + self.roughness * s / t);
        let (mean, lost) = (self.mean(), self.a() * self.roughness);
        let grooves = lost * loss(mu_o) * loss(mu_i) / (C1 - C2);
        let f = self.albedo.map(|rho| rho * once + rho * rho * mean / (1.0 - rho * (1.0 - mean)) * grooves);
        f * (FRAC_1_PI * mu_i)
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(if wo.same_side(wi) { FRAC_1_PI * wi.abs_cos() } else { 0.0 })
    }

    #[inline(never)]
    fn sample(&self, wo: Local, _choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(warp::cosine_hemisphere(u) * 1f32.copysign(wo.cos()));
        let pdf = self.pdf(wo, wi);
        BsdfSample::of_lobe(wi, self.eval(wo, wi, mode) / pdf.get(), pdf)
    }
}

impl OrenNayar {
    fn a(&self) -> f32 {
        1.0 / (1.0 + C1 * self.roughness)
    }

    /// ∫ E(μ) 2μ dμ
    fn mean(&self) -> f32 {
        self.a() * (1.0 + C2 * self.roughness)
    }
}

parameters! {
    /// A rough matte surface (Oren and Nayar): it looks flatter than `diffuse`, and brighter at its edges. No energy is lost.
    OrenNayar {
        /// About the share of light that is reflected.
        albedo: Color = Textured::gray(0.5),
        /// The roughness: 0 is `diffuse`, 1 the roughest.
        roughness: Share = Textured::gray(0.5),
    }

    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}

/// (1 − E(μ)) / (A σ) = C₁ − G(μ)/π, which does not depend on σ and so keeps its precision for a small roughness. Its mean is C₁ − C₂.
fn loss(mu: f32) -> f32 {
    let sine = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
    // (1 − sine³) sine/μ, with 1 − sine = μ²/(1 + sine) factored out to avoid cancellation at grazing incidence.
    let cubic = sine * mu * (1.0 + sine + sine * sine) / (1.0 + sine);
    let g = sine * (float::acos(mu) - sine * mu) + (2.0 / 3.0) * (cubic - sine);
    (C1 - FRAC_1_PI * g).max(0.0)
}
