//! Tree of JSON values with their locations.

use std::sync::Arc;

use serde::ser::{Error as _, Serialize, SerializeMap, Serializer};

use super::number;

/// A JSON value with its location.
///
/// Two nodes are equal if their values are, whatever their locations.
#[derive(Debug, Clone)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// The location.
    pub location: Location,
}

/// A JSON value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// Number as written: each reader parses it at its own precision, so it is rounded once.
    Number(Box<str>),
    /// String, unescaped.
    String(String),
    /// Array.
    Array(Vec<Node>),
    /// Members in file order, with repetitions if the file has them.
    Object(Vec<Member>),
}

/// Member of an object: `"key": node`.
#[derive(Debug, Clone)]
pub struct Member {
    /// Key, unescaped.
    pub key: String,
    /// Location of the key.
    pub key_location: Location,
    /// Value.
    pub node: Node,
}

/// Location of a value. The order is that of the list of faults: the file first, then the command line.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Location {
    /// Line and column in the scene file.
    Text {
        /// Line, from 1.
        line: u32,
        /// Column in characters, from 1.
        column: u32,
    },
    /// Line and column in a file of another format, with the JSON pointer of the value there.
    Imported {
        /// Line, from 1.
        line: u32,
        /// Column in characters, from 1.
        column: u32,
        /// JSON pointer in the file of the other format.
        pointer: Arc<str>,
    },
    /// JSON pointer in a file without lines, or nothing for the file as a whole.
    Whole(Arc<str>),
    /// Words of the command line, as the user typed them: `-D /camera/fov=60`.
    Override(Arc<str>),
}

impl Node {
    /// Object without keys, given on the command line by `words`.
    pub fn empty(words: &str) -> Node {
        Node { value: Value::Object(vec![]), location: Location::Override(words.into()) }
    }

    /// Returns the node that a JSON pointer (RFC 6901) names; the first one for a repeated key.
    pub fn get(&self, pointer: &str) -> Option<&Node> {
        segments(pointer)?.iter().try_fold(self, |node, segment| node.child(segment))
    }

    /// Returns the member of an object, or the element of an array, with this name.
    pub fn child(&self, segment: &str) -> Option<&Node> {
        match &self.value {
            Value::Object(members) => members.iter().find(|m| m.key == segment).map(|m| &m.node),
            Value::Array(items) => index(segment).and_then(|i| items.get(i)),
            _ => None,
        }
    }

    /// Returns the text of a string.
    pub fn as_str(&self) -> Option<&str> {
        match &self.value {
            Value::String(text) => Some(text),
            _ => None,
        }
    }

    /// Kind of the value, as the variants of [`by_kind!`](macro@super::by_kind) name it.
    pub(super) fn kind(&self) -> &'static str {
        match self.value {
            Value::Null => "null",
            Value::Bool(_) => "boolean",
            Value::Number(_) => "number",
            Value::String(_) => "string",
            Value::Array(_) => "array",
            Value::Object(_) => "object",
        }
    }

    /// Text of the value for a message: `expected …, found ⟨this⟩`.
    pub(crate) fn found(&self) -> String {
        match &self.value {
            Value::Null => "null".into(),
            Value::Bool(b) => b.to_string(),
            Value::Number(text) => abbreviated(text),
            Value::String(text) => format!("the string {:?}", abbreviated(text)),
            Value::Array(items) => format!("an array of {}", items.len()),
            Value::Object(_) => "an object".into(),
        }
    }
}

/// Unescaped segments of a JSON pointer; `None` if the text is not one.
pub(super) fn segments(pointer: &str) -> Option<Vec<String>> {
    if pointer.is_empty() {
        return Some(vec![]);
    }
    Some(pointer.strip_prefix('/')?.split('/').map(|s| s.replace("~1", "/").replace("~0", "~")).collect())
}

/// Escapes `segment` for a JSON pointer, with its slash.
pub(crate) fn escaped(segment: &str) -> String {
    format!("/{}", segment.replace('~', "~0").replace('/', "~1"))
}

/// Array index as RFC 6901 writes it: no sign, no leading zero.
pub(super) fn index(segment: &str) -> Option<usize> {
    let canonical = segment == "0" || !segment.starts_with(['0', '+']);
    canonical.then(|| segment.parse().ok()).flatten()
}

/// Shortens a value for a message.
fn abbreviated(text: &str) -> String {
    const SHOWN: usize = 40;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Node) -> bool {
        match (&self.value, &other.value) {
            (Value::Number(a), Value::Number(b)) => a == b || a.parse::<f64>() == b.parse::<f64>(),
            (a, b) => a == b,
        }
    }
}

impl PartialEq for Member {
    fn eq(&self, other: &Member) -> bool {
        self.key == other.key && self.node == other.node
    }
}

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match &self.value {
            Value::Null => s.serialize_unit(),
            Value::Bool(b) => s.serialize_bool(*b),
            Value::Number(text) => match number::whole(text).map(i64::try_from) {
                Some(Ok(whole)) => s.serialize_i64(whole),
                _ => s.serialize_f64(text.parse().map_err(S::Error::custom)?),
            },
            Value::String(text) => s.serialize_str(text),
            Value::Array(items) => s.collect_seq(items),
            Value::Object(members) => {
                let mut map = s.serialize_map(Some(members.len()))?;
                for member in members {
                    map.serialize_entry(&member.key, &member.node)?;
                }
                map.end()
            }
        }
    }
}
