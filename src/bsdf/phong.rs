//! A glossy lobe around the mirror direction.

use glam::Vec2;

use super::BsdfSample;
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

impl Phong {
    pub fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        self.color * self.pdf(wo, wi).get()
    }

    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        if !wo.same_side(wi) {
            return SolidAnglePdf::ZERO;
        }
        let in_lobe = Frame::around(fresnel::reflect(wo.0)).to_local(wi.0).0;
        SolidAnglePdf::new(warp::cos_power_hemisphere_pdf(in_lobe, self.exponent))
    }

    #[inline(never)]
    pub fn sample(&self, wo: Local, u: Vec2) -> Option<BsdfSample> {
        let in_lobe = Local(warp::cos_power_hemisphere(u, self.exponent));
        let wi = Local(Frame::around(fresnel::reflect(wo.0)).to_world(in_lobe));
        BsdfSample::of_lobe(wi, self.color, self.pdf(wo, wi))
    }
}
