//! A perfect mirror of any colour.

use super::BsdfSample;
use crate::math::{Local, Spectrum, fresnel};

/// Reflection into the mirror direction, the same share at every angle.
///
/// f(wo, wi) = ρ δ(wi − reflect(wo)) / |cos θi|
///
/// - on both sides of the surface
/// - sampling: the one direction, weight = ρ
///
/// Tests: furnace, own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// ρ, the share of light that is reflected: [0, 1].
    pub color: Spectrum,
}

impl Mirror {
    pub fn sample(&self, wo: Local) -> Option<BsdfSample> {
        (!self.color.is_black()).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color))
    }
}
