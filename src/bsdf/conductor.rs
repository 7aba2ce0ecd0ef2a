//! Polished metal.

use super::BsdfSample;
use crate::math::{Local, Spectrum, fresnel};

/// What metal reflects of light at an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// Fresnel's equations with the complex index η + ik, relative to the outside, one value per coefficient of the spectrum.
    Index { eta: Spectrum, k: Spectrum },
    /// F = F₀ + (1 − F₀) (1 − μ)⁵, by the colour F₀ that is seen straight on.
    ///
    /// Source: Schlick, *An Inexpensive BRDF Model for Physically-based Rendering* (1994).
    Schlick { normal: Spectrum },
}

impl Reflectance {
    /// - `cos`: of the angle to the normal, its sign does not matter
    #[inline(always)]
    pub fn at(&self, cos: f32) -> Spectrum {
        match self {
            Reflectance::Index { eta, k } => eta.zip_all(*k, |eta, k| fresnel::conductor(cos, eta, k)),
            Reflectance::Schlick { normal } => schlick(*normal, cos.abs()),
        }
    }

    /// The same by the square of the cosine.
    #[inline(always)]
    pub fn at_square(&self, cos2: f32) -> Spectrum {
        match self {
            Reflectance::Index { eta, k } => eta.zip_all(*k, |eta, k| fresnel::conductor_of_square(cos2, eta, k)),
            Reflectance::Schlick { normal } => schlick(*normal, cos2.sqrt()),
        }
    }

    /// F̄ = 2 ∫ F μ dμ: averaged over the hemisphere by the cosine. Schlick's is F₀ + (1 − F₀)/21.
    pub fn mean(&self) -> Spectrum {
        const STEPS: usize = 64;
        let at = |i: usize| (i as f32 + 0.5) / STEPS as f32;
        match self {
            Reflectance::Index { .. } => (0..STEPS).map(|i| self.at(at(i)) * (2.0 * at(i) / STEPS as f32)).sum(),
            Reflectance::Schlick { normal } => normal.map(|f0| f0 + (1.0 - f0) / 21.0),
        }
    }
}

#[inline(always)]
fn schlick(normal: Spectrum, cos: f32) -> Spectrum {
    let rest = 1.0 - cos.min(1.0);
    normal.map(|f0| f0 + (1.0 - f0) * ((rest * rest) * (rest * rest) * rest))
}

/// Reflection at a smooth metal surface.
///
/// f(wo, wi) = F(cos θo) δ(wi − reflect(wo)) / |cos θi|
///
/// - sampling: the one direction, weight = F
///
/// Source: Born and Wolf, *Principles of Optics*, ch. 14. Tests: fresnel tables F11–F13, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    pub reflectance: Reflectance,
}

impl Conductor {
    pub fn sample(&self, wo: Local) -> Option<BsdfSample> {
        let reflectance = self.reflectance.at(wo.abs_cos());
        (!reflectance.is_black()).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), reflectance))
    }
}
