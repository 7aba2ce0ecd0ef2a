//! glTF 2.0: a description in JSON, with numbers and pictures in buffers (`.gltf` with files beside it, or all in one `.glb`).
//!
//! ```text
//! file ─ container ─▶ JSON and its locations, checked by the crate `gltf` ─ buffers ─▶ Document ─ scene ─▶ pt's tree, meshes, pictures
//! ```
//!
//! The conventions are pt's own with two exceptions: matrices are stored column by column, and v runs down a picture. Meshes become
//! files that come with the scene (binary PLY, v upwards), and so do pictures within buffers; pictures that are files stay where
//! they are.
//!
//! Source: Khronos, *glTF 2.0 Specification* (2.0.1) and the extensions by their names. The conversion of each part is listed in
//! docs/import.md.

mod accessor;
mod animation;
mod bent;
mod buffer;
mod camera;
mod container;
mod document;
mod extension;
mod glossiness;
mod instances;
mod light;
mod material;
mod mesh;
mod pose;
mod scene;
mod texture;

use super::{Content, Dialect, ImportContext};
use crate::error::Result;
use crate::reader::Node;

/// Dialect `gltf`.
pub const DIALECT: Dialect = Dialect { name: "gltf", about: "glTF 2.0, .gltf and .glb", is: container::is, read };

fn read(content: &Content, context: &ImportContext) -> Result<Option<Node>> {
    let opened = container::open(content, context)?;
    let Some(tree) = document::checked(opened, context) else { return Ok(None) };
    let Some(document) = document::Document::new(&tree, context)? else { return Ok(None) };
    let root = scene::scene(&document);
    document.pass_on_notes();
    Ok(root)
}
