//! Paper, leaves, lampshades.

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;

use super::{BsdfSample, Lobe};
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, warp};

/// A thin matte sheet: equal radiance in every direction, on both sides.
///
/// f(wo, wi) = ρ / π on the side of wo,  τ / π on the other                                             [sr⁻¹]
///
/// - from either side alike
/// - sampling: the side by the larger coefficients of ρ and τ, then cosine-weighted
///
/// Source: Lambert, *Photometria* (1760). Tests: matter, proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// ρ: [0, 1].
    pub reflectance: Spectrum,
    /// τ: [0, 1 − ρ].
    pub transmittance: Spectrum,
}

impl DiffuseTransmission {
    pub fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        let share = if wo.same_side(wi) { self.reflectance } else { self.transmittance };
        share * (FRAC_1_PI * wi.abs_cos())
    }

    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let [reflected, transmitted] = self.probabilities();
        let side = if wo.same_side(wi) { reflected } else { transmitted };
        SolidAnglePdf::new(side * FRAC_1_PI * wi.abs_cos())
    }

    #[inline(never)]
    pub fn sample(&self, wo: Local, choice: f32, u: Vec2) -> Option<BsdfSample> {
        let [reflected, transmitted] = self.probabilities();
        let (share, probability, lobe, side) = match choice < reflected {
            true => (self.reflectance, reflected, Lobe::Reflection, wo.cos()),
            false => (self.transmittance, transmitted, Lobe::Transmission, -wo.cos()),
        };
        let wi = Local(warp::cosine_hemisphere(u) * 1f32.copysign(side));
        let found = !share.is_black() && wo.cos() != 0.0;
        found.then(|| BsdfSample { wi, weight: share / probability, density: Density::Smooth(self.pdf(wo, wi)), lobe, eta: 1.0 })
    }

    /// Of reflection and of transmission; neither as the rest of the other, which would be 0 before the light is.
    fn probabilities(&self) -> [f32; 2] {
        let (r, t) = (self.reflectance.max(), self.transmittance.max());
        if r + t > 0.0 { [r / (r + t), t / (r + t)] } else { [1.0, 0.0] }
    }
}
