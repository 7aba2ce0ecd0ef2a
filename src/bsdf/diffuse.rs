//! Lambertian reflection.

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Local, SolidAnglePdf, Spectrum, warp};

/// Lambertian reflection: equal radiance in every direction.
///
/// f(wo, wi) = ρ / π                                   [sr⁻¹]
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: cosine-weighted, so that weight = ρ exactly and no variance remains
///
/// Source: Lambert, *Photometria* (1760). Tests: own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// ρ, the share of light that is reflected: [0, 1].
    pub albedo: Spectrum,
}

impl ScatteringModel for Diffuse {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        if wo.same_side(wi) { self.albedo * (FRAC_1_PI * wi.abs_cos()) } else { Spectrum::BLACK }
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(if wo.same_side(wi) { FRAC_1_PI * wi.abs_cos() } else { 0.0 })
    }

    #[inline]
    fn sample(&self, wo: Local, _choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        // A direction along the surface has no side to sample.
        let up = (wo.cos() != 0.0).then(|| warp::cosine_hemisphere(u))?;
        BsdfSample::of_lobe(Local(up).on_the_side_of(wo), self.albedo, SolidAnglePdf::new(warp::cosine_hemisphere_pdf(up)))
    }
}

parameters! {
    /// Lambertian reflection: equal radiance in every direction.
    Diffuse {
        /// The share of light that is reflected.
        albedo: Color = Textured::gray(0.5),
    }

    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}
