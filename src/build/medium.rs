//! Builds media.

use std::collections::BTreeMap;

use super::{Builder, rgb};
use crate::describe::volume::Quantity;
use crate::describe::{self, Color, MediumRef, PerChannel, Subsurface};
use crate::effects::Effects;
use crate::format::Radiometric;
use crate::math::{Rgb, Spectrum};
use crate::medium::subsurface::single_scattering_albedo;
use crate::medium::{MOST_DEPTH, Medium, MediumId, Phase, Varying};
use crate::reader::escaped;

impl Builder<'_> {
    /// Builds a medium, or finds it if it was built before. Also returns the effects that an integrator must simulate for it: if it emits, its
    /// light is not sampled, so that paths find it only by chance.
    pub(super) fn medium(&mut self, pointer: &str, chosen: &MediumRef) -> (MediumId, Effects) {
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
                let built = built(described);
                if !built.extinction().is_finite() {
                    self.fault(&key, "coefficients beyond the range of 32-bit floats: give longer lengths or a larger scale");
                }
                match described {
                    describe::Medium::Heterogeneous(described) => self.heterogeneous(&key, described, built),
                    describe::Medium::Homogeneous(_) | describe::Medium::Subsurface(_) => built,
                }
            }
        };
        let effects = if built.emits() { Effects::MEDIA | Effects::UNSAMPLED_EMITTER } else { Effects::MEDIA };
        let known = (self.world.medium(built), effects);
        self.media.insert(key, known);
        known
    }

    /// A medium with its density, and what else varies in it; without them after adding a fault.
    fn heterogeneous(&mut self, pointer: &str, described: &describe::Heterogeneous, medium: Medium) -> Medium {
        let at = format!("{pointer}/density");
        let Some((density, of_file)) = self.density(&at, &described.density) else { return medium };
        let medium = self.checked(&at, medium.with_density(density));
        // Boxes of the files do not matter where the scene gives one for all.
        let must_agree = described.density.bounds().is_none();
        let mut grid = |key: &str, grid: &Option<describe::ColorGrid>, quantity| {
            grid.as_ref().and_then(|grid| self.color_grid(&format!("{pointer}/{key}"), grid, quantity, of_file, must_agree))
        };
        let albedo = grid("albedo_grid", &described.albedo_grid, Quantity::Albedo);
        let emission = grid("emission_grid", &described.emission_grid, Quantity::Emission);
        let brightest = f64::from(rgb(&described.emission).max()) * emission.as_ref().map_or(1.0, |grid| f64::from(grid.max()));
        if !Radiometric::RANGE.contains(brightest) {
            let message = format!("an emission of {brightest:.1e}, expected a number {}: make its factors smaller", Radiometric::RANGE);
            self.fault(&format!("{pointer}/emission_grid"), &message);
        }
        if albedo.is_none() && emission.is_none() { medium } else { medium.with_varying(Varying { albedo, emission }) }
    }

    /// A medium with a density, after adding a fault if it is too dense.
    fn checked(&mut self, pointer: &str, medium: Medium) -> Medium {
        let depth = medium.most_per_cell();
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
        let mut named: Vec<(MediumId, &str)> = self.media.iter().map(|(key, (id, _))| (*id, key.as_str())).collect();
        named.sort();
        let named_media = self.scene.media.keys().map(|name| (format!("/media{}", escaped(name)), name));
        let names: BTreeMap<String, &String> = named_media.collect();
        named.into_iter().map(|(_, key)| names.get(key).map_or_else(|| key.to_owned(), |name| (*name).clone())).collect()
    }

    /// Builds the medium around all shapes.
    pub(super) fn surroundings(&mut self) {
        let Some(described) = &self.scene.medium else { return };
        let (medium, effects) = self.medium("/medium", described);
        self.world.surround(medium);
        self.override_needs.push(("/medium, around all shapes".to_owned(), effects));
    }
}

/// A described medium, without what varies in it.
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
