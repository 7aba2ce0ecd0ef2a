//! Builds media.

use std::collections::BTreeMap;

use super::{Builder, rgb};
use crate::describe::{self, Color, MediumRef, PerChannel, Subsurface};
use crate::effects::Effects;
use crate::math::{Rgb, Spectrum};
use crate::medium::subsurface::single_scattering_albedo;
use crate::medium::{MOST_DEPTH, Medium, MediumId, Phase};
use crate::reader::escaped;

impl Builder<'_> {
    /// Builds a medium, or finds it if it was built before.
    pub(super) fn medium(&mut self, pointer: &str, chosen: &MediumRef) -> MediumId {
        let key = match chosen {
            MediumRef::Named(name) => format!("/media{}", escaped(name)),
            MediumRef::Inline(_) => pointer.to_owned(),
        };
        if let Some(known) = self.media.get(&key) {
            return *known;
        }
        // Scenes that name unknown media are refused.
        let built = match self.scene.medium(chosen) {
            None => Medium::new(Spectrum::BLACK, Spectrum::BLACK, Phase::Isotropic),
            Some(described) => {
                let (at, built) = (format!("{key}/density"), built(described));
                if !built.extinction().is_finite() {
                    self.fault(&key, "coefficients beyond the range of 32-bit floats: give longer lengths or a larger scale");
                }
                match described.density().and_then(|density| self.density(&at, density)) {
                    Some(density) => self.checked(&at, built.with_density(density)),
                    None => built,
                }
            }
        };
        let id = self.world.medium(built);
        self.media.insert(key, id);
        id
    }

    /// A medium with a density, after adding a fault if it is too dense.
    fn checked(&mut self, pointer: &str, medium: Medium) -> Medium {
        let per_metre = f64::from(medium.extinction().max());
        let depth = medium.density().map_or(0.0, |density| density.most_per_cell() * per_metre);
        if depth > MOST_DEPTH {
            let message = format!(
                "an optical depth of {depth:.1e} within a few values of the density, expected at most {MOST_DEPTH:e}: make the \
                 coefficients or the density smaller"
            );
            self.fault(pointer, &message);
        }
        medium
    }

    /// The names of the media, in the order in which they were built. A medium without a name has its JSON pointer instead.
    pub(super) fn medium_names(&self) -> Vec<String> {
        let mut named: Vec<(MediumId, &str)> = self.media.iter().map(|(key, id)| (*id, key.as_str())).collect();
        named.sort();
        let named_media = self.scene.media.keys().map(|name| (format!("/media{}", escaped(name)), name));
        let names: BTreeMap<String, &String> = named_media.collect();
        named.into_iter().map(|(_, key)| names.get(key).map_or_else(|| key.to_owned(), |name| (*name).clone())).collect()
    }

    /// Builds the medium around all shapes.
    pub(super) fn surroundings(&mut self) {
        let Some(described) = &self.scene.medium else { return };
        let medium = self.medium("/medium", described);
        self.world.surround(medium);
        self.override_needs.push(("/medium, around all shapes".to_owned(), self.medium_effects(described)));
    }

    /// Effects that a medium asks for. The light that it emits is met only by chance.
    pub(super) fn medium_effects(&self, described: &MediumRef) -> Effects {
        let emits = self.scene.medium(described).is_some_and(|medium| built(medium).emits());
        if emits { Effects::MEDIA | Effects::UNSAMPLED_EMITTER } else { Effects::MEDIA }
    }
}

/// A described medium, without its density.
fn built(described: &describe::Medium) -> Medium {
    let (absorption, scattering, emission, described_phase, priority) = match described {
        describe::Medium::Homogeneous(m) => (&m.absorption, &m.scattering, &m.emission, &m.phase, m.priority),
        describe::Medium::Heterogeneous(m) => (&m.absorption, &m.scattering, &m.emission, &m.phase, m.priority),
        describe::Medium::Subsurface(m) => return translucent(m).with_priority(m.priority),
    };
    let [absorption, scattering] = [absorption, scattering].map(|color| Spectrum::from_coefficients(rgb(color)));
    let built = Medium::new(absorption, scattering, phase(described_phase)).with_priority(priority);
    built.emitting(Spectrum::from_illuminant(rgb(emission)))
}

/// The medium of a translucent body.
fn translucent(described: &Subsurface) -> Medium {
    let scale = described.scale.get();
    let spectrum = |coefficients: [f64; 3]| {
        let [r, g, b] = coefficients.map(|x| (x / scale) as f32);
        Spectrum::from_coefficients(Rgb::new(r, g, b))
    };
    // Scenes that name neither a measured material nor an albedo with a mean free path are refused.
    if let Some(measured) = described.measured {
        let [scattering, absorption] = measured.coefficients();
        return Medium::new(spectrum(absorption), spectrum(scattering), Phase::Isotropic);
    }
    let g = described.g.get();
    let albedo = described.albedo.as_ref().map_or([0.0; 3], Color::linear).map(|albedo| single_scattering_albedo(albedo, g));
    let extinction = described.mean_free_path.as_ref().map_or([1.0; 3], PerChannel::each).map(f64::recip);
    let absorption = std::array::from_fn(|c| (1.0 - albedo[c]) * extinction[c]);
    let scattering = std::array::from_fn(|c| albedo[c] * extinction[c]);
    Medium::new(spectrum(absorption), spectrum(scattering), Phase::henyey_greenstein(g))
}

fn phase(described: &describe::Phase) -> Phase {
    match described {
        describe::Phase::Isotropic(_) => Phase::Isotropic,
        describe::Phase::HenyeyGreenstein(phase) => Phase::henyey_greenstein(phase.g.get()),
        describe::Phase::Rayleigh(_) => Phase::Rayleigh,
        describe::Phase::Mix(mix) => Phase::Mix(Box::new([phase(&mix.a), phase(&mix.b)]), mix.share.get() as f32),
    }
}
