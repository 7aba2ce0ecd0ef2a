//! Diffuse reflection and transmission: paper, leaves, lampshades.

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, Lobe, Passage, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, warp};

/// A thin matte sheet: equal radiance in every direction on each side.
///
/// f(wo, wi) = ρ / π on the side of wo,  τ / π on the other                                             [sr⁻¹]
///
/// - both sides are alike
/// - sampling: the side with probabilities in proportion to the largest coefficients of ρ and τ, then cosine-weighted
///
/// Source: Lambert, *Photometria* (1760). Tests: own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// ρ, the share of light that is reflected: [0, 1].
    pub reflectance: Spectrum,
    /// τ, the share of light that is transmitted: [0, 1 − ρ].
    pub transmittance: Spectrum,
}

impl ScatteringModel for DiffuseTransmission {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        let share = if wo.same_side(wi) { self.reflectance } else { self.transmittance };
        share * (FRAC_1_PI * wi.abs_cos())
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let [reflected, transmitted] = self.probabilities();
        let side = if wo.same_side(wi) { reflected } else { transmitted };
        SolidAnglePdf::new(side * FRAC_1_PI * wi.abs_cos())
    }

    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let [reflected, transmitted] = self.probabilities();
        let (share, probability, lobe, side) = match choice < reflected {
            true => (self.reflectance, reflected, Lobe::Reflection, wo.cos()),
            false => (self.transmittance, transmitted, Lobe::Transmission, -wo.cos()),
        };
        let wi = Local(warp::cosine_hemisphere(u) * 1f32.copysign(side));
        let found = !share.is_black() && wo.cos() != 0.0;
        found.then(|| BsdfSample { wi, weight: share / probability, density: Density::Smooth(self.pdf(wo, wi)), lobe, eta: 1.0 })
    }

    /// Scales both shares down where they add up to more than 1.
    fn energy_conserving(self) -> DiffuseTransmission {
        let scale = (self.reflectance + self.transmittance).max().max(1.0).recip();
        DiffuseTransmission { reflectance: self.reflectance * scale, transmittance: self.transmittance * scale }
    }
}

impl DiffuseTransmission {
    /// The probabilities of reflection and of transmission. Each is computed by itself, because 1 minus the other would round to 0 for
    /// a small share.
    fn probabilities(&self) -> [f32; 2] {
        let (r, t) = (self.reflectance.max(), self.transmittance.max());
        if r + t > 0.0 { [r / (r + t), t / (r + t)] } else { [1.0, 0.0] }
    }
}

parameters! {
    /// A thin matte sheet with equal sides: paper, a leaf, a lampshade.
    DiffuseTransmission {
        /// The share of light that is reflected. Where it and `transmittance` add up to more than 1, both are scaled down.
        reflectance: Color = Textured::gray(0.25),
        /// The share of light that is transmitted.
        transmittance: Color = Textured::gray(0.25),
    }

    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }

    fn passage(&self) -> Passage {
        Passage::Sheet
    }
}
