//! What `pt check` says of a scene: each effect has its true name, and a part that needs it.

use assert_cmd::Command;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::effects::Effects;
use pt::integrators::ALL;
use pt::scene::Scene;

const CAMERA: &str = r#""camera": {"look_at": {"from": [0, 0, 5], "to": [0, 0, 0]}}"#;

fn built(text: &str, folder: &str) -> Built {
    let root = describe::root(text.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
    pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within(folder) }).unwrap_or_else(|e| panic!("{e}"))
}

fn effects(shapes: &str) -> Effects {
    let built = built(&format!(r#"{{"pt": 1, {CAMERA}, "shapes": [{shapes}]}}"#), "");
    assert_eq!(needed(&built), built.world.effects(), "{shapes}");
    built.world.effects()
}

/// Effects that the parts of a scene need, as `pt check` lists them.
fn needed(built: &Built) -> Effects {
    built.needs.iter().map(|(_, needed)| *needed).fold(Effects::NONE, Effects::union)
}

fn ball(material: &str) -> String {
    format!(r#"{{"type": "sphere", "material": {material}}}"#)
}

/// Each material calls for what it does to light: rough metal and rough glass do neither what matte surfaces do nor what smooth ones do.
#[test]
fn materials_call_for_what_they_do() {
    let (mirrors, clear) = (Effects::SPECULAR_REFLECTION, Effects::REFRACTION);
    let (glossy, frosted) = (Effects::GLOSSY_REFLECTION, Effects::ROUGH_REFRACTION);
    for (material, wanted) in [
        (r#"{"type": "diffuse"}"#, Effects::INTERREFLECTION),
        (r#"{"type": "mirror"}"#, mirrors),
        (r#"{"type": "dielectric"}"#, mirrors | clear),
        (r#"{"type": "dielectric", "roughness": 0.3}"#, glossy | frosted),
        (r#"{"type": "conductor", "metal": "Au"}"#, mirrors),
        (r#"{"type": "conductor", "metal": "Au", "roughness": 0.3}"#, glossy),
        (r#"{"type": "conductor", "color": 0.5, "film": {"eta": 1.5, "thickness": 300}}"#, mirrors | Effects::THIN_FILM),
        (r#"{"type": "phong"}"#, glossy),
        (r#"{"type": "coated", "ground": {"type": "diffuse"}}"#, Effects::INTERREFLECTION | mirrors),
        (r#"{"type": "coated", "roughness": 0.3, "ground": {"type": "diffuse"}}"#, Effects::INTERREFLECTION | glossy),
    ] {
        assert_eq!(effects(&ball(material)).to_string(), wanted.to_string(), "{material}");
    }
}

/// Whitted's ray tracing follows single directions and nothing else; light tracing cannot follow them to the camera.
#[test]
fn integrators_lack_what_they_cannot_follow() {
    let lacks = |name: &str, material: &str| {
        ALL.iter().find(|entry| entry.name == name).and_then(|entry| entry.lacks(effects(&ball(material)))).unwrap_or_default()
    };
    assert_eq!(lacks("whitted", r#"{"type": "dielectric"}"#), "");
    assert_eq!(lacks("whitted", r#"{"type": "dielectric", "roughness": 0.3}"#), "glossy reflection, refraction in rough glass");
    assert_eq!(lacks("whitted", r#"{"type": "conductor", "metal": "Au", "roughness": 0.3}"#), "glossy reflection");
    assert!(lacks("light", r#"{"type": "dielectric"}"#).starts_with("mirror reflection, refraction in clear glass ("));
    assert_eq!(lacks("light", r#"{"type": "dielectric", "roughness": 0.3}"#), "");
}

/// A lamp calls for area lights if points on it can be sampled, for chance if not, and for nothing if it is black.
#[test]
fn lamps_call_for_the_way_in_which_they_are_found() {
    let matte = effects(&ball(r#"{"type": "diffuse"}"#));
    let lamp = |shape: &str, radiance: f64| effects(&format!(r#"{{{shape}, "emission": {{"radiance": {radiance}}}}}"#)) - matte;
    let field = r#""type": "sdf", "field": {"type": "sphere", "radius": 1}"#;
    assert_eq!(lamp(r#""type": "sphere""#, 3.0), Effects::AREA_LIGHT);
    assert_eq!(lamp(field, 3.0), Effects::UNSAMPLED_EMITTER);
    assert_eq!([lamp(r#""type": "sphere""#, 0.0), lamp(field, 0.0)], [Effects::NONE; 2]);
    let dark = r#"{"type": "point", "position": [0, 1, 0], "intensity": 0}"#;
    let world = built(&format!(r#"{{"pt": 1, {CAMERA}, "lights": [{dark}]}}"#), "").world;
    assert_eq!(world.effects(), Effects::NONE);
}

/// No points are sampled on a mesh whose vertices move; its light is met by chance, and the mesh is named for it.
#[test]
fn moving_meshes_that_shine_are_met_by_chance() {
    let keyframes = r#"[{"time": 0}, {"time": 1, "positions": [[0, 0, 0], [1, 0, 0], [0, 2, 0]]}]"#;
    let mesh = format!(
        r#"{{"type": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "keyframes": {keyframes}, "emission": 1}}"#
    );
    let built = built(&format!(r#"{{"pt": 1, {CAMERA}, "shutter": {{"open": 0, "close": 1}}, "shapes": [{mesh}]}}"#), "");
    assert!(built.world.effects().contains(Effects::UNSAMPLED_EMITTER | Effects::MOTION));
    assert_eq!(needed(&built), built.world.effects());
}

/// Every effect that a scene calls for is needed by a part, and no part needs more.
#[test]
fn effects_are_those_of_the_parts() {
    for path in ["caustic", "compounds", "cornell-box", "glass-panel", "lanterns", "metals", "mis-plates", "pawns", "statue"] {
        let text = std::fs::read_to_string(format!("scenes/{path}.json")).expect("a scene");
        let built = built(&text, "scenes");
        assert_eq!(needed(&built).to_string(), built.world.effects().to_string(), "{path}");
    }
}

/// Lamps that emit nothing are counted apart.
#[test]
fn check_counts_lights_that_shine() {
    let lamp = |radiance: f64| format!(r#"{{"type": "quad", "size": 1, "emission": {radiance}}}"#);
    let count = |lamps: &[f64]| {
        let shapes: Vec<String> = lamps.iter().map(|radiance| lamp(*radiance)).collect();
        let scene = format!(r#"{{"pt": 1, {CAMERA}, "shapes": [{}]}}"#, shapes.join(", "));
        let check = Command::cargo_bin("pt").expect("the binary").args(["check", "-"]).write_stdin(scene).assert().success();
        let text = String::from_utf8_lossy(&check.get_output().stdout).into_owned();
        text.lines().find_map(|line| line.strip_prefix("lights      ")).map(str::to_owned)
    };
    assert_eq!(count(&[1.0, 2.0]).as_deref(), Some("2"));
    assert_eq!(count(&[0.0, 1.0, 0.0]).as_deref(), Some("1, and 2 that emit nothing"));
}

/// Frosted glass alone: refraction is called for, and what is off is that in clear glass. The list fits into 80 columns.
#[test]
fn check_names_frosted_glass() {
    let scene = format!(r#"{{"pt": 1, {CAMERA}, "shapes": [{}]}}"#, ball(r#"{"type": "dielectric", "roughness": 0.3}"#));
    let check = Command::cargo_bin("pt").expect("the binary").args(["check", "-"]).write_stdin(scene).assert().success();
    let text = String::from_utf8_lossy(&check.get_output().stdout).into_owned();
    let (on, off) = text.split_once("not called for, and off\n").expect("two lists");
    assert!(on.contains("\n  refraction in rough glass\n") && on.contains("\n  glossy reflection\n"), "{text}");
    let list = || off.lines().take_while(|line| line.starts_with("  "));
    assert!(list().all(|line| line.chars().count() <= 80), "{off}");
    let off = list().map(str::trim).collect::<Vec<_>>().join(" ");
    assert!(off.contains("mirror reflection, refraction in clear glass, ") && !off.contains("rough"), "{off}");
}
