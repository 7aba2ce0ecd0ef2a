//! The words that scene files are made of: numbers with a range, colours, transforms, and textures as they are described.
//!
//! These are plain data with serde and schema derives. A family whose members describe themselves (the materials in
//! [`bsdf`](crate::bsdf)) and the scene format as a whole ([`describe`](crate::describe)) are both built from them.

mod color;
mod size;
mod texture;
mod transform;
mod value;
mod varying;

pub use color::*;
pub use size::*;
pub use texture::*;
pub use transform::*;
pub use value::*;
pub use varying::*;
