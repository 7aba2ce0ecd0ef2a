//! The faults of one file, collected while reading goes on.

use std::cell::RefCell;
use std::collections::BTreeSet;

use super::node::{Node, Place, escaped};
use crate::{Error, Fault, MAX_FAULTS, Result};

/// What is wrong with a file so far, each fault once, in file order.
#[derive(Debug, Default)]
pub struct Faults(RefCell<BTreeSet<Entry>>);

/// Far more than are listed, since they are not always found in file order.
const FULL: usize = 50 * MAX_FAULTS;

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    place: Place,
    pointer: String,
    message: String,
    /// The value that cannot be used; where a key is missing, that key's.
    unusable: String,
}

impl Faults {
    pub fn is_empty(&self) -> bool {
        self.0.borrow().is_empty()
    }

    /// Whether there are so many that more would only cost time.
    pub fn is_full(&self) -> bool {
        self.0.borrow().len() >= FULL
    }

    pub fn add(&self, place: &Place, pointer: impl Into<String>, message: impl Into<String>) {
        let pointer = pointer.into();
        self.insert(Entry { place: place.clone(), pointer: pointer.clone(), message: message.into(), unusable: pointer });
    }

    /// The object at `pointer` lacks `key`; its other keys are as good as they are.
    pub(super) fn add_missing(&self, place: &Place, pointer: String, key: &str) {
        let unusable = format!("{pointer}{}", escaped(key));
        self.insert(Entry { place: place.clone(), pointer, message: format!("missing key {key:?}"), unusable });
    }

    fn insert(&self, entry: Entry) {
        if !self.is_full() {
            self.0.borrow_mut().insert(entry);
        }
    }

    /// A fault found after reading: at the node that `pointer` names in `root`, or at its nearest parent that exists.
    ///
    /// Not added if a fault is already known at, above or below it: what was read there is a
    /// placeholder, and judging that would blame the user for our invention.
    pub fn add_at(&self, root: &Node, pointer: &str, message: impl Into<String>) {
        if !self.0.borrow().iter().any(|e| inside(pointer, &e.unusable) || inside(&e.unusable, pointer)) {
            self.add(nearest_place(root, pointer), pointer, message);
        }
    }

    /// Whether a fault is known at or below `pointer`.
    pub(super) fn any_within(&self, pointer: &str) -> bool {
        self.0.borrow().iter().any(|e| inside(&e.pointer, pointer))
    }

    /// `Ok` if there are none; else the first [`MAX_FAULTS`] of them.
    ///
    /// # Errors
    /// `Invalid`, or `Usage` where all of them came from the command line's `-D`.
    pub fn into_result(self, file: &str) -> Result<()> {
        let entries = self.0.into_inner();
        if entries.is_empty() {
            return Ok(());
        }
        let from_command_line = entries.iter().all(|e| matches!(e.place, Place::Override(_)));
        let faults: Vec<Fault> = entries.into_iter().take(MAX_FAULTS).map(|e| e.into_fault(file)).collect();
        Err(match from_command_line {
            true => Error::Usage(faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n")),
            false => Error::Invalid(faults),
        })
    }
}

/// Whether the JSON pointer `inner` names what `outer` names, or a part of it.
fn inside(inner: &str, outer: &str) -> bool {
    inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

impl Entry {
    fn into_fault(self, file: &str) -> Fault {
        let fault = Fault::new(self.message).pointing(self.pointer);
        placed(fault, &self.place, file)
    }
}

/// A fault at the node that `pointer` names in `root`, or at its nearest parent that exists.
pub fn locate(root: &Node, file: &str, pointer: &str, message: impl Into<String>) -> Fault {
    placed(Fault::new(message).pointing(pointer), nearest_place(root, pointer), file)
}

/// The fault with its place filled in: file, line and column, or the command line's words.
fn placed(fault: Fault, place: &Place, file: &str) -> Fault {
    match place {
        Place::Text { line, column } => fault.in_file(file).at(*line as usize, *column as usize),
        Place::Foreign { line, column, pointer } => fault.pointing(&**pointer).in_file(file).at(*line as usize, *column as usize),
        Place::Whole(pointer) => fault.pointing(&**pointer).in_file(file),
        Place::Override(words) => fault.in_file(&**words),
    }
}

/// The place of the node, or of its nearest parent that exists.
fn nearest_place<'n>(root: &'n Node, pointer: &str) -> &'n Place {
    let mut known = pointer;
    loop {
        match (root.get(known), known.rfind('/')) {
            (Some(node), _) => return &node.place,
            (None, Some(end)) => known = &known[..end],
            (None, None) => return &root.place,
        }
    }
}
