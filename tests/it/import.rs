//! Scenes of other programs: each becomes a scene of pt, and says what became of it.

mod aalto;
mod at_hand;
mod auto_camera;
mod convert;
mod darts;
mod dialect;
mod gltf;
mod models;
mod obj;
mod read;
mod table;

pub use read::{met, reflected};
