//! Glass under a thin film: coated lenses, an oily pane, soapy water.

use glam::Vec2;

use super::clear_film::ClearFilm;
use super::microfacet::Microfacets;
use super::rough_interface::RoughInterface;
use super::{BsdfSample, Lobe, ScatteringModel, TransportMode};
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, fresnel};

/// An interface between two clear media under a thin clear film, smooth or rough.
///
/// f is that of [`Dielectric`](super::Dielectric) or [`RoughDielectric`](super::RoughDielectric), with the reflectance R of the film for red, green
/// and blue ([`ClearFilm`]) in the place of Fresnel's. No light is lost in the film, so that 1 − R passes, and light from inside is reflected as
/// much as light that comes from outside along the refracted ray; beyond the critical angle all of it is reflected. The film is too thin to
/// shift or bend light. Light that hits more than one facet is lost.
///
/// - `eta`: index of refraction inside over outside: at least 1
/// - sampling: reflection with the mean of R over the three colours as probability, otherwise refraction
///
/// Source: Born and Wolf, *Principles of Optics*, §1.6. Tests: films_on_glass_are_airys_formula_from_both_sides, own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmedDielectric {
    /// η, the index of refraction inside over outside.
    pub eta: f32,
    /// The factor of all reflected and transmitted light: [0, 1].
    pub color: Spectrum,
    /// n, the index of refraction of the film over that outside: at least 1.
    pub film_eta: f32,
    /// The thickness of the film (nm).
    pub thickness: f32,
    /// The distribution of the facets' normals; `None` if the interface is smooth.
    pub facets: Option<Microfacets>,
}

impl ScatteringModel for FilmedDielectric {
    fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        self.both(wo, wi, mode).map_or(Spectrum::BLACK, |(f, _)| f)
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        self.both(wo, wi, TransportMode::Importance).map_or(SolidAnglePdf::ZERO, |(_, pdf)| pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.cos() == 0.0 || self.color.is_black() {
            return None;
        }
        let Some(interface) = self.interface() else {
            let reflectance = self.reflectance(wo.cos());
            let chance = reflectance.average();
            return if choice < chance {
                Some(self.reflected(wo, reflectance / chance))
            } else {
                self.transmitted(wo, (Spectrum::ONE - reflectance) / (1.0 - chance), mode)
            };
        };
        let (h, cos) = interface.visible(wo, u);
        let wi = if choice < self.reflectance(cos).average() { interface.reflected(wo, h) } else { interface.refracted(wo, h) }?;
        let (f, pdf) = self.both(wo, wi, mode).filter(|(_, pdf)| pdf.get() > 0.0)?;
        let (lobe, eta) = if wo.same_side(wi) { (Lobe::Reflection, 1.0) } else { (Lobe::Transmission, interface.relative_index(wo)) };
        Some(BsdfSample { wi, weight: f / pdf.get(), density: Density::Smooth(pdf), lobe, eta })
    }

    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        if wo.cos() == 0.0 || self.color.is_black() || self.facets.is_some() {
            return [None, None];
        }
        let reflectance = self.reflectance(wo.cos());
        let is_some = |share: Spectrum| !share.is_black();
        let transmittance = Spectrum::ONE - reflectance;
        [
            is_some(reflectance).then(|| self.reflected(wo, reflectance)),
            is_some(transmittance).then(|| self.transmitted(wo, transmittance, mode)).flatten(),
        ]
    }

    fn has_smooth_lobe(&self) -> bool {
        self.facets.is_some()
    }
}

impl FilmedDielectric {
    fn interface(&self) -> Option<RoughInterface<'_>> {
        self.facets.as_ref().map(|facets| RoughInterface { eta: self.eta, facets })
    }

    /// R for light at an angle.
    ///
    /// - `cos`: the cosine of the angle to the normal, below 0 for light from inside
    fn reflectance(&self, cos: f32) -> Spectrum {
        let outside = if cos > 0.0 {
            cos
        } else {
            let sin2 = self.eta * self.eta * (1.0 - cos * cos);
            if sin2 >= 1.0 {
                return Spectrum::ONE;
            }
            (1.0 - sin2).sqrt()
        };
        ClearFilm { eta: self.film_eta, thickness: self.thickness, base: Spectrum::gray(self.eta) }.at(outside)
    }

    fn reflected(&self, wo: Local, share: Spectrum) -> BsdfSample {
        BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color * share)
    }

    /// The refracted direction; `None` under total reflection.
    fn transmitted(&self, wo: Local, share: Spectrum, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(fresnel::refract(wo.0, self.eta)?);
        let eta = if wo.cos() > 0.0 { self.eta } else { 1.0 / self.eta };
        let weight = self.color * share * spread(eta, mode);
        Some(BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Transmission, eta })
    }

    /// f·|cos θi| of a rough interface, and the density of `wi`.
    fn both(&self, wo: Local, wi: Local, mode: TransportMode) -> Option<(Spectrum, SolidAnglePdf)> {
        let interface = self.interface().filter(|_| wo.cos() * wi.cos() != 0.0)?;
        let at = interface.connection(wo, wi)?;
        let reflectance = self.reflectance(at.cos);
        let (share, spread) = match wo.same_side(wi) {
            true => (reflectance, 1.0),
            false => (Spectrum::ONE - reflectance, spread(interface.relative_index(wo), mode)),
        };
        Some((self.color * share * (at.pdf * at.unmasked * spread), SolidAnglePdf::new(at.pdf * share.average())))
    }
}

/// The factor s of refracted light, because refraction changes its solid angle.
fn spread(eta: f32, mode: TransportMode) -> f32 {
    match mode {
        TransportMode::Radiance => 1.0 / (eta * eta),
        TransportMode::Importance => 1.0,
    }
}
