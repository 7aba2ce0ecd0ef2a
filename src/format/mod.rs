//! The values that scene files are made of: numbers with a range, colours, transforms and descriptions of textures.
//!
//! They are plain data with serde and schema derives. The parameters of the materials in [`bsdf`](crate::bsdf) and the scene format
//! in [`describe`](crate::describe) are built from them.

mod color;
mod moment;
mod size;
mod texture;
mod transform;
mod value;
mod varying;

pub use color::*;
pub use moment::*;
pub use size::*;
pub use texture::*;
pub use transform::*;
pub use value::*;
pub use varying::*;
