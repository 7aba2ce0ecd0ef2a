//! Conversion of a library's materials.
//!
//! Phong's exponent n and a microfacet's width α fit at α² = 2/(n + 2) (Walter et al. 2007), and α = roughness².

use super::library::Entry;
use crate::import::json_cursor::JsonCursor;
use crate::import::model::DIFFUSE;
use crate::reader::Node;

/// Models of illumination for glass: ray-traced refraction.
const GLASS: [u32; 4] = [4, 6, 7, 9];

/// Converts a material.
pub fn material(at: &JsonCursor, name: &str, entry: &Entry) -> Node {
    let surface = surface(at, name, entry);
    let image = |file: &String| at.make_object([("type", at.make_text("image")), ("file", at.make_text(file))]);
    let bumped = match &entry.normal_map {
        Some(map) => kind(at, "bumped", [("surface", surface), ("normal_map", image(map))]),
        None => surface,
    };
    let opacity = match (&entry.opacity_map, entry.opacity) {
        _ if is_glass(entry) => return bumped,
        (Some(map), _) => {
            let linear = ("encoding", at.make_text("linear"));
            kind(at, "image", [("file", at.make_text(map)), linear])
        }
        (None, Some(share)) if share < 1.0 => at.make_number(share),
        _ => return bumped,
    };
    if entry.emits() {
        at.note(format!("material {name:?}: what shines has no holes, its transparency is left out"));
        return bumped;
    }
    kind(at, "masked", [("surface", bumped), ("opacity", opacity)])
}

fn surface(at: &JsonCursor, name: &str, entry: &Entry) -> Node {
    let roughness = ("roughness", at.make_number(roughness(entry)));
    let eta = entry.eta.filter(|eta| (1.0..=100.0).contains(eta) && *eta != 1.0).unwrap_or(1.5);
    let eta = ("eta", at.make_number(eta));
    let has_diffuse = entry.diffuse_map.is_some() || entry.diffuse.is_none_or(|kd| kd.iter().any(|x| *x > 0.0));
    let shines = entry.specular.iter().any(|x| *x > 0.0) && entry.illum != 1;
    if is_glass(entry) {
        let color = fractions(at, name, entry.filter.unwrap_or([1.0; 3]));
        kind(at, "dielectric", [("color", color), roughness, eta])
    } else if entry.roughness.is_some() || entry.metallic.is_some() {
        let metallic = ("metallic", at.make_number(entry.metallic.unwrap_or(0.0).min(1.0)));
        kind(at, "principled", [("base_color", diffuse(at, name, entry)), metallic, roughness, eta])
    } else if !shines {
        kind(at, "diffuse", [("albedo", diffuse(at, name, entry))])
    } else if has_diffuse {
        kind(at, "principled", [("base_color", diffuse(at, name, entry)), roughness, eta])
    } else {
        kind(at, "conductor", [("color", fractions(at, name, entry.specular)), roughness])
    }
}

fn is_glass(entry: &Entry) -> bool {
    GLASS.contains(&entry.illum)
}

fn roughness(entry: &Entry) -> f64 {
    match entry.roughness {
        Some(roughness) => roughness.min(1.0),
        None if is_glass(entry) => 0.0,
        None => (2.0 / (entry.exponent + 2.0)).powf(0.25),
    }
}

/// `map_Kd` times `Kd`; with a black `Kd` the map is used alone, as programs mean it.
fn diffuse(at: &JsonCursor, name: &str, entry: &Entry) -> Node {
    let color = |kd| fractions(at, name, kd);
    let kd = entry.diffuse;
    match &entry.diffuse_map {
        None => color(kd.unwrap_or([DIFFUSE; 3])),
        Some(map) => {
            let image = kind(at, "image", [("file", at.make_text(map))]);
            match kd.filter(|kd| *kd != [0.0; 3] && *kd != [1.0; 3]) {
                Some(kd) => kind(at, "product", [("a", image), ("b", color(kd))]),
                None => image,
            }
        }
    }
}

fn fractions(at: &JsonCursor, name: &str, color: [f64; 3]) -> Node {
    if color.iter().any(|x| *x > 1.0) {
        at.note(format!("material {name:?}: a colour above 1 is taken as 1"));
    }
    at.make_numbers(color.map(|x| x.min(1.0)))
}

fn kind<const N: usize>(at: &JsonCursor, kind: &str, members: [(&'static str, Node); N]) -> Node {
    at.make_object(std::iter::once(("type", at.make_text(kind))).chain(members))
}
