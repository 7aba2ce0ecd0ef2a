//! A file of which every index leads somewhere, with its buffers, and what is noted about it.

use std::cell::RefCell;
use std::collections::BTreeMap;

use gltf::json;
use gltf::json::validation::{Error as Wrong, Validate};

use super::buffer::{Buffers, UNPACK};
use super::container::Opened;
use super::texture::Picture;
use crate::error::Result;
use crate::import::Foreign;
use crate::import::view::View;
use crate::reader::{self, Member, Node, Place, UnknownKeys, Value};

/// Extensions that are read, wholly or so that each thing left out is noted where it stands.
const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// The attributes of vertices that glTF names; others belong to an application, or to an extension that is left out.
const ATTRIBUTES: &[&str] = &["POSITION", "NORMAL", "TANGENT", "TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"];

/// What a file holds, checked.
pub struct Tree<'c> {
    places: std::borrow::Cow<'c, Node>,
    gltf: gltf::Document,
    binary: Option<Vec<u8>>,
}

/// Returns the file, checked; `None` where something is wrong with it, which is noted.
pub fn checked<'c>(opened: Opened<'c>, foreign: &Foreign) -> Option<Tree<'c>> {
    let Opened { tree, binary } = opened;
    let refuse = |pointer: &str, message: String| match &tree.place {
        // Without lines, the pointer is the place, even of what is missing.
        Place::Whole(_) => foreign.faults.add(&Place::Whole(pointer.into()), pointer, message),
        _ => foreign.faults.add_at(&tree, pointer, message),
    };
    let version = tree.get("/asset/version").and_then(Node::as_str).unwrap_or("2.");
    if !version.starts_with("2.") {
        refuse("/asset/version", format!("expected glTF of version 2, found {:?}", version.chars().take(40).collect::<String>()));
        return None;
    }
    let root: json::Root = reader::read(&readable(&tree, ""), "", UnknownKeys::Ignore, &foreign.faults)?;
    for (i, name) in root.extensions_required.iter().enumerate().filter(|(_, name)| !READ.contains(&name.as_str())) {
        refuse(&format!("/extensionsRequired/{i}"), needed(&shown(name)));
    }
    // The validation itself looks up the positions, and would panic.
    for (pointer, _) in attributes(&root).filter(|(_, accessor)| *accessor >= root.accessors.len()) {
        refuse(&pointer, explained(Wrong::IndexOutOfBounds).to_owned());
    }
    if foreign.faults.is_empty() {
        root.validate(&root, json::Path::new, &mut |path, wrong| {
            let pointer = pointer(path().as_str());
            if !is_forgiven(&pointer, wrong) {
                refuse(&pointer, explained(wrong).to_owned());
            }
        });
    }
    if !foreign.faults.is_empty() {
        return None;
    }
    let gltf = gltf::Document::from_json_without_validation(root);
    Some(Tree { places: tree, gltf, binary })
}

/// A copy of the part of a file that the crate is to check: what is left out anyway is no reason to refuse the file.
///
/// - `key`: of the object that the node is or belongs to; "" for the file as a whole
fn readable(node: &Node, key: &str) -> Node {
    let is_read = |member: &&Member| match member.key.as_str() {
        // Extensions are read by their own readers.
        "extras" | "extensions" => false,
        "animations" => !key.is_empty(),
        name if key == "attributes" => ATTRIBUTES.iter().any(|known| name.starts_with(known)),
        _ => member.node.value != Value::Null,
    };
    let copy = |member: &Member| {
        let Member { key, key_place, node } = member;
        Member { key: key.clone(), key_place: key_place.clone(), node: readable(node, key) }
    };
    let value = match &node.value {
        Value::Array(items) => Value::Array(items.iter().map(|item| readable(item, key)).collect()),
        Value::Object(members) => Value::Object(members.iter().filter(is_read).map(copy).collect()),
        plain => plain.clone(),
    };
    Node { value, place: node.place.clone() }
}

/// Why an extension that a file needs cannot be done without; Draco and meshopt hold triangles that stand nowhere else.
fn needed(name: &str) -> String {
    let advice = if name.ends_with("_compression") { UNPACK } else { "" };
    format!("the file needs the extension {name}, which pt does not read{advice}")
}

/// A name of the file as a message shows it.
pub fn shown(name: &str) -> String {
    name.chars().filter(|c| !c.is_control()).take(60).collect()
}

/// Of all primitives: where each attribute stands, and its accessor.
fn attributes(root: &json::Root) -> impl Iterator<Item = (String, usize)> {
    let of_mesh = |(m, mesh): (usize, &json::Mesh)| {
        let of_primitive = |(p, primitive): (usize, &json::mesh::Primitive)| {
            let at = |(semantic, accessor): (&json::validation::Checked<json::mesh::Semantic>, &json::Index<_>)| {
                (format!("/meshes/{m}/primitives/{p}/attributes/{}", semantic.to_string()), accessor.value())
            };
            primitive.attributes.iter().map(at).collect::<Vec<_>>()
        };
        mesh.primitives.iter().enumerate().flat_map(of_primitive).collect::<Vec<_>>()
    };
    root.meshes.iter().enumerate().flat_map(of_mesh)
}

/// `meshes[0].primitives[1].attributes["POSITION"] = "…"` is /meshes/0/primitives/1/attributes/POSITION.
fn pointer(path: &str) -> String {
    let path = path.split(" = ").next().unwrap_or_default();
    let steps = path.split(['.', '[']).map(|step| step.trim_end_matches(']').trim_matches('"'));
    steps.filter(|step| !step.is_empty()).map(crate::reader::escaped).collect()
}

/// What no reading depends on: bounds of accessors, extensions (ours is the list above), positions of what is then left out,
/// pictures of textures, which extensions may give, and the bytes of accessors, which are zeros where there are none.
fn is_forgiven(pointer: &str, wrong: Wrong) -> bool {
    let may_lack = ["/min", "/max", "/source", "/attributes/POSITION", "/bufferView"].iter().any(|key| pointer.ends_with(key));
    wrong == Wrong::Unsupported || (wrong == Wrong::Missing && may_lack)
}

fn explained(wrong: Wrong) -> &'static str {
    match wrong {
        Wrong::IndexOutOfBounds => "an index beyond the end of its list",
        Wrong::Invalid => "a value that glTF does not allow",
        Wrong::Missing => "missing data",
        Wrong::Oversize => "more than this machine can address",
        Wrong::Unsupported => "an extension that pt does not read",
    }
}

/// A checked file, and the bytes that belong to it.
pub struct Document<'a> {
    pub gltf: &'a gltf::Document,
    pub root: View<'a>,
    pub buffers: Buffers,
    /// Sentences, with where each holds first and how often.
    notes: RefCell<BTreeMap<String, (View<'a>, usize)>>,
    /// By index: the pictures, `None` where there is a fault.
    pub pictures: RefCell<BTreeMap<usize, Option<Picture>>>,
}

impl<'a> Document<'a> {
    /// `None` where a buffer is missing, which is noted.
    ///
    /// # Errors
    /// `Io`: a buffer that cannot be read.
    pub fn new(tree: &'a Tree, foreign: &'a Foreign) -> Result<Option<Document<'a>>> {
        let root = View::root(&tree.places, foreign);
        let Some(buffers) = Buffers::read(&tree.gltf, tree.binary.as_deref(), &root)? else { return Ok(None) };
        let document = Document { gltf: &tree.gltf, root, buffers, notes: RefCell::default(), pictures: RefCell::default() };
        document.note_extensions();
        Ok(Some(document))
    }

    /// A value of the file; the file as a whole where there is none.
    pub fn at(&self, path: &[&str]) -> View<'a> {
        path.iter().try_fold(self.root.clone(), |view, key| view.get(&[key])).unwrap_or_else(|| self.root.clone())
    }

    /// A member of one of the file's lists.
    pub fn item(&self, list: &str, i: usize) -> View<'a> {
        self.at(&[list, &i.to_string()])
    }

    /// What is left out or done in another way; things that are alike are told once.
    pub fn note(&self, at: &View<'a>, message: impl Into<String>) {
        self.notes.borrow_mut().entry(message.into()).or_insert_with(|| (at.clone(), 0)).1 += 1;
    }

    /// Tells the notes.
    pub fn tell(self) {
        for (message, (at, count)) in self.notes.into_inner() {
            let more = if count > 1 { format!(" (here and {} more)", count - 1) } else { String::new() };
            at.note(message + &more);
        }
    }

    fn note_extensions(&self) {
        let used = self.gltf.as_json().extensions_used.iter().enumerate();
        for (i, name) in used.filter(|(_, name)| !READ.contains(&name.as_str())) {
            let message = format!("the extension {} is left out: what it adds does not show", shown(name));
            self.note(&self.at(&["extensionsUsed", &i.to_string()]), message);
        }
        if let Some(animations) = self.root.get(&["animations"]) {
            self.note(&animations, "animations are left out: everything stands as its nodes say");
        }
    }
}
