//! A pane of glass, a soap film: both faces at once.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, Lobe, Passage, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::{Index, Textured, Varying};
use crate::math::{Density, Local, Spectrum, fresnel};

/// A plate so thin that its two faces are one surface, with all reflections between them.
///
/// R' = R + T² R (1 + R² + R⁴ + …) = 2 R / (1 + R),    T' = 1 − R'
///
/// f(wo, wi) = R' δ(wi − reflect(wo)) / |cos θi|  +  T' δ(wi + wo) / |cos θi|
///
/// with Fresnel's R(cos θo; η) at one face. Light goes on in its direction; the plate has no inside, and both sides are alike.
///
/// - `eta`: index of refraction of the plate over that around it
/// - sampling: reflection with probability R', so that weight = colour
///
/// Source: Born and Wolf, *Principles of Optics*, §1.6.4, without interference. Tests: thin_plate, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    pub eta: f32,
    /// Multiplies what passes or is reflected: [0, 1]. Clear glass has 1.
    pub color: Spectrum,
}

impl ScatteringModel for ThinDielectric {
    #[inline]
    fn sample(&self, wo: Local, choice: f32, _u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let reflectance = self.reflectance(wo)?;
        Some(if choice < reflectance { self.reflect(wo, 1.0) } else { self.pass(wo, 1.0) })
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, _mode: TransportMode) -> [Option<BsdfSample>; 2] {
        let Some(reflectance) = self.reflectance(wo) else { return [None, None] };
        [(reflectance > 0.0).then(|| self.reflect(wo, reflectance)), (reflectance < 1.0).then(|| self.pass(wo, 1.0 - reflectance))]
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

impl ThinDielectric {
    /// R'; `None` where nothing is scattered.
    fn reflectance(&self, wo: Local) -> Option<f32> {
        let once = fresnel::dielectric(wo.abs_cos(), self.eta);
        (wo.cos() != 0.0 && !self.color.is_black()).then_some(2.0 * once / (1.0 + once))
    }

    fn reflect(&self, wo: Local, share: f32) -> BsdfSample {
        BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color * share)
    }

    fn pass(&self, wo: Local, share: f32) -> BsdfSample {
        BsdfSample { wi: Local(-wo.0), weight: self.color * share, density: Density::Delta, lobe: Lobe::Transmission, eta: 1.0 }
    }
}

parameters! {
    /// A pane or a bubble as one surface without thickness: both faces and all reflections between them. Light passes straight.
    ThinDielectric {
        /// Index of refraction of the pane divided by that around it.
        eta: Number<Index> = Varying::Same(Index::known(1.5)),
        /// Light that passes or is reflected is multiplied by this once.
        color: Color = Textured::white(),
    }

    /// Light passes unbent, and yet the index of refraction matters.
    fn effects(&self) -> Effects {
        Effects::REFRACTION | Effects::SPECULAR_REFLECTION
    }

    fn passage(&self) -> Passage {
        Passage::Sheet
    }
}
