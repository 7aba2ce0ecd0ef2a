//! A glossy lobe of half vectors.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::{Exponent, Textured, Varying};
use crate::math::{Local, SolidAnglePdf, Spectrum, warp};

/// Blinn's lobe: mirrors whose normals h are scattered about the surface's, each reflecting all it sees.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),   p = D(h) / (4 wo·h),   D = (n + 1)/(2π) · cosⁿ θh,   h = (wo + wi) / |wo + wi|
///
/// 1/(4 wo·h) is the Jacobian dωh/dωi of the reflection at h. What falls below the surface is absorbed. Not reciprocal:
/// a mirror is chosen by D alone, however little of it wo sees.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: h from D, so that weight = ρ
///
/// Source: Blinn, *Models of Light Reflection for Computer Synthesized Pictures* (1977). Tests: matter, proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    /// ρ: [0, 1].
    pub color: Spectrum,
    /// n ≥ 0.
    pub exponent: f32,
}

impl ScatteringModel for BlinnPhong {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        self.color * self.pdf(wo, wi).get()
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let half = (wo.0 + wi.0).try_normalize().filter(|_| wo.same_side(wi));
        let density = half.map_or(0.0, |h| {
            let on_top = h * 1f32.copysign(wo.cos());
            warp::cos_power_hemisphere_pdf(on_top, self.exponent) / (4.0 * wo.0.dot(h))
        });
        // Beyond f32 where wo·h is all but 0: such mirrors are seen edge-on, and count for nothing.
        SolidAnglePdf::new(if density.is_finite() { density } else { 0.0 })
    }

    #[inline(never)]
    fn sample(&self, wo: Local, _choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let h = warp::cos_power_hemisphere(u, self.exponent) * 1f32.copysign(wo.cos());
        let facing = wo.0.dot(h);
        let wi = Local((2.0 * facing * h - wo.0).normalize());
        // A mirror seen from behind reflects nothing.
        BsdfSample::of_lobe(wi, self.color, self.pdf(wo, wi)).filter(|_| facing > 0.0)
    }

    fn reciprocal(&self) -> bool {
        false
    }
}

parameters! {
    /// A glossy lobe of half vectors (Blinn and Phong), normalised. What falls below the surface is lost. Not reciprocal.
    BlinnPhong {
        /// The share of light that is reflected, at most.
        color: Color = Textured::white(),
        /// Half vectors are spread as the cosine to this power: the larger, the sharper.
        exponent: Number<Exponent> = Varying::Same(Exponent::known(10.0)),
    }

    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}
