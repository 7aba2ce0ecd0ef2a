//! The relative error of a picture, estimated from its own samples.

mod contribution;
mod local_reference;
pub(in crate::measure) mod neighborhood;
pub(in crate::measure) mod relative;

pub use relative::{EPSILON, RelativeError, errors, floor};
