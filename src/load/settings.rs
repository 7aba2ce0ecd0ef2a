//! Settings of one render of a scene that is built already: what the scene shows stays, so that nothing is built again.

use std::collections::BTreeSet;

use glam::UVec2;

use super::{Loaded, memory};
use crate::describe;
use crate::error::{Error, Result};
use crate::film::layer::with_lights;
use crate::film::{Crop, Layer, LightNames};
use crate::medium::Media;
use crate::reader::unknown;
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene as _;

/// Settings of one render, each in place of the scene's own if it is given. Numbers are of a wider type than scenes allow, so that the
/// refusal of one names its range.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Samples per pixel.
    pub spp: Option<i128>,
    /// Seed of the random numbers.
    pub seed: Option<i128>,
    /// Name of the sampler.
    pub sampler: Option<String>,
    /// Number of independent scramblings that share the samples of a pixel.
    pub scramblings: Option<i128>,
    /// Pixels to render: x0, x1, y0, y1 with x0 ≤ x < x1 and y0 ≤ y < y1.
    pub crop: Option<[i128; 4]>,
    /// Names of the layers beside the picture.
    pub layers: Option<Vec<String>>,
}

impl Settings {
    /// Key of each setting that is given, as messages name it, with the JSON pointer and the JSON text of the value.
    fn values(&self) -> Result<Vec<(&'static str, &'static str, String)>> {
        let sampler = self.sampler.as_deref().map(sampler_named).transpose()?.map(Kind::name);
        let layers = self.layers.as_deref().map(|names| layers_named("layers", names)).transpose()?;
        let all = [
            ("spp", "/sampler/spp", self.spp.map(|spp| spp.to_string())),
            ("seed", "/sampler/seed", self.seed.map(|seed| seed.to_string())),
            ("sampler", "/sampler/type", sampler.map(|name| format!("{name:?}"))),
            ("scramblings", "/sampler/scramblings", self.scramblings.map(|k| k.to_string())),
            ("crop", "/film/crop", self.crop.map(|crop| format!("{crop:?}"))),
            ("layers", "/film/layers", layers.map(|names| format!("{names:?}"))),
        ];
        Ok(all.into_iter().filter_map(|(key, pointer, value)| Some((key, pointer, value?))).collect())
    }
}

impl Loaded {
    /// The scene with other settings. The world is shared.
    ///
    /// # Errors
    /// `Usage` for a value that scenes cannot have, `Limit` if the picture does not fit into memory.
    pub fn with(&self, settings: &Settings) -> Result<Loaded> {
        let mut loaded = self.clone();
        let values = settings.values()?;
        if values.is_empty() {
            return Ok(loaded);
        }
        for (key, pointer, value) in &values {
            loaded.root.set_by(&format!("{key}={value}"), pointer, value)?;
        }
        let described = describe::read_with(&loaded.root, &self.file, &self.files)?;
        let scramblings = if settings.scramblings.is_some() { described.sampler.scramblings } else { self.description.sampler.scramblings };
        loaded.description.film = described.film;
        loaded.description.sampler = describe::Sampler { scramblings, ..described.sampler };
        memory::check(&loaded.description, &loaded.root, &self.file)?;
        let [x0, x1, y0, y1] = loaded.description.film.bounds();
        loaded.film.crop = Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) };
        if let Some(names) = &settings.layers {
            loaded.set_layers(names)?;
        }
        let describe::Sampler { spp, seed, .. } = loaded.description.sampler;
        loaded.sampler = SamplerSpec { spp: spp.get().into(), seed, scramblings: scramblings.get(), ..self.sampler };
        if let Some(name) = &settings.sampler {
            loaded.sampler.kind = sampler_named(name)?;
        }
        Ok(loaded)
    }

    /// Replaces the layers of the film, in the order that a scene file gives them.
    fn set_layers(&mut self, names: &[String]) -> Result<()> {
        let layers: BTreeSet<Layer> = layers_named("layers", names)?.into_iter().filter_map(Layer::named).collect();
        let (film, world) = (&mut self.film, &self.world);
        (film.layers, film.lights) = (layers.into_iter().collect(), LightNames::default());
        if film.layers.contains(&Layer::Light(0)) {
            film.lights = self.names.lights(world.lights(), world.media().is_some_and(Media::emits));
            film.layers = with_lights(&film.layers, film.lights.names.len());
        }
        Ok(())
    }
}

/// Sampler of this name.
///
/// # Errors
/// `Usage` for an unknown name.
pub fn sampler_named(name: &str) -> Result<Kind> {
    let known: Vec<&str> = Kind::ALL.iter().map(|(_, name, _)| *name).collect();
    let found = Kind::named(name);
    found.ok_or_else(|| Error::Usage(unknown("sampler", name, &known)))
}

/// Layers of these names; `all` stands for those that do not depend on the clock.
///
/// - `option`: where the names were given, for messages
///
/// # Errors
/// `Usage` for an unknown name.
pub fn layers_named(option: &str, names: &[String]) -> Result<Vec<&'static str>> {
    const EVERY: &str = "all";
    let known: Vec<&str> = Layer::ALL.iter().map(|row| row.1).chain([EVERY]).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(Error::Usage(format!("{option}: {}", unknown("layer", name, &known))));
    }
    let has = |name: &str| names.iter().any(|other| other == name);
    let rows = Layer::ALL.iter().filter(|(layer, name, _)| has(name) || has(EVERY) && layer.is_reproducible());
    Ok(rows.map(|row| row.1).collect())
}
