//! The identity of a picture: all facts that decide it, and their hash. Two identities can be compared fact by fact.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::mesh::points::InstancePoint;
use super::{SamplerKind, Scene};
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::math::hash::{Hash, Hasher};
use crate::reader::{Node, escaped};
use crate::shape::MeshData;
use crate::texture::image::Pixels;

/// All facts that decide a picture, except the number of samples: the scene after overrides and with its defaults, the integrator
/// with its given options, the contents of meshes and pictures, and pt's version.
///
/// The scene file's formatting, comments and order of keys do not matter. For the stratified sampler the number of samples is a fact
/// too, because it decides the strata.
///
/// The tests are in `tests/it/parts/identity.rs`.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity {
    facts: Value,
}

/// Hashes of the files that a scene names, by name.
pub type Contents = BTreeMap<String, Hash>;

/// The length, in bytes of JSON, above which a list of numbers is replaced by its hash.
const LONGEST: usize = 512;

impl Identity {
    /// Collects the facts of a scene and an integrator.
    ///
    /// # Errors
    /// `Internal` where the scene cannot be written as JSON, which should never happen.
    pub fn new(scene: &Scene, contents: &Contents, integrator: &Entry) -> Result<Identity> {
        let text = |error: serde_json::Error| Error::Internal(format!("the scene cannot be written: {error}"));
        let mut facts = serde_json::to_value(scene).map_err(text)?;
        facts["film"]["crop"] = json!(scene.film.bounds());
        facts["integrator"] = options(scene.integrator.0.as_ref(), integrator).map_err(text)?;
        if let Value::Object(sampler) = &mut facts["sampler"] {
            match scene.sampler.kind {
                SamplerKind::Stratified => {}
                SamplerKind::Independent => ["spp", "scramblings"].iter().for_each(|key| drop(sampler.remove(*key))),
                SamplerKind::Halton | SamplerKind::Sobol => drop(sampler.remove("spp")),
            }
        }
        facts["files"] = contents.iter().map(|(file, hash)| (file.clone(), json!(hash.to_string()))).collect();
        facts["version"] = json!(env!("CARGO_PKG_VERSION"));
        Ok(Identity { facts: compact(facts) })
    }

    /// Restores an identity from its facts, for example from a file. Facts that are not an object count as none.
    pub fn from_facts(facts: Value) -> Identity {
        Identity { facts: if facts.is_object() { facts } else { json!({}) } }
    }

    /// Replaces the value of one of the scene's keys.
    pub fn with(mut self, key: &str, value: Value) -> Identity {
        self.facts[key] = value;
        self
    }

    /// The facts as a JSON object.
    pub fn facts(&self) -> &Value {
        &self.facts
    }

    /// The fact at a JSON pointer, as text.
    pub fn fact(&self, pointer: &str) -> Option<String> {
        self.facts.pointer(pointer).map(|value| value.as_str().map_or_else(|| value.to_string(), str::to_owned))
    }

    /// The hash of the facts, independent of the order of keys.
    pub fn hash(&self) -> Hash {
        of_text(&canonical(&self.facts))
    }

    /// The first fact that differs from another identity: its JSON pointer, its value here and its value there. A missing value is
    /// `nothing`.
    pub fn difference(&self, other: &Identity) -> Option<[String; 3]> {
        difference(&self.facts, &other.facts, String::new())
    }
}

/// The integrator's name, and those of the scene's options that this integrator has.
fn options(given: Option<&Node>, integrator: &Entry) -> Result<Value, serde_json::Error> {
    let schema = (integrator.schema)();
    let known = |key: &str| schema.get("properties").is_some_and(|properties| properties.get(key).is_some());
    let mut options = serde_json::to_value(given)?;
    match &mut options {
        Value::Object(members) => members.retain(|key, _| known(key)),
        other => *other = json!({}),
    }
    options["type"] = json!(integrator.name);
    Ok(options)
}

/// Replaces long lists of numbers by their hash.
fn compact(value: Value) -> Value {
    match value {
        Value::Object(members) => members.into_iter().map(|(key, value)| (key, compact(value))).collect(),
        Value::Array(items) if items.iter().all(is_numeric) => {
            let text = canonical(&Value::from(items.as_slice()));
            if text.len() > LONGEST { json!(format!("{} of the hash {}", items.len(), of_text(&text))) } else { Value::Array(items) }
        }
        Value::Array(items) => items.into_iter().map(compact).collect(),
        scalar => scalar,
    }
}

fn is_numeric(value: &Value) -> bool {
    match value {
        Value::Number(_) => true,
        Value::Array(items) => items.iter().all(is_numeric),
        _ => false,
    }
}

fn of_text(text: &str) -> Hash {
    of_bytes(text.as_bytes())
}

/// The hash of a file's content.
pub(crate) fn of_bytes(bytes: &[u8]) -> Hash {
    let mut hasher = Hasher::default();
    hasher.bytes(bytes);
    hasher.finish()
}

/// JSON with sorted keys and without spaces.
fn canonical(value: &Value) -> String {
    match value {
        Value::Object(members) => {
            let sorted: BTreeMap<_, _> = members.iter().collect();
            let member = |(key, value): (&String, &Value)| format!("{}:{}", Value::from(key.as_str()), canonical(value));
            format!("{{{}}}", sorted.into_iter().map(member).collect::<Vec<_>>().join(","))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(canonical).collect::<Vec<_>>().join(",")),
        scalar => scalar.to_string(),
    }
}

fn difference(a: &Value, b: &Value, pointer: String) -> Option<[String; 3]> {
    let missing = Value::Null;
    match (a, b) {
        (Value::Object(own), Value::Object(others)) => {
            let keys: std::collections::BTreeSet<&String> = own.keys().chain(others.keys()).collect();
            let of = |members: &serde_json::Map<String, Value>, key: &str| members.get(key).unwrap_or(&missing).clone();
            keys.into_iter().find_map(|key| difference(&of(own, key), &of(others, key), format!("{pointer}{}", escaped(key))))
        }
        (Value::Array(own), Value::Array(others)) if own.len() == others.len() => {
            own.iter().zip(others).enumerate().find_map(|(i, (a, b))| difference(a, b, format!("{pointer}/{i}")))
        }
        (a, b) if a == b => None,
        (a, b) => Some([pointer, shown(a), shown(b)]),
    }
}

/// A value as short text for a message.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => "nothing".into(),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".into(),
        scalar => scalar.to_string(),
    }
}

pub(crate) fn of_mesh(mesh: &MeshData) -> Hash {
    let mut hasher = Hasher::default();
    hasher.whole([mesh.positions.len(), mesh.normals.len(), mesh.uvs.len(), mesh.triangles.len()].map(|n| n as u32));
    hasher.floats(mesh.positions.iter().chain(&mesh.normals).flat_map(|v| v.to_array()));
    hasher.floats(mesh.uvs.iter().flat_map(|v| v.to_array()));
    hasher.whole(mesh.triangles.iter().flatten().copied());
    if !mesh.colors.is_empty() {
        hasher.floats(mesh.colors.iter().flat_map(|v| v.to_array()));
    }
    for part in &mesh.parts {
        hasher.text(part.material.as_deref().unwrap_or_default());
        hasher.whole([part.triangles.start, part.triangles.end]);
    }
    hasher.finish()
}

pub(crate) fn of_points(points: &[InstancePoint]) -> Hash {
    let mut hasher = Hasher::default();
    for InstancePoint { position, rotation, scale, material } in points {
        hasher.floats(position.iter().chain(rotation).chain(scale).copied());
        hasher.whole([*material]);
    }
    hasher.finish()
}

pub(crate) fn of_picture(pixels: &Pixels) -> Hash {
    let mut hasher = Hasher::default();
    hasher.whole(pixels.size().to_array());
    hasher.floats(pixels.values().iter().flatten().copied());
    hasher.finish()
}
