//! The table of what is measured: which paths contain an effect, and how a scene is without it.

use serde_json::{Map, Value};

use super::paths::PathFacts;
use super::without::{self, Change};
use crate::camera::Camera;
use crate::effects::Effects;

/// Part of the light, or effect of a scene, that is measured.
#[derive(Clone, Copy)]
pub struct Subject {
    /// Name in reports; the effect's own where it is empty.
    name: &'static str,
    /// The effect; none for parts of the light that every scene has.
    pub effect: Effects,
    /// Whether a path contains it; `None` where it is no matter of paths.
    pub contains: Option<fn(&PathFacts) -> bool>,
    /// Whether a picture without it is the picture without these paths. Otherwise only `change` can leave it out.
    pub is_light: bool,
    /// The change of the scene that leaves it out, if there is one.
    pub change: Option<Change>,
}

type OfScene = fn(&mut Value);

const fn paths(name: &'static str, effect: Effects, contains: fn(&PathFacts) -> bool, change: Option<OfScene>) -> Subject {
    let change = match change {
        Some(change) => Some(Change::OfScene(change)),
        None => None,
    };
    Subject { name, effect, contains: Some(contains), is_light: true, change }
}

/// An effect whose absence changes light in another way than to remove paths.
const fn change(effect: Effects, contains: Option<fn(&PathFacts) -> bool>, change: Option<OfScene>) -> Subject {
    let change = match change {
        Some(change) => Some(Change::OfScene(change)),
        None => None,
    };
    Subject { name: "", effect, contains, is_light: false, change }
}

/// An effect of the camera.
const fn camera(effect: Effects, change: fn(&mut Map<String, Value>, &Camera)) -> Subject {
    Subject { name: "", effect, contains: None, is_light: false, change: Some(Change::OfCamera(change)) }
}

/// Lobes that focus light.
const FOCUSING: Effects =
    Effects::SPECULAR_REFLECTION.union(Effects::GLOSSY_REFLECTION).union(Effects::REFRACTION).union(Effects::ROUGH_REFRACTION);

/// Scattering that is not that of matte surfaces.
const NOT_MATTE: Effects = FOCUSING.union(Effects::MEDIA);

/// All that is measured. The first three are disjoint and make up all light, and so do those of the lamps.
const ALL: [Subject; 25] = [
    paths("light seen at its source", Effects::NONE, |path| path.depth == 0, None),
    paths("direct light", Effects::NONE, |path| path.depth == 1, None),
    paths("indirect light", Effects::NONE, |path| path.depth > 1, Some(without::only_direct)),
    paths("caustics", Effects::NONE, |path| path.is_caustic, None),
    paths("", Effects::AREA_LIGHT, |path| path.light == Effects::AREA_LIGHT, Some(without::no_area_lights)),
    paths("", Effects::POINT_LIGHT, |path| path.light == Effects::POINT_LIGHT, Some(without::no_point_lights)),
    paths("", Effects::ENVIRONMENT, |path| path.light == Effects::ENVIRONMENT, Some(without::no_background)),
    paths("", Effects::UNSAMPLED_EMITTER, |path| path.light == Effects::UNSAMPLED_EMITTER, None),
    paths("", Effects::INTERREFLECTION, |path| path.matte > 1, None),
    paths("", Effects::SPECULAR_REFLECTION, |path| path.scattered.contains(Effects::SPECULAR_REFLECTION), Some(without::black_mirrors)),
    paths("", Effects::GLOSSY_REFLECTION, |path| path.scattered.contains(Effects::GLOSSY_REFLECTION), Some(without::black_gloss)),
    paths("", Effects::REFRACTION, |path| path.scattered.contains(Effects::REFRACTION), None),
    paths("", Effects::ROUGH_REFRACTION, |path| path.scattered.contains(Effects::ROUGH_REFRACTION), None),
    camera(Effects::THIN_LENS, without::pinhole),
    camera(Effects::REALISTIC_LENS, without::thin_lens),
    change(Effects::MOTION, None, Some(without::frozen)),
    change(Effects::MEDIA, Some(|path| path.scattered.contains(Effects::MEDIA)), Some(without::vacuum)),
    change(Effects::TEXTURES, Some(|path| path.scattered.contains(Effects::TEXTURES)), None),
    change(Effects::FOOTPRINTS, None, Some(without::point_lookups)),
    change(Effects::SHADING_NORMALS, Some(|path| path.scattered.contains(Effects::SHADING_NORMALS)), Some(without::smooth)),
    change(Effects::SMOOTH_SHADOWS, None, Some(without::facets)),
    change(Effects::CUT_OUTS, Some(|path| path.scattered.contains(Effects::CUT_OUTS)), Some(without::whole)),
    change(Effects::DISPERSION, Some(|path| path.scattered.contains(Effects::DISPERSION)), Some(without::one_index)),
    change(Effects::THIN_FILM, Some(|path| path.scattered.contains(Effects::THIN_FILM)), Some(without::no_films)),
    change(Effects::CURVES, Some(|path| path.scattered.contains(Effects::CURVES)), Some(without::no_curves)),
];

impl Subject {
    /// Name in reports.
    pub fn name(&self) -> String {
        if self.name.is_empty() { self.effect.to_string() } else { self.name.to_owned() }
    }

    /// Effects that the changed scene must not need any more. Interreflection is exempt, because the matte surfaces stay.
    pub fn gone(&self) -> Effects {
        self.effect - Effects::INTERREFLECTION
    }

    /// Those that a scene with these effects has.
    pub fn of(effects: Effects) -> Vec<Subject> {
        let is_focused = effects.contains(Effects::INTERREFLECTION) && FOCUSING.iter().any(|lobe| effects.contains(lobe));
        let has = |subject: &Subject| match subject.name {
            "caustics" => is_focused,
            _ => effects.contains(subject.effect),
        };
        let is_all_matte = NOT_MATTE.iter().all(|other| !effects.contains(other));
        let fitted = |subject: &Subject| match subject.effect {
            // Among matte surfaces all light that was scattered twice is theirs.
            Effects::INTERREFLECTION if is_all_matte => Subject { change: Some(Change::OfScene(without::only_direct)), ..*subject },
            _ => *subject,
        };
        ALL.iter().filter(|subject| has(subject)).map(fitted).collect()
    }
}
