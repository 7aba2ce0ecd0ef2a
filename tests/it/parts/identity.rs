//! The hash of a scene changes exactly when something changes that affects the picture.

use pt::describe::{self, Contents, Identity};
use pt::integrator::Entry;
use pt::integrators::ALL;
use pt::math::hash::Hash;
use pt::reader::Node;
use serde_json::Value;

use crate::scene_format::EVERYTHING;

fn entry(name: &str) -> &'static Entry {
    ALL.iter().find(|entry| entry.name == name).expect("it is in the table")
}

fn root(text: &str) -> Node {
    describe::root(text.as_bytes(), "scene.json").unwrap_or_else(|e| panic!("{e}"))
}

fn identity(root: &Node) -> Option<Identity> {
    let scene = describe::read(root, "scene.json").ok()?;
    Some(Identity::new(&scene, &Contents::new(), entry("path")).expect("an identity"))
}

/// A scene with all constructs, and a seed that is exact in JSON.
fn everything() -> String {
    EVERYTHING.replace("18446744073709551615", "18")
}

fn tree() -> Value {
    serde_json::to_value(root(&everything())).expect("JSON")
}

/// The JSON text with the keys of all objects in reverse order, and comments between them.
fn reversed(value: &Value) -> String {
    match value {
        Value::Object(members) => {
            let members = members.iter().rev().map(|(key, value)| format!("/* , */ {}\n:{}", Value::from(key.as_str()), reversed(value)));
            format!("{{{}}}", members.collect::<Vec<_>>().join(",\n"))
        }
        Value::Array(items) => format!("[ {} ]", items.iter().map(reversed).collect::<Vec<_>>().join(" , ")),
        scalar => scalar.to_string(),
    }
}

#[test]
fn the_hash_ignores_formatting() {
    let own = identity(&root(&everything())).expect("a scene");
    assert_eq!(identity(&root(&reversed(&tree()))).expect("a scene"), own);
    // The scene as pt writes it, with all defaults.
    let scene = describe::read(&root(&everything()), "scene.json").expect("a scene");
    let text = serde_json::to_string_pretty(&scene).expect("JSON");
    assert_eq!(identity(&root(&text)).expect("a scene").hash(), own.hash());
}

/// Numbers, words and truth values, by their JSON pointers.
fn leaves(value: &Value, pointer: String, found: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(k, v)| leaves(v, format!("{pointer}/{}", k.replace('~', "~0").replace('/', "~1")), found));
        }
        Value::Array(items) => items.iter().enumerate().for_each(|(i, v)| leaves(v, format!("{pointer}/{i}"), found)),
        scalar => found.push((pointer, scalar.clone())),
    }
}

/// Other values to replace a value, some of which may be valid.
fn others(value: &Value) -> Vec<String> {
    match value {
        Value::Number(n) => {
            let x = n.as_f64().expect("a number");
            let near = [x + 1.0, x - 1.0, x * 0.5, x * 2.0, 0.75, 3.0];
            near.into_iter().filter(|other| *other != x).map(|other| other.to_string()).collect()
        }
        Value::Bool(b) => vec![(!b).to_string()],
        Value::String(s) => {
            let words = ["white", "stone", "linear", "repeat", "bilinear", "uv", "position", "other.ply", "sobol", "beckmann", "ggx", "Cu"];
            words.iter().filter(|word| *word != s).map(|word| format!("{word:?}")).collect()
        }
        _ => vec![],
    }
}

/// If a value of the scene of all constructs is changed, and the result is a valid scene, it has another hash.
#[test]
fn the_hash_depends_on_every_value() {
    let own = identity(&root(&everything())).expect("a scene");
    let mut all = vec![];
    leaves(&tree(), String::new(), &mut all);
    let (mut changed, mut untold) = (0, vec![]);
    for (pointer, value) in &all {
        // Options that the integrator does not have cannot change its picture, and the number of samples is not part of the scene.
        if pointer.starts_with("/integrator/nested") || pointer == "/integrator/type" || pointer == "/sampler/spp" {
            continue;
        }
        let other = others(value).into_iter().find_map(|text| {
            let mut root = root(&everything());
            root.set(pointer, &text).ok()?;
            identity(&root)
        });
        if let Some(other) = other {
            changed += 1;
            if other.hash() == own.hash() {
                untold.push(pointer);
            }
        }
    }
    assert!(untold.is_empty(), "{untold:?}");
    assert!(changed * 10 > all.len() * 7, "{changed} of {} values could be changed", all.len());
}

#[test]
fn differences_of_scenes_are_reported() {
    let own = identity(&root(&everything())).expect("a scene");
    let mut other = root(&everything());
    other.set("/camera/fov", "40").expect("a key");
    let difference = identity(&other).expect("a scene").difference(&own).expect("another field of view");
    assert_eq!(difference, ["/camera/fov", "40.0", "50.5"]);
    assert_eq!(own.difference(&own), None);
}

#[test]
fn the_hash_depends_on_files_integrator_and_strata() {
    let scene = |text: &str| describe::parse(text.as_bytes(), "scene.json").expect("a scene");
    let hash = |text: &str, contents: &Contents, name: &str| Identity::new(&scene(text), contents, entry(name)).expect("one").hash();
    let plain = r#"{"pt": 1, "camera": {}}"#;
    let none = Contents::new();
    let own = hash(plain, &none, "nee");
    let file = |n: u128| Contents::from([("a.ply".to_owned(), Hash(n))]);
    assert_ne!(hash(plain, &file(1), "nee"), own);
    assert_ne!(hash(plain, &file(1), "nee"), hash(plain, &file(2), "nee"));
    assert_ne!(hash(plain, &none, "path"), own);
    // The default integrator given by name, and options of another integrator, which this one does not have.
    assert_eq!(hash(r#"{"pt": 1, "camera": {}, "integrator": {"type": "nee"}}"#, &none, "nee"), own);
    assert_eq!(hash(r#"{"pt": 1, "camera": {}, "integrator": {"type": "x", "odd": 1}}"#, &none, "nee"), own);
    assert_ne!(hash(r#"{"pt": 1, "camera": {}, "integrator": {"type": "nee", "max_depth": 1}}"#, &none, "nee"), own);
    let of = |sampler: &str, spp: u32| {
        hash(&format!(r#"{{"pt": 1, "camera": {{}}, "sampler": {{"type": "{sampler}", "spp": {spp}}}}}"#), &none, "nee")
    };
    for sampler in ["independent", "halton", "sobol"] {
        assert_eq!(of(sampler, 4), of(sampler, 8), "{sampler}");
    }
    assert_ne!(of("stratified", 4), of("stratified", 8), "its samples depend on how many there are");
}
