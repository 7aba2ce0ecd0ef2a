//! glTF 2.0: a description in JSON, and numbers and pictures in buffers (`.gltf` with files beside it, or all in one `.glb`).
//!
//! ```text
//! file ─ container ─▶ JSON and its places, checked by the crate `gltf` ─ buffers ─▶ Document ─ scene ─▶ pt's tree, meshes, pictures
//! ```
//!
//! The conventions are pt's own but for two: matrices stand column by column, and v runs down a picture. Meshes become files that
//! come with the scene (binary PLY, v upwards), and so do pictures that lie within buffers; pictures that are files stay where they are.
//!
//! Source: Khronos, *glTF 2.0 Specification* (2.0.1) and the extensions by their names. What becomes of each: docs/import.md.

mod accessor;
mod buffer;
mod camera;
mod container;
mod document;
mod glossiness;
mod instances;
mod light;
mod material;
mod mesh;
mod pose;
mod scene;
mod texture;

use super::{Content, Dialect, Foreign};
use crate::error::Result;
use crate::reader::Node;

pub const DIALECT: Dialect = Dialect { name: "gltf", about: "glTF 2.0, .gltf and .glb", is: container::is, read };

fn read(content: &Content, foreign: &Foreign) -> Result<Option<Node>> {
    let opened = container::open(content, foreign)?;
    let Some(tree) = document::checked(opened, foreign) else { return Ok(None) };
    let Some(document) = document::Document::new(&tree, foreign)? else { return Ok(None) };
    let root = scene::scene(&document);
    document.tell();
    Ok(root)
}
