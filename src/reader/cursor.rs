//! Reading of a node into a type. Faults are collected, and reading goes on.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use serde::de::{Deserialize, DeserializeOwned, DeserializeSeed};

use super::faults::Faults;
use super::node::{Member, Node, Value, escaped};
use super::number;
use super::parse::parse;
use super::read_error::ReadError;
use super::suggest::unknown;

/// Treatment of keys that a type does not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnknownKeys {
    /// Report them as faults.
    Refuse,
    /// Ignore them. Options written for another integrator are read like this: keys that both know are used.
    Ignore,
}

/// Reads `node`, which stands at `pointer` in its file, as a `T`, and adds its faults to `faults`.
///
/// After a fault the value holds a placeholder in that place. Such a value serves to find more faults, not to render.
pub fn read<T: DeserializeOwned>(node: &Node, pointer: &str, keys: UnknownKeys, faults: &Faults) -> Option<T> {
    read_from(node, pointer, keys, faults, false)
}

/// Reads the keys of an object other than `type`, which has been read already. Faults are treated as by [`read`].
pub fn read_options<T: DeserializeOwned>(node: &Node, pointer: &str, keys: UnknownKeys, faults: &Faults) -> Option<T> {
    read_from(node, pointer, keys, faults, true)
}

/// Reads a JSON value, such as one that a description was written to, as a `T`; `None` if it is none.
///
/// (serde_json's own `from_value` does not read types that are told apart by the kind of their value.)
pub fn from_json<T: DeserializeOwned>(value: &serde_json::Value) -> Option<T> {
    let node = parse(value.to_string().as_bytes()).ok()?;
    let faults = Faults::default();
    read(&node, "", UnknownKeys::Refuse, &faults).filter(|_| faults.is_empty())
}

fn read_from<T: DeserializeOwned>(node: &Node, pointer: &str, keys: UnknownKeys, faults: &Faults, tagged: bool) -> Option<T> {
    let context = Context { faults, keys, base: pointer, path: RefCell::default(), placeholder_keys: RefCell::default() };
    Cursor { node, context: &context, tagged, placeholder: None }.read().ok()
}

pub(super) struct Context<'n> {
    faults: &'n Faults,
    keys: UnknownKeys,
    base: &'n str,
    path: RefCell<Vec<Segment<'n>>>,
    /// Missing keys, by node, that placeholders replace from now on.
    placeholder_keys: RefCell<BTreeMap<*const Node, Vec<&'static str>>>,
}

pub(super) enum Segment<'n> {
    /// Key of an object.
    Key(&'n str),
    /// Index of an array.
    Index(usize),
}

impl<'n> Context<'n> {
    fn pointer(&self) -> String {
        let mut pointer = self.base.to_owned();
        for segment in self.path.borrow().iter() {
            match segment {
                Segment::Key(key) => pointer += &escaped(key),
                Segment::Index(i) => pointer += &format!("/{i}"),
            }
        }
        pointer
    }

    /// Runs `inner` one level down, at `segment`.
    pub(super) fn within<T>(&self, segment: Segment<'n>, inner: impl FnOnce() -> T) -> T {
        self.path.borrow_mut().push(segment);
        let result = inner();
        self.path.borrow_mut().pop();
        result
    }
}

/// A node that is being read, or a placeholder in its place.
///
/// A placeholder can be read as any type: it gives ½, 1, "", empty lists, the first variant. ½ lies within the range of every number in the
/// scene format. If no value can be made (for a type that refuses "" or contains itself), the fault also ends the enclosing value. Nodes and
/// placeholders are one type, so that the code of each description is compiled once.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'n> {
    pub(super) node: &'n Node,
    pub(super) context: &'n Context<'n>,
    /// Whether the key `type` has been read, so that the object's other keys are the content.
    pub(super) tagged: bool,
    /// For a placeholder, the number of placeholders that contain it.
    pub(super) placeholder: Option<u32>,
}

/// Largest depth of nested placeholders. Types of the scene format are less deep unless they contain themselves.
const DEEPEST: u32 = 16;

impl<'n> Cursor<'n> {
    /// Reads a value; its faults are reported, and a placeholder is returned in its place. Where this is a placeholder itself, the error is
    /// passed on.
    pub(super) fn read<T: Deserialize<'n>>(self) -> Result<T, ReadError> {
        loop {
            match T::deserialize(self) {
                Ok(value) => return Ok(value),
                Err(stop) if self.is_placeholder() => return Err(stop),
                // The value is read again with a placeholder for the key, since other keys may be missing too.
                Err(ReadError::Missing(key)) if self.add_placeholder_key(key) => {
                    self.context.faults.add_missing(&self.node.location, self.context.pointer(), key)
                }
                Err(ReadError::Because(message)) => {
                    // A value that contains placeholders is not judged as a whole.
                    if !self.context.faults.any_within(&self.context.pointer()) {
                        self.report(message);
                    }
                    break;
                }
                Err(ReadError::Missing(_) | ReadError::Reported) => break,
            }
        }
        T::deserialize(self.placeholder()).map_err(|_| ReadError::Reported)
    }

    /// A placeholder in the place of this value.
    pub(super) fn placeholder(self) -> Cursor<'n> {
        Cursor { placeholder: Some(0), ..self }
    }

    pub(super) fn is_placeholder(self) -> bool {
        self.placeholder.is_some()
    }

    /// What the members of this value are read from: itself, or a placeholder one level down.
    pub(super) fn content(self) -> Result<Cursor<'n>, ReadError> {
        match self.placeholder {
            Some(DEEPEST..) => Err(ReadError::Reported),
            depth => Ok(Cursor { placeholder: depth.map(|depth| depth + 1), ..self }),
        }
    }

    /// The value that the file has, unless this is a placeholder.
    pub(super) fn value(self) -> Option<&'n Value> {
        (!self.is_placeholder()).then_some(&self.node.value)
    }

    fn report(self, message: String) {
        self.context.faults.add(&self.node.location, self.context.pointer(), message);
    }

    /// Marks `key` as replaced by a placeholder from now on; false if it was marked already.
    fn add_placeholder_key(self, key: &'static str) -> bool {
        let mut placeholder_keys = self.context.placeholder_keys.borrow_mut();
        let keys = placeholder_keys.entry(self.node).or_default();
        let new = !keys.contains(&key);
        if new {
            keys.push(key);
        }
        new
    }

    /// Missing keys that have been reported and are replaced by placeholders.
    pub(super) fn placeholder_keys(self) -> Vec<&'static str> {
        self.context.placeholder_keys.borrow().get(&(self.node as *const Node)).cloned().unwrap_or_default()
    }

    /// The value one level down, at `node`.
    pub(super) fn child(self, node: &'n Node) -> Cursor<'n> {
        Cursor { node, tagged: false, ..self }
    }

    /// Reads this value, which is at `segment` of the one that is being read, as `read` does.
    pub(super) fn read_at<T: Deserialize<'n>>(self, segment: Segment<'n>) -> Result<T, ReadError> {
        self.context.within(segment, || self.read())
    }

    /// Reads this value, which is at `segment` of the one that is being read, with a serde seed. A fault ends the enclosing value too,
    /// but is reported where it is.
    pub(super) fn seed_at<S: DeserializeSeed<'n>>(self, segment: Segment<'n>, seed: S) -> Result<S::Value, ReadError> {
        self.context.within(segment, || seed.deserialize(self).map_err(|stop| self.reported(stop)))
    }

    /// Faults of placeholders are not the user's and are not reported.
    pub(super) fn reported(self, stop: ReadError) -> ReadError {
        if self.is_placeholder() {
            return stop;
        }
        if !matches!(stop, ReadError::Reported) {
            self.report(stop.to_string());
        }
        ReadError::Reported
    }

    pub(super) fn expected(self, what: impl Display) -> ReadError {
        ReadError::Because(format!("expected {what}, found {}", self.node.found()))
    }

    pub(super) fn boolean(self) -> Result<bool, ReadError> {
        match self.value() {
            None => Ok(false),
            Some(Value::Bool(b)) => Ok(*b),
            Some(_) => Err(self.expected("true or false")),
        }
    }

    pub(super) fn text(self) -> Result<&'n str, ReadError> {
        match self.value() {
            None => Ok(""),
            Some(Value::String(text)) => Ok(text),
            Some(_) => Err(self.expected("a string")),
        }
    }

    pub(super) fn real(self) -> Result<f64, ReadError> {
        match self.value() {
            None => Ok(0.5),
            Some(Value::Number(text)) => number::real(text).map_err(ReadError::Because),
            Some(Value::String(text)) if text.parse::<f64>().is_ok() => {
                Err(ReadError::Because(format!("expected a number, found the string {text:?}: remove the quotes")))
            }
            Some(_) => Err(self.expected("a number")),
        }
    }

    pub(super) fn whole<T: TryFrom<i128> + Display>(self, min: T, max: T) -> Result<T, ReadError> {
        let value = match self.value() {
            None => Some(1),
            Some(Value::Number(text)) => number::whole(text),
            Some(_) => None,
        };
        let value = value.ok_or_else(|| self.expected("a whole number"))?;
        T::try_from(value).map_err(|_| self.expected(format!("a whole number from {min} to {max}")))
    }

    /// Members that are content, each once. Repeated keys, and keys not among `known`, are reported.
    pub(super) fn members(self, known: Option<&[&str]>) -> Result<Vec<&'n Member>, ReadError> {
        let Value::Object(members) = &self.node.value else { return Err(self.expected("an object")) };
        let mut seen = BTreeSet::new();
        let mut content = vec![];
        for member in members {
            let key = member.key.as_str();
            match known {
                _ if !seen.insert(key) => self.report_key(member, format!("duplicate key {key:?}")),
                _ if self.tagged && key == "type" => {}
                Some(known) if !known.contains(&key) => {
                    if self.context.keys == UnknownKeys::Refuse {
                        self.report_key(member, unknown("key", key, known));
                    }
                }
                _ => content.push(member),
            }
        }
        Ok(content)
    }

    fn report_key(self, member: &'n Member, message: String) {
        let pointer = self.context.within(Segment::Key(&member.key), || self.context.pointer());
        self.context.faults.add(&member.key_location, pointer, message);
    }
}
