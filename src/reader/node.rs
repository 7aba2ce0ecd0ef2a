//! The tree: what a file says, and where it says so.

use std::sync::Arc;

use serde::ser::{Error as _, Serialize, SerializeMap, Serializer};

use super::number;

/// A JSON value and where it stands.
///
/// Two nodes are equal when they say the same, wherever they stand.
#[derive(Debug, Clone)]
pub struct Node {
    pub value: Value,
    pub place: Place,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Null,
    Bool(bool),
    /// As written: each reader parses it at its own precision, so it is rounded once.
    Number(Box<str>),
    String(String),
    Array(Vec<Node>),
    /// In file order, with repetitions if the file has them.
    Object(Vec<Member>),
}

/// `"key": node`.
#[derive(Debug, Clone)]
pub struct Member {
    pub key: String,
    pub key_place: Place,
    pub node: Node,
}

/// Where a value was given. Ordered as faults are listed: the file first, then the command line.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// From 1; columns in characters.
    Text { line: u32, column: u32 },
    /// What was read from a file of another format, and what it is called there: a JSON pointer.
    Foreign { line: u32, column: u32, pointer: Arc<str> },
    /// What was read from a file without lines, or stands for all of a file: a JSON pointer, or nothing.
    Whole(Arc<str>),
    /// On the command line, as the user typed it: `-D /camera/fov=60`.
    Override(Arc<str>),
}

impl Node {
    /// An object without keys, given on the command line by `words`.
    pub fn empty(words: &str) -> Node {
        Node { value: Value::Object(vec![]), place: Place::Override(words.into()) }
    }

    /// The node that a JSON pointer (RFC 6901) names; the first of repeated keys.
    pub fn get(&self, pointer: &str) -> Option<&Node> {
        segments(pointer)?.iter().try_fold(self, |node, segment| node.child(segment))
    }

    /// The member of an object, or the element of an array, with this name.
    pub fn child(&self, segment: &str) -> Option<&Node> {
        match &self.value {
            Value::Object(members) => members.iter().find(|m| m.key == segment).map(|m| &m.node),
            Value::Array(items) => index(segment).and_then(|i| items.get(i)),
            _ => None,
        }
    }

    pub fn as_str(&self) -> Option<&str> {
        match &self.value {
            Value::String(text) => Some(text),
            _ => None,
        }
    }

    /// The JSON kind, as a variant of [`by_kind!`](macro@super::by_kind) is called.
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

    /// The value in the words of a fault: `expected …, found ⟨this⟩`.
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

/// The unescaped segments of a JSON pointer; `None` if it is not one.
pub(super) fn segments(pointer: &str) -> Option<Vec<String>> {
    if pointer.is_empty() {
        return Some(vec![]);
    }
    Some(pointer.strip_prefix('/')?.split('/').map(|s| s.replace("~1", "/").replace("~0", "~")).collect())
}

/// `segment` as it stands in a JSON pointer, with its slash.
pub(crate) fn escaped(segment: &str) -> String {
    format!("/{}", segment.replace('~', "~0").replace('/', "~1"))
}

/// An array index as RFC 6901 writes it: no sign, no leading zero.
pub(super) fn index(segment: &str) -> Option<usize> {
    let canonical = segment == "0" || !segment.starts_with(['0', '+']);
    canonical.then(|| segment.parse().ok()).flatten()
}

/// A fault shows what it found, not a megabyte of it.
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
