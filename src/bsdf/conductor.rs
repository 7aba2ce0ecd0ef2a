//! Polished metal.

use super::BsdfSample;
use crate::math::{Local, Spectrum, fresnel};

/// Reflection at a smooth metal surface, by Fresnel's equations with the complex index η + ik.
///
/// f(wo, wi) = F(cos θo; η, k) δ(wi − reflect(wo)) / |cos θi|
///
/// - `eta`, `k`: relative to the outside, one value per coefficient of the spectrum
/// - sampling: the one direction, weight = F
///
/// Source: Born and Wolf, *Principles of Optics*, ch. 14. Tests: fresnel tables F11–F13, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    pub eta: Spectrum,
    pub k: Spectrum,
}

impl Conductor {
    pub fn sample(&self, wo: Local) -> Option<BsdfSample> {
        let reflectance = self.eta.zip(self.k, |eta, k| fresnel::conductor(wo.abs_cos(), eta, k));
        (!reflectance.is_black()).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), reflectance))
    }
}
