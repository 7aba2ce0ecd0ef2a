//! A foreign scene while it is read: what it holds, and what is noted about it.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::path::Path;

use super::framing::{Framing, Lacking};
use super::view::View;
use crate::describe::Files;
use crate::error::{Error, Fault, Result};
use crate::reader::{self, Faults, Node, Place, Value};

/// What a scene file holds.
pub struct Content<'a> {
    pub path: &'a Path,
    pub bytes: Vec<u8>,
    json: OnceCell<Result<Node, Fault>>,
}

impl<'a> Content<'a> {
    pub fn new(path: &'a Path, bytes: Vec<u8>) -> Content<'a> {
        Content { path, bytes, json: OnceCell::new() }
    }

    /// As JSON; `None` where it is none.
    pub fn tree(&self) -> Option<&Node> {
        self.parsed().as_ref().ok()
    }

    /// As JSON.
    ///
    /// # Errors
    /// `Invalid`: text that is not JSON.
    pub fn json(&self, foreign: &Foreign) -> Result<&Node> {
        self.parsed().as_ref().map_err(|fault| Error::invalid(fault.clone().in_file(foreign.file)))
    }

    fn parsed(&self) -> &Result<Node, Fault> {
        self.json.get_or_init(|| reader::parse(&self.bytes))
    }
}

/// Files that come with a scene and lie nowhere, by name: see [`Files::made`].
pub type Assets = BTreeMap<String, Vec<u8>>;

/// What is noted while a scene is read.
pub struct Foreign<'a> {
    /// What messages call the scene file.
    pub file: &'a str,
    /// Those of the scene's folder.
    pub files: Files,
    /// How a first picture is framed.
    pub framing: Framing,
    pub faults: Faults,
    notes: RefCell<Vec<Fault>>,
    made: RefCell<Assets>,
    lacking: RefCell<Option<Lacking>>,
}

impl<'a> Foreign<'a> {
    pub fn new(file: &'a str, files: Files, framing: Framing) -> Foreign<'a> {
        let (notes, made, lacking) = (RefCell::default(), RefCell::default(), RefCell::default());
        Foreign { file, files, framing, faults: Faults::default(), notes, made, lacking }
    }

    /// What the scene lacks of a first picture.
    pub fn lacks(&self, lacking: Lacking) {
        self.lacking.replace(Some(lacking));
    }

    /// Adds what the scene lacks of a first picture, now that its camera is known.
    pub fn complete(&self, root: &mut Node) {
        let whole = Node { value: Value::Object(vec![]), place: Place::Whole("".into()) };
        let at = View::root(&whole, self);
        match self.lacking.take() {
            Some(lacking) => lacking.complete(&at, root),
            None if self.framing == Framing::default() => {}
            None => at.note("--view, --up and --ground are for models (glTF, OBJ, PLY, STL): they change nothing here"),
        }
    }

    /// What is left out or done in another way; once.
    pub fn note(&self, note: Fault) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    /// A file that comes with the scene.
    pub fn make(&self, name: impl Into<String>, bytes: Vec<u8>) {
        self.made.borrow_mut().insert(name.into(), bytes);
    }

    /// What a file holds that came with the scene, or lies beside it.
    ///
    /// # Errors
    /// As [`Files::bytes`].
    pub fn bytes(&self, name: &str) -> Result<Vec<u8>> {
        self.made.borrow().get(name).cloned().map_or_else(|| self.files.bytes(name), Ok)
    }

    /// The files, those that came with the scene among them, and the notes.
    ///
    /// # Errors
    /// `Invalid`: what is wrong with the scene.
    pub fn finish(self) -> Result<(Files, Vec<Fault>)> {
        self.faults.into_result(self.file)?;
        Ok((Files { made: self.made.into_inner(), ..self.files }, self.notes.into_inner()))
    }
}
