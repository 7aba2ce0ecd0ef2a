//! Overrides from the command line: `-D /camera/fov=60`, `--spp 16`.

use std::sync::Arc;

use super::node::{Location, Member, Node, Value, index, segments};
use super::parse::parse;
use super::suggest::closest;
use crate::{Error, Result};

impl Node {
    /// Sets the value that the JSON pointer `pointer` names to `text`: JSON, or a string without its quotes.
    ///
    /// The last key is created if its object lacks it, and so is a section of the scene (the pointer's first key). A fault of the
    /// value is later reported as `-D pointer=text`.
    ///
    /// # Errors
    /// `Usage`: a pointer that leads nowhere, with a list of what there is instead; broken JSON.
    pub fn set(&mut self, pointer: &str, text: &str) -> Result<()> {
        self.set_by(&format!("-D {pointer}={text}"), pointer, text)
    }

    /// Sets a value for a flag of its own; `words` are the words of the command line, such as `--spp 16`.
    ///
    /// # Errors
    /// The errors of [`Node::set`].
    pub fn set_by(&mut self, words: &str, pointer: &str, text: &str) -> Result<()> {
        let words: Arc<str> = words.into();
        let usage = |message: String| Error::Usage(format!("{words}: {message}"));
        let value = parse_value(text).map_err(usage)?;
        let path = segments(pointer).filter(|path| !path.is_empty());
        let path = path.ok_or_else(|| usage("expected a JSON pointer such as /camera/fov".into()))?;
        let location = Location::Override(words.clone());
        let slot = self.slot(&path, &location).map_err(usage)?;
        *slot = moved_to(value, &location);
        Ok(())
    }

    /// Node at `path`, created as [`Node::set`] says. An error says what is wrong with the path.
    fn slot(&mut self, path: &[String], location: &Location) -> Result<&mut Node, String> {
        let mut node = self;
        for (depth, segment) in path.iter().enumerate() {
            let parent = match depth {
                0 => "the scene".to_owned(),
                _ => format!("/{}", path[..depth].join("/")),
            };
            let may_create = depth == 0 || depth + 1 == path.len();
            let found = node.found();
            node = match &mut node.value {
                Value::Object(members) => member(members, segment, may_create, location).map_err(|has| format!("{parent} has {has}"))?,
                Value::Array(items) => {
                    let len = items.len();
                    let item = index(segment).and_then(|i| items.get_mut(i));
                    item.ok_or_else(|| format!("{parent} is a list of {len}: expected a number below {len}, found {segment:?}"))?
                }
                _ => return Err(format!("{parent} is {found}: it has no {segment:?}")),
            };
        }
        Ok(node)
    }
}

/// Member `key`. If it is missing and may not be created, the error lists the existing keys.
fn member<'m>(members: &'m mut Vec<Member>, key: &str, may_create: bool, location: &Location) -> Result<&'m mut Node, String> {
    let at = match members.iter().position(|m| m.key == key) {
        Some(at) => at,
        None if may_create => {
            let node = Node { value: Value::Object(vec![]), location: location.clone() };
            members.push(Member { key: key.into(), key_location: location.clone(), node });
            members.len() - 1
        }
        None => return Err(missing(members, key)),
    };
    Ok(&mut members[at].node)
}

fn missing(members: &[Member], key: &str) -> String {
    let keys: Vec<&str> = members.iter().map(|m| m.key.as_str()).collect();
    match closest(key, keys.iter().copied()) {
        Some(near) => format!("no {key:?}, did you mean {near:?}?"),
        None if keys.is_empty() => format!("no {key:?}, it has no keys"),
        None => format!("no {key:?}, only {}", keys.join(", ")),
    }
}

/// Parses JSON; a text that cannot be meant as JSON becomes a string.
fn parse_value(text: &str) -> Result<Node, String> {
    match parse(text.as_bytes()) {
        Ok(node) => Ok(node),
        Err(fault) if text.trim_start().starts_with(['{', '[', '"']) => Err(fault.message),
        Err(_) => Ok(Node { value: Value::String(text.into()), location: Location::Text { line: 1, column: 1 } }),
    }
}

/// Copies a value and gives all its parts the location `location`.
fn moved_to(node: Node, location: &Location) -> Node {
    let value = match node.value {
        Value::Array(items) => Value::Array(items.into_iter().map(|item| moved_to(item, location)).collect()),
        Value::Object(members) => {
            let moved = |m: Member| Member { key_location: location.clone(), node: moved_to(m.node, location), ..m };
            Value::Object(members.into_iter().map(moved).collect())
        }
        scalar => scalar,
    };
    Node { value, location: location.clone() }
}
