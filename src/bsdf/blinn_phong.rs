//! The Blinn–Phong model: a glossy lobe of half vectors.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::{Exponent, Textured, Varying};
use crate::math::{Local, SolidAnglePdf, Spectrum, warp};

/// Blinn's glossy lobe: reflection at mirrors with normals h that are distributed about the surface's normal.
///
/// f(wo, wi)·|cos θi| = ρ p(wi),   p = D(h) / (4 wo·h),   D = (n + 1)/(2π) · cosⁿ θh,   h = (wo + wi) / |wo + wi|
///
/// 1/(4 wo·h) is the Jacobian dωh/dωi of the reflection at h. Light that is reflected below the surface is absorbed. The model is not
/// reciprocal, because the mirrors are distributed by D alone, however little of each is visible from wo.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: h from D, so that weight = ρ
///
/// Source: Blinn, *Models of Light Reflection for Computer Synthesized Pictures* (1977). Tests: own_models_are_proved,
/// densities_integrate_to_the_share_of_samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    /// ρ, the largest share of light that is reflected: [0, 1].
    pub color: Spectrum,
    /// n, the exponent: at least 0.
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
        // The density exceeds f32 where wo·h is nearly 0. These mirrors are seen edge-on and contribute nothing.
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
    /// A glossy lobe of half vectors (Blinn and Phong), normalised. Light reflected below the surface is lost. Not reciprocal.
    BlinnPhong {
        /// The largest share of light that is reflected.
        color: Color = Textured::white(),
        /// The exponent of the cosine in the distribution of half vectors: larger values make sharper highlights.
        exponent: Number<Exponent> = Varying::Same(Exponent::known(10.0)),
    }

    fn effects(&self) -> Effects {
        Effects::GLOSSY_REFLECTION
    }
}
