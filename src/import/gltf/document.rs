//! A document whose indices are all valid, with its buffers and the notes about it.

use std::cell::RefCell;
use std::collections::BTreeMap;

use gltf::json;
use gltf::json::validation::{Error as Wrong, Validate};

use super::buffer::Buffers;
use super::container::Opened;
use super::extension::{READ, needed, shown};
use crate::error::Result;
use crate::import::ImportContext;
use crate::import::json_cursor::JsonCursor;
use crate::reader::{self, Location, Member, Node, UnknownKeys, Value};

/// Vertex attributes that glTF defines. Others belong to an application, or to an extension that is left out.
const ATTRIBUTES: &[&str] = &["POSITION", "NORMAL", "TANGENT", "TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"];

/// Checked content of a file.
pub struct Tree<'c> {
    places: std::borrow::Cow<'c, Node>,
    gltf: gltf::Document,
    binary: Option<Vec<u8>>,
}

/// Checks a file; `None` if there are faults, which are noted.
pub fn checked<'c>(opened: Opened<'c>, context: &ImportContext) -> Option<Tree<'c>> {
    let Opened { tree, binary } = opened;
    let refuse = |pointer: &str, message: String| match &tree.location {
        // Without lines, the pointer is the location, also of a missing value.
        Location::Whole(_) => context.faults.add(&Location::Whole(pointer.into()), pointer, message),
        _ => context.faults.add_at(&tree, pointer, message),
    };
    let version = tree.get("/asset/version").and_then(Node::as_str).unwrap_or("2.");
    if !version.starts_with("2.") {
        refuse("/asset/version", format!("expected glTF of version 2, found {:?}", version.chars().take(40).collect::<String>()));
        return None;
    }
    let root: json::Root = reader::read(&readable(&tree, "", context.exposure.is_some()), "", UnknownKeys::Ignore, &context.faults)?;
    for (i, name) in root.extensions_required.iter().enumerate().filter(|(_, name)| !READ.contains(&name.as_str())) {
        refuse(&format!("/extensionsRequired/{i}"), needed(&shown(name)));
    }
    // The crate's validation looks up the positions itself, and would panic.
    for (pointer, _) in attributes(&root).filter(|(_, accessor)| *accessor >= root.accessors.len()) {
        refuse(&pointer, explained(Wrong::IndexOutOfBounds).to_owned());
    }
    if context.faults.is_empty() {
        root.validate(&root, json::Path::new, &mut |path, wrong| {
            let pointer = pointer(path().as_str());
            if !is_forgiven(&pointer, wrong) {
                refuse(&pointer, explained(wrong).to_owned());
            }
        });
    }
    if !context.faults.is_empty() {
        return None;
    }
    let gltf = gltf::Document::from_json_without_validation(root);
    Some(Tree { places: tree, gltf, binary })
}

/// Copy of the part of a file that the crate checks: parts that are left out anyway are no reason to refuse the file.
///
/// - `key`: key of the object that the node is or belongs to; "" for the file as a whole
/// - `animated`: whether animations are read
fn readable(node: &Node, key: &str, animated: bool) -> Node {
    let is_read = |member: &&Member| match member.key.as_str() {
        // Extensions have readers of their own.
        "extras" | "extensions" => false,
        "animations" => animated || !key.is_empty(),
        name if key == "attributes" => ATTRIBUTES.iter().any(|known| name.starts_with(known)),
        _ => member.node.value != Value::Null,
    };
    let copy = |member: &Member| {
        let Member { key, key_location, node } = member;
        Member { key: key.clone(), key_location: key_location.clone(), node: readable(node, key, animated) }
    };
    let value = match &node.value {
        Value::Array(items) => Value::Array(items.iter().map(|item| readable(item, key, animated)).collect()),
        Value::Object(members) => Value::Object(members.iter().filter(is_read).map(copy).collect()),
        plain => plain.clone(),
    };
    Node { value, location: node.location.clone() }
}

/// Pointer and accessor of each attribute, for all primitives.
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

/// Converts `meshes[0].primitives[1].attributes["POSITION"] = "…"` to /meshes/0/primitives/1/attributes/POSITION.
fn pointer(path: &str) -> String {
    let path = path.split(" = ").next().unwrap_or_default();
    let steps = path.split(['.', '[']).map(|step| step.trim_end_matches(']').trim_matches('"'));
    steps.filter(|step| !step.is_empty()).map(crate::reader::escaped).collect()
}

/// Returns whether a fault does not affect the reading: bounds of accessors, extensions (the list above decides), positions of
/// parts that are left out, pictures of textures, which extensions may supply, and missing bytes of accessors, which are zeros.
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

/// State of a picture.
#[derive(Clone)]
pub enum Picture {
    /// A file that pt reads: beside the scene, or made for it.
    File(String),
    /// A picture of this format, which pt does not read.
    Unread(String),
}

/// A checked file with its bytes.
pub struct Document<'a> {
    /// The document as the crate gltf reads it.
    pub gltf: &'a gltf::Document,
    /// Root of the JSON tree.
    pub root: JsonCursor<'a>,
    /// Buffers.
    pub buffers: Buffers,
    /// Notes, with the first place where each holds and the number of places.
    notes: RefCell<BTreeMap<String, (JsonCursor<'a>, usize)>>,
    /// Pictures by index; `None` if a picture has a fault.
    pub pictures: RefCell<BTreeMap<usize, Option<Picture>>>,
}

impl<'a> Document<'a> {
    /// Reads the buffers; `None` if one is missing, which is noted.
    ///
    /// # Errors
    /// `Io`: a buffer that cannot be read.
    pub fn new(tree: &'a Tree, context: &'a ImportContext) -> Result<Option<Document<'a>>> {
        let root = JsonCursor::root(&tree.places, context);
        let Some(buffers) = Buffers::read(&tree.gltf, tree.binary.as_deref(), &root)? else { return Ok(None) };
        let document = Document { gltf: &tree.gltf, root, buffers, notes: RefCell::default(), pictures: RefCell::default() };
        document.note_extensions();
        Ok(Some(document))
    }

    /// Value of the file at a path; the root if there is none.
    pub fn at(&self, path: &[&str]) -> JsonCursor<'a> {
        path.iter().try_fold(self.root.clone(), |view, key| view.get(&[key])).unwrap_or_else(|| self.root.clone())
    }

    /// Element of one of the file's lists.
    pub fn item(&self, list: &str, i: usize) -> JsonCursor<'a> {
        self.at(&[list, &i.to_string()])
    }

    /// Notes something that is left out or done in another way; equal notes are joined.
    pub fn note(&self, at: &JsonCursor<'a>, message: impl Into<String>) {
        self.notes.borrow_mut().entry(message.into()).or_insert_with(|| (at.clone(), 0)).1 += 1;
    }

    /// Passes the notes on to the import context.
    pub fn pass_on_notes(self) {
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
        if let (Some(animations), None) = (self.root.get(&["animations"]), self.root.context().exposure) {
            self.note(&animations, "animations are left out: everything stands as its nodes say; --frames 0..48 shows them");
        }
    }
}
