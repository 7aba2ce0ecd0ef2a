//! Clear glass, water, diamond.

use super::{BsdfSample, Lobe, TransportMode};
use crate::math::{Density, Local, Spectrum, fresnel};

/// A smooth interface between two clear media.
///
/// f(wo, wi) = F δ(wi − reflect(wo)) / |cos θi|  +  (1 − F) s δ(wi − refract(wo)) / |cos θi|
///
/// with Fresnel's reflectance F(cos θo; η) and s = (ηo/ηi)² for radiance, which is spread over a
/// wider or narrower cone behind the interface, and s = 1 for importance.
///
/// - `eta`: index of refraction inside (below the surface) over outside (where the normal points)
/// - η = 1 is not there at all: the light goes straight on
/// - sampling: reflection with probability F, else refraction, so that weight = colour (· s)
///
/// Source: Walter et al., *Microfacet Models for Refraction* (2007), §2; Veach, thesis (1997), §5.2.
/// Tests: slab_is_parallel, magnification, glass_in_a_uniform_field, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    pub eta: f32,
    /// Multiplies what passes or is reflected, at every interface: [0, 1]. Physical glass has 1.
    pub color: Spectrum,
}

impl Dielectric {
    #[inline(never)]
    pub fn sample(&self, wo: Local, choice: f32, mode: TransportMode) -> Option<BsdfSample> {
        if wo.cos() == 0.0 || self.color.is_black() {
            return None;
        }
        if choice < fresnel::dielectric(wo.cos(), self.eta) { Some(self.reflect(wo, 1.0)) } else { self.transmit(wo, 1.0, mode) }
    }

    pub fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        if wo.cos() == 0.0 || self.color.is_black() {
            return [None, None];
        }
        let reflectance = fresnel::dielectric(wo.cos(), self.eta);
        let reflected = (reflectance > 0.0).then(|| self.reflect(wo, reflectance));
        let transmitted = if reflectance < 1.0 { self.transmit(wo, 1.0 - reflectance, mode) } else { None };
        [reflected, transmitted]
    }

    fn reflect(&self, wo: Local, share: f32) -> BsdfSample {
        BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color * share)
    }

    /// `None` where it is totally reflected.
    fn transmit(&self, wo: Local, share: f32, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(fresnel::refract(wo.0, self.eta)?);
        let eta = if wo.cos() > 0.0 { self.eta } else { 1.0 / self.eta };
        let spread = match mode {
            TransportMode::Radiance => 1.0 / (eta * eta),
            TransportMode::Importance => 1.0,
        };
        let weight = self.color * (share * spread);
        Some(BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Transmission, eta })
    }
}
