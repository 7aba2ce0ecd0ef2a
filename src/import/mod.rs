//! Import of scenes of other programs.
//!
//! ```text
//! file ─ recognised by its content ─▶ Dialect ─▶ a tree of pt's own format, with the locations in the foreign file ─▶ describe
//! ```
//!
//! All later steps are the same for every dialect. Faults of a foreign scene are reported with its own lines and names. Whatever is
//! left out or done in another way is noted, one sentence each.
//!
//! To add a dialect: a file beside these and a row in [`ALL`].

mod aalto;
mod auto_camera;
mod context;
pub mod darts;
mod gltf;
mod instances;
mod json_cursor;
mod model;
mod native;
mod obj;
mod unknown;
mod view;

use std::path::Path;

use crate::describe::{self, Files};
use crate::error::{Error, Fault, Result};
use crate::reader::Node;

pub use context::Assets;
use context::{Content, ImportContext};
pub use native::DIALECT as NATIVE;
pub use view::{AutoCamera, Up, Viewpoint};

/// A kind of scene file that pt reads.
pub struct Dialect {
    /// Name of the dialect.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Returns whether a file is of this dialect. The first dialect that matches reads the file.
    is: fn(&Content) -> bool,
    /// Reads the scene as pt describes it; `None` if that fails, with the reasons noted in the [`ImportContext`].
    read: fn(&Content, &ImportContext) -> Result<Option<Node>>,
}

/// All dialects, in the order in which they are tried. A file that no other dialect matches is taken as pt's own format.
pub const ALL: &[Dialect] =
    &[gltf::DIALECT, obj::DIALECT, model::PLY, model::STL, aalto::DIALECT, darts::DIRT, darts::DARTS_2021, darts::DARTS, native::DIALECT];

/// A scene file of any dialect after reading.
pub struct Imported {
    /// Scene in pt's own format, for [`Node::set`] before [`describe::read()`].
    pub root: Node,
    /// Name of the file in messages.
    pub file: String,
    /// Files of the scene.
    pub files: Files,
    /// Dialect of the file.
    pub dialect: &'static Dialect,
    /// Notes about what was left out or done in another way.
    pub notes: Vec<Fault>,
}

/// Options for reading a scene.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Whether the scene may name files that lie outside of its own folder.
    pub allow_outside: bool,
    /// Options for a model without a camera.
    pub auto_camera: AutoCamera,
    /// When the shutter opens and closes (s), for files with animations; without it they are left out.
    pub exposure: Option<[f64; 2]>,
}

/// Reads the scene file at `path`, or standard input if that is `-`.
///
/// - `allow_outside`: whether the scene may name files that lie outside of its own folder
///
/// # Errors
/// `Invalid`: all that is wrong with it, at most [`MAX_FAULTS`](crate::MAX_FAULTS), as far as the dialect tells; `Io`.
pub fn import(path: &Path, allow_outside: bool) -> Result<Imported> {
    import_with(path, &ImportOptions { allow_outside, ..ImportOptions::default() }, |_, _| Ok(()))
}

/// Imports a scene as [`import`] does. `change` acts on the tree, with the name of the file, before missing light is added.
///
/// # Errors
/// The errors of [`import`], and those of `change`.
pub fn import_with(path: &Path, options: &ImportOptions, change: impl FnOnce(&mut Node, &str) -> Result<()>) -> Result<Imported> {
    import_bytes(describe::bytes(path)?, path, options, change)
}

/// Imports a scene as [`import_with`] does, from the bytes of its file.
///
/// - `path`: name of the file in messages; the files that the scene names lie in its folder
///
/// # Errors
/// `Invalid`: all that is wrong with the scene; `Io` for a file that it names; the errors of `change`.
pub fn import_bytes(
    bytes: Vec<u8>,
    path: &Path,
    options: &ImportOptions,
    change: impl FnOnce(&mut Node, &str) -> Result<()>,
) -> Result<Imported> {
    let file = describe::name(path);
    let content = Content::new(path, bytes);
    let dialect = ALL.iter().find(|dialect| (dialect.is)(&content)).unwrap_or(&native::DIALECT);
    let files = Files { allow_outside: options.allow_outside, ..Files::within(path.parent().unwrap_or(Path::new(""))) };
    let mut context = ImportContext::new(&file, files, options.auto_camera);
    context.exposure = options.exposure;
    let mut root = (dialect.read)(&content, &context)?;
    if let Some(root) = root.as_mut().filter(|_| context.faults.is_empty()) {
        if dialect.name != native::DIALECT.name {
            instances::share(root);
        }
        change(root, &file)?;
        auto_camera::complete(&context, root);
    }
    let (files, notes) = context.finish()?;
    let root = root.ok_or_else(|| Error::Internal(format!("{file}: no scene and no fault")))?;
    Ok(Imported { root, file, files, dialect, notes })
}
