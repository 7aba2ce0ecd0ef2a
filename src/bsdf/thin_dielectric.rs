//! A thin pane of glass or a soap film, with both faces in one surface.

use glam::Vec2;

use super::parameter::parameters;
use super::{BsdfSample, Lobe, Passage, ScatteringModel, TransportMode};
use crate::effects::Effects;
use crate::format::{Index, Textured, Varying};
use crate::math::{Density, Local, Spectrum, fresnel};

/// A thin plate as one surface, with all reflections between its two faces.
///
/// R' = R + T² R (1 + R² + R⁴ + …) = 2 R / (1 + R),    T' = 1 − R'
///
/// f(wo, wi) = R' δ(wi − reflect(wo)) / |cos θi|  +  T' δ(wi + wo) / |cos θi|
///
/// with Fresnel's R(cos θo; η) at one face. Transmitted light keeps its direction. The plate has no inside, and both sides are alike.
///
/// - `eta`: index of refraction of the plate over that of its surroundings
/// - sampling: reflection with probability R', so that weight = colour
///
/// Source: Born and Wolf, *Principles of Optics*, §1.6.4, without interference. Tests: thin_plate, own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    /// η, the index of refraction of the plate over that of its surroundings.
    pub eta: f32,
    /// The factor of all reflected and transmitted light: [0, 1]. Clear glass has 1.
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
    /// R', the reflectance of both faces; `None` where nothing is scattered.
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
    /// A pane or a bubble as one surface without thickness, with all reflections between its faces. Transmitted light goes straight on.
    ThinDielectric {
        /// The index of refraction of the pane divided by that of its surroundings.
        eta: Number<Index> = Varying::Same(Index::known(1.5)),
        /// A factor of all reflected and transmitted light, which counts once for both faces.
        color: Color = Textured::white(),
    }

    /// The effects of glass: light is not bent, but the index of refraction matters.
    fn effects(&self) -> Effects {
        Effects::REFRACTION | Effects::SPECULAR_REFLECTION
    }

    fn passage(&self) -> Passage {
        Passage::Sheet
    }
}
