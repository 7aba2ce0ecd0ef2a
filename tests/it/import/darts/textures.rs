//! Textures of dirt and darts: their values equal the formulas, in each dialect's spelling.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use glam::DVec3;

use crate::import::read::{Read, met, read, reflected};
use crate::random::Random;

/// The spelling of a dialect: keys of the scene and of a texture's colours, and the names of a matte material and its colour.
struct Dialect {
    told_by: &'static str,
    diffuse: &'static str,
    color: &'static str,
}

const DIRT: Dialect = Dialect { told_by: r#""image_samples": 1"#, diffuse: "lambertian", color: "albedo" };
const DARTS_2021: Dialect = Dialect { told_by: r#""sampler": { "samples": 1 }"#, diffuse: "lambertian", color: "albedo" };
const DARTS: Dialect = Dialect { told_by: r#""sampler": { "samples": 1 }"#, diffuse: "diffuse", color: "color" };

/// A sphere with this texture.
fn sphere(folder: &Path, dialect: &Dialect, texture: &str, transform: &str) -> Read {
    let Dialect { told_by, diffuse, color } = dialect;
    let scene = format!(
        r#"{{ "camera": {{ "resolution": 4 }}, {told_by}, "surfaces": [{{ "type": "sphere", "radius": 2, {transform}
            "material": {{ "type": "{diffuse}", "name": "it", "{color}": {texture} }} }}] }}"#
    );
    fs::write(folder.join("scene.json"), scene).expect("a scene");
    read(&folder.join("scene.json"))
}

/// Checks a checker at a thousand places of a sphere about the origin.
///
/// - `cells`: the place in cells of width 1
/// - `dark_if_odd`: whether the darker colour is where the sum of the cell's indices is odd, or else where it is even
fn checks(dialect: &Dialect, texture: &str, cells: impl Fn(DVec3) -> DVec3, dark_if_odd: bool) {
    let folder = tempfile::tempdir().expect("a folder");
    let found = sphere(folder.path(), dialect, texture, "");
    assert!(found.notes.is_empty(), "{texture}: {:?}", found.notes);
    let (built, mut random, mut dark) = (found.built(), Random::new(151), 0);
    for _ in 0..1000 {
        let from = 5.0 * random.direction();
        let (albedo, p) = met(&built, from.to_array(), (-from).as_vec3().to_array(), |surface, p| (reflected(surface).average(), p));
        let cell = cells(p);
        // Points within some roundings of 30 cells from a wall are skipped, because they may belong to either cell.
        if (cell - cell.round()).abs().min_element() < 1e-4 {
            continue;
        }
        let is_odd = cell.floor().element_sum().rem_euclid(2.0) == 1.0;
        assert_eq!(albedo < 0.5, is_odd == dark_if_odd, "{texture} at {p}: {albedo}");
        dark += u32::from(albedo < 0.5);
    }
    assert!((300..700).contains(&dark), "{texture}: {dark} of 1000 are dark");
}

/// sin(scale · p) in dirt and sin(p / scale) in darts of 2021 change their signs where the argument is a whole number of π; the cubes of
/// 2024 and later are 1 / scale wide.
#[test]
fn each_dialect_has_checkers_of_its_own() {
    for scale in [0.1, 0.25, 1.0, 7.0] {
        let waves = format!(r#"{{ "type": "checker", "even": 0.9, "odd": 0.1, "scale": {scale} }}"#);
        checks(&DARTS_2021, &waves, |p| p / (scale * PI), true);
        let waves = format!(r#"{{ "type": "checker", "even": 0.9, "odd": 0.1, "scale": {} }}"#, 1.0 / scale);
        checks(&DIRT, &waves, |p| p / (scale * PI), true);
        let cubes = format!(r#"{{ "type": "checker", "color1": 0.9, "color2": 0.1, "scale": {} }}"#, 1.0 / scale);
        checks(&DARTS, &cubes, |p| p / scale, false);
    }
}

/// Named texture coordinates are used exactly, and each type of mapping gives its coordinates.
#[test]
fn coordinates_of_the_newest_dialect() {
    let checker = |vector: &str| format!(r#"{{ "type": "checker", "color1": 0.9, "color2": 0.1, "scale": 2, "vector": {vector} }}"#);
    let steps = r#"[{ "scale": [2, 3, 4] }, { "translate": [0.3, 0.2, 0.1] }]"#;
    let map = |p: DVec3| p * DVec3::new(2.0, 3.0, 4.0) + DVec3::new(0.3, 0.2, 0.1);
    let back = |p: DVec3| (p - DVec3::new(0.3, 0.2, 0.1)) / DVec3::new(2.0, 3.0, 4.0);
    checks(&DARTS, &checker(r#"{ "type": "coord", "coordinate": "world" }"#), |p| 2.0 * p, false);
    let mapping = |kind: &str| {
        let world = r#"{ "type": "coord", "coordinate": "world" }"#;
        checker(&format!(r#"{{ "type": "mapping", "vector type": "{kind}", "transform": {steps}, "vector": {world} }}"#))
    };
    checks(&DARTS, &mapping("point"), |p| 2.0 * map(p), false);
    checks(&DARTS, &mapping("texture"), |p| 2.0 * back(p), false);
}

/// On a sphere a picture lies at u = φ/2π + ½ and v = 1 − θ/π, upwards from its lower left corner: φ about z from x, θ from z.
#[test]
fn pictures_lie_on_spheres_as_in_the_originals() {
    const SIZE: (u32, u32) = (8, 6);
    let gray = |x: u32, y: u32| (5 * (y * SIZE.0 + x)) as u8;
    let folder = tempfile::tempdir().expect("a folder");
    let map = image::RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| image::Rgb([gray(x, y); 3]));
    map.save(folder.path().join("map.png")).expect("a picture");
    let linear = |level: u8| {
        let encoded = f64::from(level) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    // A rotation by 90° about x takes z to −y.
    let turned = |p: DVec3| DVec3::new(p.x, -p.z, p.y);
    for (dialect, quarter) in [
        (&DIRT, r#"{ "axis": [1, 0, 0], "angle": 90 }"#),
        (&DARTS_2021, r#"{ "axis": [1, 0, 0], "angle": 90 }"#),
        (&DARTS, r#"{ "rotate": [90, 1, 0, 0] }"#),
    ] {
        let transform = format!(r#""transform": [{quarter}, {{ "translate": [3, 2, 1] }}],"#);
        let image = r#"{ "type": "image", "filename": "map.png" }"#;
        for (transform, place) in [(String::new(), None), (transform, Some(DVec3::new(3.0, 2.0, 1.0)))] {
            let found = sphere(folder.path(), dialect, image, &transform);
            assert!(found.notes.is_empty(), "{:?}", found.notes);
            let built = found.built();
            for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
                // The centre of this pixel, whose rows are counted from above.
                let (u, v) = ((f64::from(x) + 0.5) / f64::from(SIZE.0), 1.0 - (f64::from(y) + 0.5) / f64::from(SIZE.1));
                let (phi, theta) = ((u - 0.5) * TAU, (1.0 - v) * PI);
                let own = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                let out = if place.is_some() { turned(own) } else { own };
                let from = place.unwrap_or_default() + 5.0 * out;
                let shown = met(&built, from.to_array(), (-out).as_vec3().to_array(), |surface, _| reflected(surface).average());
                // Neighbouring pixels differ by at most 40 levels. Rounding to f32 moves the position by 1e-6 of a pixel and changes
                // colours by 1e-7.
                let expected = linear(gray(x, y));
                assert!((f64::from(shown) - expected).abs() < 1e-5, "({x}, {y}): {shown}, expected {expected}");
            }
        }
    }
}
