//! The relative error of a picture, estimated from its own samples.

mod contribution;
mod correlation;
pub(in crate::measure) mod epsilon;
mod local_reference;
mod relative;

pub use epsilon::{EPSILON, floor};
pub use relative::{RelativeError, errors};
