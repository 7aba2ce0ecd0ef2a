//! pt's scene format as types: the content of a scene file, before anything is built from it.
//!
//! Each type is read ([`read()`]), written (`Serialize`) and documented ([`schema()`]) from one definition. Its doc comments become
//! the reference in `docs/scene-format.md`. Values keep the numbers of the file.
//!
//! The descriptions of materials are beside their formulas, in [`bsdf`](crate::bsdf). To add a shape (a light, a texture), write a
//! struct in the family's file and a variant in the family's enum and in its `by_type!`. Then run
//! `PT_BLESS=1 cargo test --test it scene_format` for the page, and add an example to `tests/it/everything.json`.

mod background;
mod camera;
mod check;
pub mod curves_file;
mod cycles;
mod displacement;
mod emission;
mod field;
mod field_check;
mod file;
mod files;
mod film;
pub(crate) mod identity;
pub mod ies;
pub mod lens_file;
mod light;
mod medium;
pub mod mesh;
mod mesh_keyframe;
mod meter;
mod names;
pub mod picture;
mod read;
mod reference;
mod sampler;
mod scene;
mod schema;
mod shape;
mod shape_check;
pub mod volume;

pub use crate::bsdf::description::*;
pub use crate::format::*;
pub use background::{Background, Mapping, Place, Sky};
pub use camera::*;
pub use displacement::Displacement;
pub use emission::*;
pub use field::*;
pub use files::{Files, files_of};
pub use film::*;
pub use identity::{Contents, Identity};
pub use light::*;
pub use medium::*;
pub use mesh_keyframe::MeshKeyframe;
pub use meter::*;
pub use names::Names;
pub use read::*;
pub use reference::reference;
pub use sampler::*;
pub use scene::*;
pub use schema::{members, schema};
pub use shape::*;
