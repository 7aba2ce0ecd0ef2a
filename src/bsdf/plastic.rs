//! A clear smooth coat over a matte ground: plastic, varnished wood, glazed china.

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;

use super::BsdfSample;
use crate::math::{Local, SolidAnglePdf, Spectrum, fresnel, warp};

/// A Lambertian ground below a smooth dielectric surface.
///
/// f = F(μo) δ(wi − reflect(wo)) / μi  +  (1 − F(μo)) (1 − F(μi)) / η² · ρ / (π (1 − ρ F̄ᵢ))            [sr⁻¹]
///
/// Light goes through the surface, is scattered by the ground, and leaves or is thrown back: F̄ᵢ = 1 − (1 − F̄)/η²
/// is what the surface reflects of diffuse light from within, F̄ from without. At ρ = 1 all light comes back.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: surface or ground by what each sends back, the ground cosine-weighted
///
/// Source: Wolff, *Diffuse-Reflectance Model for Smooth Dielectric Surfaces* (1994). Tests: matter, proof, coated_white_is_white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// ρ, of the ground: [0, 1].
    pub albedo: Spectrum,
    /// η of the coat, over the outside: at least 1.
    pub eta: f32,
    /// F̄ᵢ: [`Plastic::internal`] of `eta`.
    pub internal: f32,
}

impl Plastic {
    /// F̄ᵢ for the index `eta`.
    pub fn internal(eta: f32) -> f32 {
        1.0 - (1.0 - fresnel::dielectric_mean(eta)) / (eta * eta)
    }

    pub fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        if !wo.same_side(wi) {
            return Spectrum::BLACK;
        }
        let through = (1.0 - self.surface(wo)) * (1.0 - self.surface(wi)) / (self.eta * self.eta);
        self.ground() * (through * FRAC_1_PI * wi.abs_cos())
    }

    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let density = self.probabilities(wo)[1] * FRAC_1_PI * wi.abs_cos();
        SolidAnglePdf::new(if wo.same_side(wi) { density } else { 0.0 })
    }

    #[inline(never)]
    pub fn sample(&self, wo: Local, choice: f32, u: Vec2) -> Option<BsdfSample> {
        let [surface, _] = self.probabilities(wo);
        if choice < surface {
            return self.delta_lobe(wo).map(|lobe| BsdfSample { weight: lobe.weight / surface, ..lobe });
        }
        let wi = Local(warp::cosine_hemisphere(u) * 1f32.copysign(wo.cos()));
        let pdf = self.pdf(wo, wi);
        BsdfSample::of_lobe(wi, self.eval(wo, wi) / pdf.get(), pdf)
    }

    pub fn delta_lobe(&self, wo: Local) -> Option<BsdfSample> {
        let reflected = self.surface(wo);
        (reflected > 0.0).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), Spectrum::gray(reflected)))
    }

    /// F
    pub(super) fn surface(&self, w: Local) -> f32 {
        fresnel::dielectric(w.abs_cos(), self.eta)
    }

    /// ρ / (1 − ρ F̄ᵢ)
    fn ground(&self) -> Spectrum {
        self.albedo.map(|rho| rho / (1.0 - rho * self.internal))
    }

    /// Of surface and ground: their shares in what comes back, neither as the rest of the other.
    fn probabilities(&self, wo: Local) -> [f32; 2] {
        let surface = self.surface(wo);
        let ground = (1.0 - surface) * self.ground().max() * (1.0 - self.internal);
        let sum = surface + ground;
        if sum > 0.0 { [surface / sum, ground / sum] } else { [1.0, 0.0] }
    }
}
