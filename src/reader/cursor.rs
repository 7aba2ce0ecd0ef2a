//! A node being read: what is wrong is noted, and reading goes on.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display};

use serde::de::{self, Deserialize, DeserializeOwned, DeserializeSeed, Expected, Unexpected};

use super::faults::Faults;
use super::node::{Member, Node, Value, escaped};
use super::number;
use super::placeholder::Placeholder;
use super::suggest::unknown;

/// What to do about keys that a type does not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnknownKeys {
    Refuse,
    /// For options written for another integrator: those that both know are kept.
    Ignore,
}

/// Reads `node`, which stands at `pointer` in its file, as a `T`; what is wrong is added to `faults`.
///
/// With faults, the value holds placeholders where they are: it serves to look for more faults, not to render.
pub fn read<T: DeserializeOwned>(node: &Node, pointer: &str, keys: UnknownKeys, faults: &Faults) -> Option<T> {
    read_from(node, pointer, keys, faults, false)
}

/// Reads the keys of an object other than `type`, which has been read already, as [`read`] does.
pub fn read_options<T: DeserializeOwned>(node: &Node, pointer: &str, keys: UnknownKeys, faults: &Faults) -> Option<T> {
    read_from(node, pointer, keys, faults, true)
}

fn read_from<T: DeserializeOwned>(node: &Node, pointer: &str, keys: UnknownKeys, faults: &Faults, tagged: bool) -> Option<T> {
    let context = Context { faults, keys, base: pointer, path: RefCell::default(), supplied: RefCell::default() };
    Cursor { node, context: &context, tagged }.read().ok()
}

/// Why reading a value ended. The place is known one level up, so that is where it is reported.
#[derive(Debug)]
pub(super) enum Stop {
    Reported,
    Because(String),
    Missing(&'static str),
}

impl std::error::Error for Stop {}

impl Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Stop::Reported => f.write_str("already reported"),
            Stop::Because(message) => f.write_str(message),
            Stop::Missing(key) => write!(f, "missing key {key:?}"),
        }
    }
}

impl de::Error for Stop {
    fn custom<T: Display>(message: T) -> Stop {
        Stop::Because(message.to_string())
    }

    fn missing_field(key: &'static str) -> Stop {
        Stop::Missing(key)
    }

    fn invalid_type(found: Unexpected, expected: &dyn Expected) -> Stop {
        Stop::Because(format!("expected {expected}, found {found}"))
    }
}

pub(super) struct Context<'n> {
    faults: &'n Faults,
    keys: UnknownKeys,
    base: &'n str,
    path: RefCell<Vec<Segment<'n>>>,
    /// Missing keys, by node, for which a placeholder stands in from now on.
    supplied: RefCell<BTreeMap<*const Node, Vec<&'static str>>>,
}

pub(super) enum Segment<'n> {
    Key(&'n str),
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

    /// What `inner` does happens one level down, at `segment`.
    pub(super) fn within<T>(&self, segment: Segment<'n>, inner: impl FnOnce() -> T) -> T {
        self.path.borrow_mut().push(segment);
        let result = inner();
        self.path.borrow_mut().pop();
        result
    }
}

/// A node being read.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'n> {
    pub(super) node: &'n Node,
    pub(super) context: &'n Context<'n>,
    /// The key `type` has been read: the object's other keys are the content.
    pub(super) tagged: bool,
}

impl<'n> Cursor<'n> {
    /// Reads a value; whatever is wrong with it is reported, and a placeholder returned.
    pub(super) fn read<T: Deserialize<'n>>(self) -> Result<T, Stop> {
        loop {
            match T::deserialize(self) {
                Ok(value) => return Ok(value),
                // Again with a placeholder for the key, since others may be missing too.
                Err(Stop::Missing(key)) if self.supply(key) => {
                    self.context.faults.add_missing(&self.node.place, self.context.pointer(), key)
                }
                Err(Stop::Because(message)) => {
                    // A whole is not judged by parts that are placeholders.
                    if !self.context.faults.any_within(&self.context.pointer()) {
                        self.report(message);
                    }
                    break;
                }
                Err(Stop::Missing(_) | Stop::Reported) => break,
            }
        }
        T::deserialize(Placeholder::NEW).map_err(|_| Stop::Reported)
    }

    fn report(self, message: String) {
        self.context.faults.add(&self.node.place, self.context.pointer(), message);
    }

    /// Notes that `key` is to be made up from now on; false if it was already.
    fn supply(self, key: &'static str) -> bool {
        let mut supplied = self.context.supplied.borrow_mut();
        let keys = supplied.entry(self.node).or_default();
        let new = !keys.contains(&key);
        if new {
            keys.push(key);
        }
        new
    }

    /// The keys to be made up: missing, and reported.
    pub(super) fn supplied(self) -> Vec<&'static str> {
        self.context.supplied.borrow().get(&(self.node as *const Node)).cloned().unwrap_or_default()
    }

    /// What `read` returns for a value one level down.
    pub(super) fn read_child<T: Deserialize<'n>>(self, segment: Segment<'n>, node: &'n Node) -> Result<T, Stop> {
        let child = Cursor { node, tagged: false, ..self };
        self.context.within(segment, || child.read())
    }

    /// The same for a reader of which no more is known: its fault ends this value too, but is reported where it stands.
    pub(super) fn seed_child<S: DeserializeSeed<'n>>(self, segment: Segment<'n>, node: &'n Node, seed: S) -> Result<S::Value, Stop> {
        let child = Cursor { node, tagged: false, ..self };
        self.context.within(segment, || seed.deserialize(child).map_err(|stop| child.reported(stop)))
    }

    pub(super) fn reported(self, stop: Stop) -> Stop {
        if !matches!(stop, Stop::Reported) {
            self.report(stop.to_string());
        }
        Stop::Reported
    }

    pub(super) fn expected(self, what: impl Display) -> Stop {
        Stop::Because(format!("expected {what}, found {}", self.node.found()))
    }

    pub(super) fn real(self) -> Result<f64, Stop> {
        match &self.node.value {
            Value::Number(text) => number::real(text).map_err(Stop::Because),
            Value::String(text) if text.parse::<f64>().is_ok() => {
                Err(Stop::Because(format!("expected a number, found the string {text:?}: remove the quotes")))
            }
            _ => Err(self.expected("a number")),
        }
    }

    pub(super) fn whole<T: TryFrom<i128> + Display>(self, min: T, max: T) -> Result<T, Stop> {
        let text = match &self.node.value {
            Value::Number(text) => text,
            _ => return Err(self.expected("a whole number")),
        };
        let value = number::whole(text).ok_or_else(|| self.expected("a whole number"))?;
        T::try_from(value).map_err(|_| self.expected(format!("a whole number from {min} to {max}")))
    }

    /// The members that are content, once each; repeated keys, and keys not among `known`, are reported.
    pub(super) fn members(self, known: Option<&[&str]>) -> Result<Vec<&'n Member>, Stop> {
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
        self.context.faults.add(&member.key_place, pointer, message);
    }
}
