//! Lommel–Seeliger reflection of dark dust: the moon, asteroids, soot.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Local, SolidAnglePdf, Spectrum, warp};

/// The Lommel–Seeliger law: light that scatters once, isotropically, in a deep layer of small dark particles.
///
/// f(wo, wi) = ω / (4π (μo + μi))                                                                       [sr⁻¹]
///
/// E(μo) = ω/2 · (1 − μo ln((1 + μo)/μo)): the albedo, at most ω/2
///
/// A ball of this material that is lit from the viewer's side is as bright at its edge as at its centre, like the full moon.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: uniform over the hemisphere, so that weight = ω/2 · μi/(μo + μi) ≤ ω/2
///
/// Source: Seeliger (1884); Hapke, *Theory of Reflectance and Emittance Spectroscopy* (1993), §8.E.1. Tests:
/// the_albedo_of_dust_is_its_formula, own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LommelSeeliger {
    /// ω, the share of light that one particle scatters: [0, 1].
    pub albedo: Spectrum,
}

impl ScatteringModel for LommelSeeliger {
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        if !wo.same_side(wi) {
            return Spectrum::BLACK;
        }
        self.albedo * (0.25 * FRAC_1_PI * (wi.abs_cos() / (wo.abs_cos() + wi.abs_cos())))
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(if wo.same_side(wi) { 1.0 / TAU } else { 0.0 })
    }

    fn sample(&self, wo: Local, _choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(warp::uniform_hemisphere(u)).on_the_side_of(wo);
        BsdfSample::of_lobe(wi, self.eval(wo, wi, mode) * TAU, self.pdf(wo, wi))
    }
}

parameters! {
    /// Dark dust (Lommel and Seeliger): the moon, asteroids, soot. Light scatters once in it, and at most half of it comes back.
    LommelSeeliger {
        /// The share of light that one particle of the dust scatters.
        albedo: Color = Textured::gray(0.2),
    }

    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}
