//! Files of glTF: JSON (.gltf), or a container of JSON and a binary buffer (.glb).

use std::borrow::Cow;

use gltf::binary::Glb;

use crate::error::{Error, Fault, Result};
use crate::import::{Content, ImportContext};
use crate::reader::{self, Location, Member, Node, Value, escaped};

/// First bytes of a `.glb`.
const MAGIC: &[u8] = b"glTF";

/// Length of a container's header: magic, version and length (bytes).
const HEADER: usize = 12;

/// Start of messages with a line and a column of a container: they are those of its JSON.
pub const IN_CONTAINER: &str = "in the JSON of the .glb";

/// Returns whether the content is a container, or an object whose `asset` has a version and which is not a scene of pt.
pub fn is(content: &Content) -> bool {
    let says_so = |tree: &Node| tree.get("/asset/version").is_some() && tree.child("pt").is_none();
    content.bytes.starts_with(MAGIC) || content.tree().is_some_and(says_so)
}

/// Content of a file.
pub struct Opened<'c> {
    /// JSON tree with locations.
    pub tree: Cow<'c, Node>,
    /// Binary buffer of a container.
    pub binary: Option<Vec<u8>>,
}

/// Opens a file.
///
/// # Errors
/// `Invalid`: not a container of version 2, or no JSON in it.
pub fn open<'c>(content: &'c Content, context: &ImportContext) -> Result<Opened<'c>> {
    if !content.bytes.starts_with(MAGIC) {
        return Ok(Opened { tree: Cow::Borrowed(content.json(context)?), binary: None });
    }
    let invalid = |message: String| Error::invalid(Fault::new(message).in_file(context.file));
    let length = content.bytes.get(8..HEADER).and_then(|bytes| bytes.try_into().ok()).map_or(0, u32::from_le_bytes);
    if (length as usize) < HEADER {
        return Err(invalid("the .glb ends within its header".to_owned()));
    }
    let Glb { json, bin, .. } = Glb::from_slice(&content.bytes).map_err(|error| invalid(explained(&error)))?;
    let tree = reader::parse(&json).map_err(|fault| {
        let message = format!("{IN_CONTAINER}: {}", fault.message);
        Error::invalid(Fault { message, ..fault }.in_file(context.file))
    })?;
    Ok(Opened { tree: Cow::Owned(without_lines(tree, "")), binary: bin.map(Cow::into_owned) })
}

fn explained(error: &gltf::Error) -> String {
    use gltf::binary::Error as Binary;
    match error {
        gltf::Error::Binary(Binary::Version(version)) => format!("a .glb of version {version}, expected version 2"),
        gltf::Error::Binary(Binary::Length { length, length_read }) => {
            format!("the .glb promises {length} bytes after its header, found {length_read}")
        }
        gltf::Error::Binary(Binary::ChunkLength { length, length_read, .. }) => {
            format!("a chunk of the .glb promises {length} bytes, found {length_read}")
        }
        gltf::Error::Binary(Binary::Io(_)) => "the .glb ends within the header of a chunk".to_owned(),
        gltf::Error::Binary(_) => "the chunks of the .glb are not JSON and, after it, BIN".to_owned(),
        _ => "not a .glb".to_owned(),
    }
}

/// Replaces locations by pointers: lines within a chunk of a binary file help nobody.
fn without_lines(node: Node, pointer: &str) -> Node {
    let below = |key: &str| format!("{pointer}{}", escaped(key));
    let value = match node.value {
        Value::Array(items) => {
            Value::Array(items.into_iter().enumerate().map(|(i, item)| without_lines(item, &below(&i.to_string()))).collect())
        }
        Value::Object(members) => Value::Object(members.into_iter().map(|member| without_line(member, below)).collect()),
        plain => plain,
    };
    Node { value, location: Location::Whole(pointer.into()) }
}

fn without_line(member: Member, below: impl Fn(&str) -> String) -> Member {
    let pointer = below(&member.key);
    Member { key_location: Location::Whole((&*pointer).into()), node: without_lines(member.node, &pointer), key: member.key }
}
