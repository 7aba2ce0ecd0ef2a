//! The Phong model: a glossy lobe about the mirror direction.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::{Exponent, Textured, Varying};
use crate::math::{Frame, Local, SolidAnglePdf, Spectrum, fresnel, warp};

/// Phong's glossy lobe, normalised.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),   p = (n + 1)/(2π) · max(0, cos α)ⁿ,   α between wi and the mirror direction
///
/// Light that is reflected below the surface is absorbed: the albedo is ρ times the part of the lobe above it. The model is not
/// reciprocal.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: the lobe itself, so that weight = ρ
///
/// Source: Phong, *Illumination for Computer Generated Pictures* (1975); normalised as by Lafortune and Willems (1994).
/// Tests: own_models_are_proved, densities_integrate_to_the_share_of_samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// ρ, the largest share of light that is reflected: [0, 1].
    pub color: Spectrum,
    /// n, the exponent: at least 0.
    pub exponent: f32,
}

impl ScatteringModel for Phong {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        self.color * self.pdf(wo, wi).get()
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        if !wo.same_side(wi) {
            return SolidAnglePdf::ZERO;
        }
        let in_lobe = Frame::around(fresnel::reflect(wo.0)).to_local(wi.0).0;
        SolidAnglePdf::new(warp::cos_power_hemisphere_pdf(in_lobe, self.exponent))
    }

    #[inline(never)]
    fn sample(&self, wo: Local, _choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let in_lobe = Local(warp::cos_power_hemisphere(u, self.exponent));
        let wi = Local(Frame::around(fresnel::reflect(wo.0)).to_world(in_lobe));
        BsdfSample::of_lobe(wi, self.color, self.pdf(wo, wi))
    }

    fn reciprocal(&self) -> bool {
        false
    }
}

parameters! {
    /// A glossy lobe about the mirror direction (Phong), normalised. Light reflected below the surface is lost. Not reciprocal.
    Phong {
        /// The largest share of light that is reflected.
        color: Color = Textured::white(),
        /// The exponent of the cosine of the lobe: larger values make sharper highlights.
        exponent: Number<Exponent> = Varying::Same(Exponent::known(10.0)),
    }

    fn effects(&self) -> Effects {
        Effects::GLOSSY_REFLECTION
    }
}
