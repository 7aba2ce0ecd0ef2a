//! Scenes of other programs, as scenes of pt.
//!
//! ```text
//! file ─ recognised by its content ─▶ Dialect ─▶ a tree of pt's own format, with the places of the foreign file ─▶ describe
//! ```
//!
//! Everything after is the same for all. What is wrong with a foreign scene is told by its own lines and names; what is left out
//! or done in another way is noted, one sentence each.
//!
//! To add a dialect: a file beside these and a row in [`ALL`].

mod aalto;
pub mod darts;
mod foreign;
mod framing;
mod gltf;
mod model;
mod native;
mod obj;
mod unknown;
mod view;

use std::path::Path;

use crate::describe::{self, Files};
use crate::error::{Error, Fault, Result};
use crate::reader::Node;

pub use foreign::Assets;
use foreign::{Content, Foreign};
pub use framing::{Framing, Up, Viewpoint};

/// A kind of scene file that pt reads.
pub struct Dialect {
    pub name: &'static str,
    /// One line.
    pub about: &'static str,
    /// Whether it is this one. The first that says so reads it.
    is: fn(&Content) -> bool,
    /// The scene as pt describes it; `None` where that fails, with the reasons noted in the [`Foreign`].
    read: fn(&Content, &Foreign) -> Result<Option<Node>>,
}

/// In the order in which they are asked; pt's own format is whatever no other claims.
pub const ALL: &[Dialect] =
    &[gltf::DIALECT, obj::DIALECT, model::PLY, model::STL, aalto::DIALECT, darts::DIRT, darts::DARTS_2021, darts::DARTS, native::DIALECT];

/// A scene file of any dialect, read.
pub struct Imported {
    /// The scene in pt's own format, for [`Node::set`] before [`describe::read()`].
    pub root: Node,
    /// What messages call the file.
    pub file: String,
    pub files: Files,
    pub dialect: &'static Dialect,
    /// What was left out or done in another way.
    pub notes: Vec<Fault>,
}

/// Reads the scene file at `path`, or standard input if that is `-`.
///
/// - `allow_outside`: whether the scene may name files that lie outside of its own folder
///
/// # Errors
/// `Invalid`: all that is wrong with it, at most [`MAX_FAULTS`](crate::MAX_FAULTS), as far as the dialect tells; `Io`.
pub fn import(path: &Path, allow_outside: bool) -> Result<Imported> {
    import_with(path, allow_outside, Framing::default(), |_, _| Ok(()))
}

/// As [`import`], with `change` acting on the tree of the file of that name before it gets the light that it lacks.
///
/// # Errors
/// As [`import`]; those of `change`.
pub fn import_with(
    path: &Path,
    allow_outside: bool,
    framing: Framing,
    change: impl FnOnce(&mut Node, &str) -> Result<()>,
) -> Result<Imported> {
    let file = describe::name(path);
    let content = Content::new(path, describe::bytes(path)?);
    let dialect = ALL.iter().find(|dialect| (dialect.is)(&content)).unwrap_or(&native::DIALECT);
    let files = Files { allow_outside, ..Files::within(path.parent().unwrap_or(Path::new(""))) };
    let foreign = Foreign::new(&file, files, framing);
    let mut root = (dialect.read)(&content, &foreign)?;
    if let Some(root) = root.as_mut().filter(|_| foreign.faults.is_empty()) {
        change(root, &file)?;
        foreign.complete(root);
    }
    let (files, notes) = foreign.finish()?;
    let root = root.ok_or_else(|| Error::Internal(format!("{file}: no scene and no fault")))?;
    Ok(Imported { root, file, files, dialect, notes })
}
