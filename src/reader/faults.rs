//! Faults of one file, collected while it is read.

use std::cell::RefCell;
use std::collections::BTreeSet;

use super::node::{Location, Node, escaped};
use crate::{Error, Fault, MAX_FAULTS, Result};

/// Faults of a file, each once, in file order.
#[derive(Debug, Default)]
pub struct Faults(RefCell<BTreeSet<Entry>>);

/// Number of faults at which collecting ends. It is far more than are listed, since faults are not always found in file order.
const FULL: usize = 50 * MAX_FAULTS;

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    location: Location,
    pointer: String,
    message: String,
    /// Pointer to the value that cannot be used; for a missing key that is the key's pointer.
    unusable: String,
}

impl Faults {
    /// Returns whether there is no fault.
    pub fn is_empty(&self) -> bool {
        self.0.borrow().is_empty()
    }

    /// Returns whether there are so many faults that more would only cost time.
    pub fn is_full(&self) -> bool {
        self.0.borrow().len() >= FULL
    }

    /// Adds a fault at a location.
    pub fn add(&self, location: &Location, pointer: impl Into<String>, message: impl Into<String>) {
        let pointer = pointer.into();
        self.insert(Entry { location: location.clone(), pointer: pointer.clone(), message: message.into(), unusable: pointer });
    }

    /// Adds a fault for an object at `pointer` that lacks `key`; the object's other keys stay usable.
    pub(super) fn add_missing(&self, location: &Location, pointer: String, key: &str) {
        let unusable = format!("{pointer}{}", escaped(key));
        self.insert(Entry { location: location.clone(), pointer, message: format!("missing key {key:?}"), unusable });
    }

    fn insert(&self, entry: Entry) {
        if !self.is_full() {
            self.0.borrow_mut().insert(entry);
        }
    }

    /// Adds a fault found after reading: at the node that `pointer` names in `root`, or at its nearest existing parent.
    ///
    /// It is not added if a fault is already known at, above or below it: the value read there is a placeholder, and a fault of a
    /// placeholder is not the user's.
    pub fn add_at(&self, root: &Node, pointer: &str, message: impl Into<String>) {
        if !self.0.borrow().iter().any(|e| inside(pointer, &e.unusable) || inside(&e.unusable, pointer)) {
            self.add(nearest_location(root, pointer), pointer, message);
        }
    }

    /// Returns whether a fault is known at or below `pointer`.
    pub(super) fn any_within(&self, pointer: &str) -> bool {
        self.0.borrow().iter().any(|e| inside(&e.pointer, pointer))
    }

    /// Returns `Ok` if there are no faults, and the first [`MAX_FAULTS`] of them otherwise.
    ///
    /// # Errors
    /// `Invalid`, or `Usage` if all of them came from the command line's `-D`.
    pub fn into_result(self, file: &str) -> Result<()> {
        let entries = self.0.into_inner();
        if entries.is_empty() {
            return Ok(());
        }
        let from_command_line = entries.iter().all(|e| matches!(e.location, Location::Override(_)));
        let faults: Vec<Fault> = entries.into_iter().take(MAX_FAULTS).map(|e| e.into_fault(file)).collect();
        Err(match from_command_line {
            true => Error::Usage(faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n")),
            false => Error::Invalid(faults),
        })
    }
}

/// Returns whether the JSON pointer `inner` names the same value as `outer`, or a part of it.
fn inside(inner: &str, outer: &str) -> bool {
    inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

impl Entry {
    fn into_fault(self, file: &str) -> Fault {
        let fault = Fault::new(self.message).pointing(self.pointer);
        placed(fault, &self.location, file)
    }
}

/// Returns a fault at the node that `pointer` names in `root`, or at its nearest existing parent.
pub fn locate(root: &Node, file: &str, pointer: &str, message: impl Into<String>) -> Fault {
    placed(Fault::new(message).pointing(pointer), nearest_location(root, pointer), file)
}

/// Fills in the location of a fault: file, line and column, or the words of the command line.
fn placed(fault: Fault, location: &Location, file: &str) -> Fault {
    match location {
        Location::Text { line, column } => fault.in_file(file).at(*line as usize, *column as usize),
        Location::Imported { line, column, pointer } => fault.pointing(&**pointer).in_file(file).at(*line as usize, *column as usize),
        Location::Whole(pointer) => fault.pointing(&**pointer).in_file(file),
        Location::Override(words) => fault.in_file(&**words),
    }
}

/// Location of the node, or of its nearest existing parent.
fn nearest_location<'n>(root: &'n Node, pointer: &str) -> &'n Location {
    let mut known = pointer;
    loop {
        match (root.get(known), known.rfind('/')) {
            (Some(node), _) => return &node.location,
            (None, Some(end)) => known = &known[..end],
            (None, None) => return &root.location,
        }
    }
}
