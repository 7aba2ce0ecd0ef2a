//! Context in which a scene of another program is read: the content of its file, and notes about it.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::path::Path;

use super::view::{AutoCamera, MissingParts};
use crate::describe::Files;
use crate::error::{Error, Fault, Result};
use crate::reader::{self, Faults, Node};

/// Content of a scene file.
pub struct Content<'a> {
    /// Path of the file.
    pub path: &'a Path,
    /// Bytes of the file.
    pub bytes: Vec<u8>,
    json: OnceCell<Result<Node, Fault>>,
}

impl<'a> Content<'a> {
    /// Content that has been read already.
    pub fn new(path: &'a Path, bytes: Vec<u8>) -> Content<'a> {
        Content { path, bytes, json: OnceCell::new() }
    }

    /// JSON tree; `None` if the content is not JSON.
    pub fn tree(&self) -> Option<&Node> {
        self.parsed().as_ref().ok()
    }

    /// JSON tree.
    ///
    /// # Errors
    /// `Invalid`: text that is not JSON.
    pub fn json(&self, context: &ImportContext) -> Result<&Node> {
        self.parsed().as_ref().map_err(|fault| Error::invalid(fault.clone().in_file(context.file)))
    }

    fn parsed(&self) -> &Result<Node, Fault> {
        self.json.get_or_init(|| reader::parse(&self.bytes))
    }
}

/// Files that come with a scene, by name, and that are not on disk: see [`Files::made`].
pub type Assets = BTreeMap<String, Vec<u8>>;

/// Collects notes and faults while a scene is read.
pub struct ImportContext<'a> {
    /// Name of the scene file in messages.
    pub file: &'a str,
    /// Files of the scene's folder.
    pub files: Files,
    /// Options for the camera, if the file has none.
    pub auto_camera: AutoCamera,
    /// When the shutter opens and closes (s), for files with animations; without it they are left out.
    pub exposure: Option<[f64; 2]>,
    /// Faults of the scene.
    pub faults: Faults,
    notes: RefCell<Vec<Fault>>,
    made: RefCell<Assets>,
    missing: RefCell<Option<MissingParts>>,
}

impl<'a> ImportContext<'a> {
    /// Context without notes and faults.
    pub fn new(file: &'a str, files: Files, auto_camera: AutoCamera) -> ImportContext<'a> {
        let (notes, made, missing) = (RefCell::default(), RefCell::default(), RefCell::default());
        ImportContext { file, files, auto_camera, exposure: None, faults: Faults::default(), notes, made, missing }
    }

    /// Sets the parts that the scene lacks for a first picture.
    pub fn set_missing(&self, missing: MissingParts) {
        self.missing.replace(Some(missing));
    }

    /// Returns the parts that the scene lacks for a first picture, and forgets them.
    pub fn take_missing(&self) -> Option<MissingParts> {
        self.missing.take()
    }

    /// Notes something that is left out or done in another way, once.
    pub fn note(&self, note: Fault) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    /// Adds a file that comes with the scene.
    pub fn make(&self, name: impl Into<String>, bytes: Vec<u8>) {
        self.made.borrow_mut().insert(name.into(), bytes);
    }

    /// Bytes of a file that came with the scene or lies beside it.
    ///
    /// # Errors
    /// The errors of [`Files::bytes`].
    pub fn bytes(&self, name: &str) -> Result<Vec<u8>> {
        self.made.borrow().get(name).cloned().map_or_else(|| self.files.bytes(name), Ok)
    }

    /// Returns the files, with those that came with the scene, and the notes.
    ///
    /// # Errors
    /// `Invalid`: the faults of the scene.
    pub fn finish(self) -> Result<(Files, Vec<Fault>)> {
        self.faults.into_result(self.file)?;
        Ok((Files { made: self.made.into_inner(), ..self.files }, self.notes.into_inner()))
    }
}
