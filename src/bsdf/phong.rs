//! A glossy lobe around the mirror direction.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::{Exponent, Textured, Varying};
use crate::math::{Frame, Local, SolidAnglePdf, Spectrum, fresnel, warp};

/// Phong's lobe, normalised.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),   p = (n + 1)/(2π) · max(0, cos α)ⁿ,   α between wi and the mirror direction
///
/// What falls below the surface is absorbed: the albedo is ρ times the part of the lobe above it. Not reciprocal.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: the lobe itself, so that weight = ρ
///
/// Source: Phong, *Illumination for Computer Generated Pictures* (1975); normalised as by Lafortune and Willems (1994).
/// Tests: matter, proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// ρ: [0, 1].
    pub color: Spectrum,
    /// n ≥ 0.
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
    /// A glossy lobe around the mirror direction (Phong), normalised. What falls below the surface is lost. Not reciprocal.
    Phong {
        /// The share of light that is reflected, at most.
        color: Color = Textured::white(),
        /// The lobe is the cosine to this power: the larger, the sharper.
        exponent: Number<Exponent> = Varying::Same(Exponent::known(10.0)),
    }

    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}
