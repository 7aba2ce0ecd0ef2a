//! Import of scenes of other programs: the converted scenes, and notes about what was changed.

mod aalto;
mod auto_camera;
mod convert;
mod darts;
mod dialect;
mod gltf;
mod instances;
mod local_scenes;
mod models;
mod obj;
mod read;
mod table;

pub use read::{met, reflected};
