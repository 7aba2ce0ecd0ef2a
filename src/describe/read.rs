//! Reads the text of a scene file and checks the scene.

use std::io::Read;
use std::path::Path;

use super::check::check;
use super::file::open;
use super::files::Files;
use super::scene::{Integrator, Scene};
use crate::reader::{self, Faults, Node, UnknownKeys};
use crate::{Error, Result};

/// Reads a scene from the bytes of a file, which messages call `file`.
///
/// # Errors
/// `Invalid` with all faults of the scene, at most [`MAX_FAULTS`](crate::MAX_FAULTS).
pub fn parse(bytes: &[u8], file: &str) -> Result<Scene> {
    read(&root(bytes, file)?, file)
}

/// Reads the JSON tree of the scene file at `path`; [`Node::set`] can change it before [`read`].
///
/// # Errors
/// Those of [`bytes`] and [`root`].
pub fn load(path: &Path) -> Result<Node> {
    root(&bytes(path)?, &name(path))
}

/// Reads all bytes of the file at `path`, or of standard input if the path is `-`.
///
/// # Errors
/// `Io` where reading fails; `Invalid` for a file that is missing or not regular: a pipe could block for ever, a device never end.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    if path == Path::new("-") {
        std::io::stdin().read_to_end(&mut bytes).map_err(|e| Error::io(name(path), e))?;
    } else {
        let mut file = open(path, &name(path))?;
        file.read_to_end(&mut bytes).map_err(|e| Error::io(path, e))?;
    }
    Ok(bytes)
}

/// The name of the scene file at `path` in messages.
pub fn name(path: &Path) -> String {
    if path == Path::new("-") { "stdin".into() } else { path.display().to_string() }
}

/// Parses the JSON tree of a scene file; [`Node::set`] can change it before [`read`].
///
/// # Errors
/// `Invalid` for text that is not JSON.
pub fn root(bytes: &[u8], file: &str) -> Result<Node> {
    reader::parse(bytes).map_err(|fault| Error::invalid(fault.in_file(file)))
}

/// Reads a scene from its JSON tree, without looking for the files that it names.
///
/// # Errors
/// Those of [`parse`]; `Usage` where all faults lie in values given with `-D`.
pub fn read(root: &Node, file: &str) -> Result<Scene> {
    checked(root, file, None)
}

/// Reads a scene from its JSON tree and checks that the files that it names can be used.
///
/// # Errors
/// Those of [`read`]; a file that cannot be used is a fault of the scene.
pub fn read_with(root: &Node, file: &str, files: &Files) -> Result<Scene> {
    checked(root, file, Some(files))
}

fn checked(root: &Node, file: &str, files: Option<&Files>) -> Result<Scene> {
    let faults = Faults::default();
    let mut scene: Option<Scene> = reader::read(root, "", UnknownKeys::Refuse, &faults);
    if let Some(scene) = &mut scene {
        scene.integrator = Integrator(root.child("integrator").cloned());
        scene.camera.fill_defaults();
        check(scene, root, &faults);
        let unusable = files.map_or_else(Vec::new, |files| files.all_unusable(scene));
        unusable.into_iter().for_each(|(pointer, message)| faults.add_at(root, &pointer, message));
    }
    faults.into_result(file)?;
    let scene = scene.ok_or_else(|| Error::Internal(format!("{file}: no scene and no fault")))?;
    Ok(scene)
}
