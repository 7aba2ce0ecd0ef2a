//! A perfect mirror.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Local, Spectrum, fresnel};

/// Reflection in the mirror direction, with an equal share at every angle.
///
/// f(wo, wi) = ρ δ(wi − reflect(wo)) / |cos θi|
///
/// - on both sides of the surface
/// - sampling: the mirror direction, with weight ρ
///
/// Tests: own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// ρ, the share of light that is reflected: [0, 1].
    pub color: Spectrum,
}

impl ScatteringModel for Mirror {
    #[inline]
    fn sample(&self, wo: Local, _choice: f32, _u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        (!self.color.is_black()).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color))
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [self.sample(wo, 0.0, Vec2::ZERO, mode), None]
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

parameters! {
    /// A perfect mirror.
    Mirror {
        /// The share of light that is reflected.
        color: Color = Textured::white(),
    }

    fn effects(&self) -> Effects {
        Effects::SPECULAR_REFLECTION
    }
}
