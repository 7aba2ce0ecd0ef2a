//! Scenes without an effect, made by changes of the scene file.

use glam::DVec3;
use serde_json::{Map, Value, json};

use crate::bsdf::described::Dielectric;
use crate::camera::Camera;
use crate::camera::realistic::ThinLens;
use crate::describe;
use crate::effects::Effects;
use crate::error::{Error, Result};
use crate::import::{self, Imported};
use crate::integrator::Entry;
use crate::load::{Loaded, load};
use crate::math::Wavelength;
use crate::reader::from_json;
use crate::scene::Scene as _;

/// Change that takes an effect out of a scene. It need not succeed: [`without`] looks at what is left.
#[derive(Clone, Copy)]
pub enum Change {
    /// One of the scene's description.
    OfScene(fn(&mut Value)),
    /// One of the camera's description, which needs the built camera, for example the focal length of its lens.
    OfCamera(fn(&mut Map<String, Value>, &Camera)),
}

/// The scene after a change, with the integrator that renders it; `None` if the change left the scene as it was, or the effect in it.
///
/// - `effect`: what the scene must not call for any more
///
/// # Errors
/// Those of [`load`].
pub fn without(loaded: &Loaded, effect: Effects, change: Change, tables: &[&[Entry]]) -> Result<Option<Loaded>> {
    let internal = |error: serde_json::Error| Error::Internal(format!("{}: {error}", loaded.file));
    let mut scene = serde_json::to_value(&loaded.root).map_err(internal)?;
    let before = scene.clone();
    match change {
        Change::OfScene(change) => change(&mut scene),
        Change::OfCamera(change) => section(&mut scene, "camera", |described| change(described, loaded.world.camera())),
    }
    if scene == before {
        return Ok(None);
    }
    // A section that the change made is that of the integrator which renders.
    if let Some(integrator) = scene.get_mut("integrator").and_then(Value::as_object_mut) {
        integrator.entry("type").or_insert_with(|| loaded.entry.name.into());
    }
    let root = describe::root(scene.to_string().as_bytes(), &loaded.file)?;
    let (file, files) = (loaded.file.clone(), (*loaded.files).clone());
    let imported = Imported { root, file, files, dialect: &import::NATIVE, notes: vec![] };
    let changed = load(imported, Some(loaded.entry.name), tables)?;
    let is_left = !effect.is_empty() && changed.world.effects().contains(effect);
    Ok((!is_left).then_some(changed))
}

/// No light that was scattered twice or more.
pub fn only_direct(scene: &mut Value) {
    section(scene, "integrator", |integrator| {
        if integrator.get("max_depth").and_then(Value::as_u64).is_none_or(|depth| depth > 1) {
            integrator.insert("max_depth".into(), 1.into());
        }
    });
}

/// A pinhole in the place of the lens.
pub fn pinhole(described: &mut Map<String, Value>, camera: &Camera) {
    match camera {
        Camera::Realistic(lens) => become_thin(described, lens.thin_lens(), 0.0),
        _ => ["f_number", "lens_radius"].iter().for_each(|key| drop(described.remove(*key))),
    }
}

/// A thin lens in the place of a realistic one.
pub fn thin_lens(described: &mut Map<String, Value>, camera: &Camera) {
    if let Camera::Realistic(lens) = camera {
        become_thin(described, lens.thin_lens(), lens.thin_lens().radius);
    }
}

/// Turns a realistic camera into one with a thin lens of this radius. It stays as it is where its transform may change lengths.
fn become_thin(described: &mut Map<String, Value>, lens: ThinLens, radius: f64) {
    let transform = described.get("transform").map(Value::to_string).unwrap_or_default();
    if ["\"scale\"", "\"matrix\""].iter().any(|step| transform.contains(step)) {
        return;
    }
    ["lens", "scale", "aperture_diameter"].iter().for_each(|key| drop(described.remove(*key)));
    described.insert("type".into(), "perspective".into());
    described.insert("focal_length".into(), json!(1000.0 * lens.image_distance));
    described.insert("focus_distance".into(), json!(lens.focus_distance));
    described.insert("lens_radius".into(), json!(radius));
    // The position of a realistic camera is that of its film, that of a perspective camera the place of its lens.
    if let Some(look_at) = described.get_mut("look_at") {
        let point = |key: &str| -> Option<DVec3> { serde_json::from_value::<[f64; 3]>(look_at[key].clone()).ok().map(DVec3::from) };
        if let (Some(from), Some(to)) = (point("from"), point("to")) {
            let shift = (to - from).normalize_or_zero() * lens.place;
            look_at["from"] = json!((from + shift).to_array());
            look_at["to"] = json!((to + shift).to_array());
        }
        return;
    }
    let steps = described.entry("transform").or_insert_with(|| json!([]));
    if let Some(steps) = steps.as_array_mut() {
        steps.insert(0, json!({ "translate": [0, 0, -lens.place] }));
    }
}

/// Sets the shutter to a single time in the middle of the exposure: no motion blur.
pub fn frozen(scene: &mut Value) {
    section(scene, "shutter", |shutter| {
        let time = |key: &str, default: f64| shutter.get(key).and_then(Value::as_f64).unwrap_or(default);
        let middle = 0.5 * time("open", 0.0) + 0.5 * time("close", 1.0);
        ["open", "close"].iter().for_each(|key| drop(shutter.insert((*key).into(), json!(middle))));
    });
}

/// Textures looked up at points.
pub fn point_lookups(scene: &mut Value) {
    section(scene, "film", |film| drop(film.insert("texture_footprint".into(), 0.into())));
}

/// Removes `smooth_shadows` from meshes: shadows are those of the flat facets.
pub fn facets(scene: &mut Value) {
    each_shape(scene, &mut |shape| drop(shape.remove("smooth_shadows")));
}

/// No normal maps and bump maps.
pub fn smooth(scene: &mut Value) {
    unwrap(scene, "bumped");
}

/// Removes alpha masks (cut-outs): the surfaces become solid.
pub fn whole(scene: &mut Value) {
    unwrap(scene, "masked");
}

/// No media, and none of their boundaries that have no surface.
pub fn vacuum(scene: &mut Value) {
    let interfaces: Vec<String> =
        named(scene, "materials").filter(|(_, m)| m["type"] == "interface").map(|(name, _)| name.clone()).collect();
    let is_boundary = |shape: &Value| match shape.get("material") {
        None => shape.get("medium").is_some(),
        Some(Value::String(name)) => interfaces.contains(name),
        Some(material) => material["type"] == "interface",
    };
    each_list(scene, &mut |shapes| shapes.retain(|shape| !is_boundary(shape)));
    each_shape(scene, &mut |shape| drop(shape.remove("medium")));
    remove(scene, "medium");
}

/// Glass with the index at the yellow line of helium for all wavelengths.
pub fn one_index(scene: &mut Value) {
    each_object(scene, &mut |object| {
        let described = (object.get("type").is_some_and(|kind| kind == "dielectric")).then(|| {
            let own = object.iter().filter(|(key, _)| *key != "type").map(|(key, value)| (key.clone(), value.clone()));
            from_json::<Dielectric>(&Value::Object(own.collect()))?.dispersion()
        });
        if let Some(dispersion) = described.flatten() {
            ["abbe", "glass", "cauchy", "sellmeier"].iter().for_each(|key| drop(object.remove(*key)));
            object.insert("eta".into(), json!(dispersion.index(Wavelength::D_LINE)));
        }
    });
}

/// No films on metals, plastics and glass, and panes in the place of films.
pub fn no_films(scene: &mut Value) {
    each_object(scene, &mut |object| match object.get("type").and_then(Value::as_str) {
        Some("conductor") => drop(object.remove("film")),
        Some("dielectric") => {
            // Light that hits more than one facet was lost under the film. It stays lost, so that only the film makes the difference.
            let more = object.remove("film").map(|_| ("multiscatter".to_owned(), json!(false)));
            object.extend(more);
        }
        Some("principled") => drop(object.remove("iridescence")),
        Some("thin_film") => {
            object.remove("thickness");
            let pane = object.remove("pane");
            let eta = pane.or_else(|| object.get("eta").cloned()).unwrap_or(json!(1.33));
            object.insert("eta".into(), eta);
            object.insert("type".into(), "thin_dielectric".into());
        }
        _ => {}
    });
}

/// No curves.
pub fn no_curves(scene: &mut Value) {
    each_list(scene, &mut |shapes| shapes.retain(|shape| shape["type"] != "curves"));
}

/// No emission of surfaces on which points can be sampled.
pub fn no_area_lights(scene: &mut Value) {
    each_shape(scene, &mut |shape| {
        if shape.get("type").is_none_or(|kind| kind != "sdf") {
            shape.remove("emission");
        }
    });
}

/// No lights without a surface.
pub fn no_point_lights(scene: &mut Value) {
    remove(scene, "lights");
}

/// No light from infinitely far away.
pub fn no_background(scene: &mut Value) {
    remove(scene, "background");
}

/// Polished metal and mirrors that are black.
pub fn black_mirrors(scene: &mut Value) {
    blacken(scene, |kind, is_rough| match kind {
        "mirror" => true,
        "conductor" | "metal" => !is_rough,
        _ => false,
    });
}

/// Rough metal and glossy lobes that are black.
pub fn black_gloss(scene: &mut Value) {
    blacken(scene, |kind, is_rough| match kind {
        "phong" | "blinn_phong" => true,
        "conductor" | "metal" => is_rough,
        _ => false,
    });
}

/// Makes materials of some kinds black.
fn blacken(scene: &mut Value, is_meant: fn(&str, bool) -> bool) {
    each_object(scene, &mut |object| {
        let is_rough = object.contains_key("alpha") || object.get("roughness").is_some_and(|roughness| *roughness != json!(0));
        if object.get("type").and_then(Value::as_str).is_some_and(|kind| is_meant(kind, is_rough)) {
            *object = Map::from_iter([("type".to_owned(), "diffuse".into()), ("albedo".to_owned(), 0.into())]);
        }
    });
}

/// Puts the material inside in the place of each material of a kind.
fn unwrap(scene: &mut Value, kind: &str) {
    let inside = named(scene, "materials").map(|(name, material)| (name.clone(), material.clone())).collect::<Map<_, _>>();
    each_object(scene, &mut |object| {
        while object.get("type").is_some_and(|own| own == kind) {
            let surface = match object.get("surface") {
                Some(Value::String(name)) => inside.get(name),
                other => other,
            };
            let Some(Value::Object(surface)) = surface else { return };
            *object = surface.clone();
        }
    });
}

/// Calls `change` for a section of the scene, which is created if there is none.
fn section(scene: &mut Value, name: &str, change: impl FnOnce(&mut Map<String, Value>)) {
    let Some(scene) = scene.as_object_mut() else { return };
    if let Some(section) = scene.entry(name).or_insert_with(|| json!({})).as_object_mut() {
        change(section);
    }
}

/// Removes a section of the scene.
fn remove(scene: &mut Value, name: &str) {
    scene.as_object_mut().map(|scene| scene.remove(name));
}

/// Members of a section with names.
fn named<'v>(scene: &'v Value, section: &str) -> impl Iterator<Item = (&'v String, &'v Value)> {
    scene.get(section).and_then(Value::as_object).into_iter().flatten()
}

/// Calls `change` for each list of shapes: that of the scene, those of named groups, and those within shapes.
fn each_list(scene: &mut Value, change: &mut dyn FnMut(&mut Vec<Value>)) {
    fn inside(shapes: &mut Value, change: &mut dyn FnMut(&mut Vec<Value>)) {
        let Some(shapes) = shapes.as_array_mut() else { return };
        change(shapes);
        shapes.iter_mut().filter_map(|shape| shape.get_mut("shapes")).for_each(|shapes| inside(shapes, change));
    }
    scene.get_mut("shapes").into_iter().for_each(|shapes| inside(shapes, change));
    scene.get_mut("groups").and_then(Value::as_object_mut).into_iter().flatten().for_each(|(_, shapes)| inside(shapes, change));
}

/// Calls `change` for each shape.
fn each_shape(scene: &mut Value, change: &mut dyn FnMut(&mut Map<String, Value>)) {
    each_list(scene, &mut |shapes| shapes.iter_mut().filter_map(Value::as_object_mut).for_each(&mut *change));
}

/// Calls `change` for each object within materials and shapes, but for those of distance fields, whose types have names of materials.
fn each_object(scene: &mut Value, change: &mut dyn FnMut(&mut Map<String, Value>)) {
    fn inside(value: &mut Value, change: &mut dyn FnMut(&mut Map<String, Value>)) {
        match value {
            Value::Array(items) => items.iter_mut().for_each(|item| inside(item, change)),
            Value::Object(object) => {
                change(object);
                object.iter_mut().filter(|(key, _)| *key != "field").for_each(|(_, value)| inside(value, change));
            }
            _ => {}
        }
    }
    let parts = ["materials", "shapes", "groups"];
    let parts = scene.as_object_mut().into_iter().flatten().filter(|(name, _)| parts.contains(&name.as_str()));
    parts.for_each(|(_, part)| inside(part, change));
}
