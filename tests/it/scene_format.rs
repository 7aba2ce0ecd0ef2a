//! The scene format: its schema, its documentation and its types agree, and a written scene reads back the same.

use std::collections::BTreeSet;
use std::path::Path;

use pt::describe::{self, Scene};
use serde_json::Value;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/scene-format.md");
/// Marker in the page after which the text is generated. The text before it is written by hand.
const MARK: &str = "<!-- tables -->\n";

/// A scene of every construct of which a scene can have more than one.
pub const EVERYTHING: &str = include_str!("everything.json");

/// The alternatives of which a scene has only one, with their pointers.
const ALTERNATIVES: [(&str, &str); 16] = [
    ("/camera", r#"{"type": "orthographic", "height": 3, "look_at": {"from": [0, 1, 5], "to": [0, 1, 0]}}"#),
    ("/camera", r#"{"focal_length": 50, "sensor": 24, "f_number": 1.8, "focus_distance": 3}"#),
    ("/camera", r#"{"focal_length": 35, "sensor": [36, 24]}"#),
    ("/camera", r#"{"type": "fisheye", "fov": 200, "mapping": "stereographic", "look_at": {"from": [0, 1, 5], "to": [0, 1, 0]}}"#),
    (
        "/camera",
        r#"{"type": "realistic", "lens": [[50, 3, 1.5, 20], [-50, 1, 1, 20], [0, 0, 0, 12.5]], "scale": 0.9, "aperture_diameter": 4, "focus_distance": 3, "sensor": 15.6}"#,
    ),
    ("/camera", r#"{"type": "realistic", "lens": "dgauss.dat", "sensor": [36, 24], "look_at": {"from": [0, 1, 5], "to": [0, 1, 0]}}"#),
    ("/camera", r#"{"type": "spherical", "transform": [{"scale": 2}]}"#),
    ("/film/filter", r#"{"type": "box", "radius": 1}"#),
    ("/film/filter", r#"{"type": "tent", "radius": 2}"#),
    ("/film/filter", r#"{"type": "gaussian", "radius": 2, "sigma": 0.7}"#),
    (
        "/background",
        r#"{"image": "sky.hdr", "mapping": "octahedral", "encoding": "linear", "scale": [1, 2, 3], "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 90}}]}"#,
    ),
    (
        "/background",
        r#"{"sky": {"elevation": 5, "azimuth": 90, "irradiance": [3, 2, 1], "turbidity": 3, "ground": 0.1, "altitude": 100, "sun": false}}"#,
    ),
    ("/background", r#"{"sky": {"place": {"latitude": 48.1, "longitude": 11.6, "time": "2026-06-21T18:30+02:00"}}}"#),
    ("/sampler/type", "independent"),
    ("/sampler/type", "stratified"),
    ("/sampler/type", "sobol"),
];

/// The scene [`EVERYTHING`], and copies of it, each with one alternative.
fn scenes() -> Vec<Scene> {
    let root = describe::root(EVERYTHING.as_bytes(), "everything.json").unwrap_or_else(|e| panic!("{e}"));
    let with = |(pointer, value): &(&str, &str)| {
        let mut root = root.clone();
        root.set(pointer, value).unwrap_or_else(|e| panic!("{e}"));
        root
    };
    let roots = std::iter::once(root.clone()).chain(ALTERNATIVES.iter().map(with));
    roots.map(|root| describe::read(&root, "everything.json").unwrap_or_else(|e| panic!("{e}"))).collect()
}

fn page() -> String {
    std::fs::read_to_string(PAGE).unwrap_or_else(|e| panic!("{PAGE}: {e}"))
}

#[test]
fn tables_of_the_page_are_those_of_the_code() {
    let page = page();
    let (by_hand, tables) = page.split_once(MARK).expect("the mark");
    let wanted = format!("\n{}", describe::reference(&[pt::integrators::ALL]));
    if std::env::var_os("PT_BLESS").is_some() {
        std::fs::write(PAGE, format!("{by_hand}{MARK}{wanted}")).unwrap();
        return;
    }
    let different = tables.lines().zip(wanted.lines()).enumerate().find(|(_, (is, should))| is != should);
    assert!(tables == wanted, "run PT_BLESS=1 cargo test --test it scene_format; first difference: {different:?}");
}

#[test]
fn examples_of_the_page_are_scenes() {
    let page = page();
    let examples: Vec<&str> = page.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(examples.len(), 2);
    for example in examples {
        describe::parse(example.as_bytes(), "example").unwrap_or_else(|e| panic!("{e}\nin\n{example}"));
    }
}

/// The objects of the schema that describe an object with keys, and a name to find them by.
fn objects<'s>(schema: &'s Value, at: &str, found: &mut Vec<(String, &'s Value)>) {
    if schema.get("properties").is_some() {
        found.push((at.to_owned(), schema));
    }
    match schema {
        Value::Object(map) => map.iter().for_each(|(key, value)| objects(value, &format!("{at}/{key}"), found)),
        Value::Array(items) => items.iter().enumerate().for_each(|(i, value)| objects(value, &format!("{at}/{i}"), found)),
        _ => {}
    }
}

#[test]
fn every_key_is_documented() {
    let schema = describe::schema(&[pt::integrators::ALL]).to_value();
    let page = page();
    let mut found = vec![];
    objects(&schema, "", &mut found);
    assert!(found.len() > 25, "the walk finds the objects: {}", found.len());
    for (at, object) in found {
        for (key, property) in object["properties"].as_object().expect("an object") {
            let one_of_its_kind = property.get("const").is_some() || object["properties"].as_object().is_some_and(|p| p.len() == 1);
            assert!(one_of_its_kind || property.get("description").is_some(), "{at}: {key:?} has no doc comment");
            let row = format!("| `{key}` |");
            assert!(property.get("const").is_some() || page.contains(&row), "{at}: {key:?} is not on the page");
        }
    }
}

#[test]
fn schema_has_no_null() {
    assert!(!describe::schema(&[pt::integrators::ALL]).to_value().to_string().contains("\"null\""));
}

#[test]
fn what_is_written_reads_back_equal() {
    for scene in scenes() {
        let written = serde_json::to_string_pretty(&scene).unwrap();
        let again = describe::parse(written.as_bytes(), "written").unwrap_or_else(|e| panic!("{e}\nin\n{written}"));
        assert_eq!(scene, again);
    }
}

/// The scenes of the round-trip test use every key and type of the schema, so that none is untested.
#[test]
fn everything_uses_every_key() {
    let mut used = BTreeSet::new();
    scenes().iter().for_each(|scene| keys_and_types(&serde_json::to_value(scene).unwrap(), &mut used));
    // A scene has one integrator, so the options of integrators are not counted as keys of the scene.
    let schema = describe::schema(&[]).to_value();
    let mut found = vec![];
    objects(&schema, "", &mut found);
    for (at, object) in found {
        for (key, property) in object["properties"].as_object().expect("an object") {
            let word = property.get("const").and_then(Value::as_str).unwrap_or(key);
            assert!(used.contains(word), "{at}: {word:?} is not used in everything.json");
        }
    }
}

fn keys_and_types(value: &Value, used: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| {
            used.insert(key.clone());
            keys_and_types(value, used);
        }),
        Value::Array(items) => items.iter().for_each(|item| keys_and_types(item, used)),
        Value::String(text) => drop(used.insert(text.clone())),
        _ => {}
    }
}

#[test]
fn minimal_scene_has_the_defaults_of_the_page() {
    let scene = describe::parse(br#"{"pt": 1, "camera": {}}"#, "s").unwrap();
    let explicit = r#"{
        "pt": 1,
        "camera": {"type": "perspective", "fov": 40, "lens_radius": 0, "focus_distance": 1},
        "film": {"width": 512, "height": 512, "filter": {"type": "box", "radius": 0.5}},
        "sampler": {"type": "sobol", "spp": 64, "seed": 0},
        "materials": {}, "textures": {}, "shapes": [], "lights": []
    }"#;
    assert_eq!(scene, describe::parse(explicit.as_bytes(), "s").unwrap());
}

#[test]
fn srgb_is_decoded() {
    let albedo = |text: &str| {
        let scene = format!(r#"{{"pt": 1, "camera": {{}}, "textures": {{"t": {{"type": "constant", "color": {text}}}}}}}"#);
        let Scene { textures, .. } = describe::parse(scene.as_bytes(), "s").unwrap();
        match &textures["t"] {
            describe::Texture::Constant(constant) => constant.color.linear(),
            other => panic!("{other:?}"),
        }
    };
    // IEC 61966-2-1 at 0, 1 and at its breakpoint, from both of its branches.
    assert_eq!(albedo(r##"{"srgb": "#0000ff"}"##), [0.0, 0.0, 1.0]);
    let [low, high, _] = albedo(r#"{"srgb": [0.04045, 0.0404500001, 0]}"#);
    assert!((low - 0.04045 / 12.92).abs() < 1e-15);
    assert!((high - low).abs() < 1e-7, "continuous to the standard's rounding: {low} {high}");
    assert_eq!(albedo("0.25"), [0.25; 3]);
    assert_eq!(albedo("[0.1, 0.2, 0.3]"), [0.1, 0.2, 0.3]);
}

#[test]
fn scenes_load_only_from_regular_files() {
    let folder = tempfile::tempdir().unwrap();
    let exit_code = |path: &Path| describe::load(path).map(drop).map_err(|e| e.exit_code());
    let scene = folder.path().join("a scène \u{1f431}.json");
    std::fs::write(&scene, EVERYTHING).unwrap();
    assert_eq!(exit_code(&scene), Ok(()));
    assert_eq!(exit_code(folder.path()), Err(3));
    assert_eq!(exit_code(Path::new("/dev/zero")), Err(3));
    assert_eq!(exit_code(&folder.path().join("missing.json")), Err(3));
}
