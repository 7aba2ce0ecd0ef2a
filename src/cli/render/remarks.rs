//! Notes and warnings about a picture that the user may not expect.

use std::path::PathBuf;

use crate::cli::load::Loaded;
use crate::cli::note;
use crate::cli::tone_mapping::{Exposure, ToneMapping};
use crate::describe::Names;
use crate::film::Image;
use crate::light::{Light, Lights};
use crate::output::{Curve, Format, Tonemap, exposure};
use crate::scene::Scene;

/// Warns about effects that the integrator does not simulate.
pub fn remark_missing_effects(loaded: &Loaded) {
    if let Some(lacks) = loaded.entry.lacks(loaded.world.effects()) {
        note(&format!("note: {} does not simulate what this scene calls for: {lacks}", loaded.entry.name));
    }
}

/// Warns about black pictures and black layers of light.
///
/// - `why`: possible reason for a black picture
pub fn remark_darkness(image: &Image, integrator: &str, why: impl FnOnce() -> Option<String>) {
    let is_black = |names: &[&str]| names.iter().filter_map(|name| image.channel(name)).flatten().all(|value| *value == 0.0);
    let layers: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).filter(|name| is_of_light(name)).collect();
    if is_black(&["R", "G", "B"]) {
        note("warning: the image is black");
        why().iter().for_each(|reason| note(&format!("note: {reason}")));
    } else if !layers.is_empty() && is_black(&layers) {
        note(&format!("warning: {integrator} tells nothing of its light, or there is none in the layers asked for: they are black"));
    }
}

/// Note about lights that emit to one side only, which may be the wrong one.
pub fn one_sided(names: &Names, lights: &Lights) -> Option<String> {
    const NAMED: usize = 3;
    let is_one_sided = |light: &Light| matches!(light, Light::Area(area) if !area.emitter.two_sided);
    let mut lamps: Vec<&str> =
        (0..).zip(lights.iter()).filter(|(_, light)| is_one_sided(light)).map(|(i, _)| names.light(lights, i)).collect();
    lamps.dedup();
    let more = if lamps.len() > NAMED { format!(" and {} more", lamps.len() - NAMED) } else { String::new() };
    let verb = if lamps.len() > 1 { "shine" } else { "shines" };
    lamps.truncate(NAMED);
    let named = lamps.join(", ");
    (!lamps.is_empty()).then(|| format!("{named}{more} {verb} to one side only, that of the normal: turn it, or say \"two_sided\": true"))
}

fn is_of_light(channel: &str) -> bool {
    ["Emission.", "Direct.", "Indirect.", "Light."].iter().any(|layer| channel.starts_with(layer))
}

/// Notes which exposure was chosen, or that another one would show more, if an 8-bit picture is written.
pub fn remark_exposure(tone_mapping: &ToneMapping, outputs: &[PathBuf], image: &Image, tonemap: &Tonemap) {
    let developed = outputs.iter().find(|path| matches!(Format::of(path), Some(Format::Png | Format::Ppm)));
    let Some(developed) = developed.filter(|_| matches!(tonemap.curve, Curve::None | Curve::Filmic | Curve::Agx)) else { return };
    if tone_mapping.exposure == Exposure::Auto {
        note(&format!("note: developed with --exposure {}", tonemap.exposure));
    } else if let Some(fault) = exposure::fault(image, tonemap) {
        let raw = outputs.iter().find(|path| Format::of(path) == Some(Format::Exr));
        let again = raw.map_or(String::new(), |raw| {
            format!("; without a new render:\n  pt image convert {} -o {} --exposure auto", raw.display(), developed.display())
        });
        note(&format!("note: {} is {fault}: --exposure {}, or auto, shows it{again}", developed.display(), exposure::automatic(image)));
    }
}
