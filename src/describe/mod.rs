//! pt's scene format as types: what a scene file says, before anything is built from it.
//!
//! Each type is read ([`read()`]), written (`Serialize`) and documented ([`schema()`]) from one
//! definition; its doc comments are the reference in `docs/scene-format.md`. Values keep the
//! numbers of the file; nothing here knows how they are rendered.
//!
//! Materials describe themselves where their formulas are, in [`bsdf`](crate::bsdf). To add a shape (a light, a texture): a struct in
//! its family's file, a variant in the family's enum and in its `by_type!`, then
//! `PT_BLESS=1 cargo test --test it scene_format` for the page, and an example in `tests/it/everything.json`.

mod build;
mod camera;
mod check;
mod cycles;
mod field;
mod field_check;
mod file;
mod files;
mod film;
mod identity;
mod light;
pub mod mesh;
mod names;
pub mod picture;
mod read;
mod reference;
mod sampler;
mod scene;
mod schema;
mod shape;

pub use crate::bsdf::description::*;
pub use crate::format::*;
pub use build::{Built, Source, build};
pub use camera::*;
pub use field::*;
pub use files::{Files, files_of};
pub use film::*;
pub use identity::{Contents, Identity};
pub use light::*;
pub use names::Names;
pub use read::*;
pub use reference::reference;
pub use sampler::*;
pub use scene::*;
pub use schema::{members, schema};
pub use shape::*;
