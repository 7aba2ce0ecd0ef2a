//! The relative error of a picture, estimated from its own samples.

mod contribution;
mod correlation;
pub(in crate::measure) mod epsilon;
mod local_reference;
mod most_pixels;
mod relative;

pub use epsilon::{EPSILON, floor};
pub use most_pixels::MostPixels;
pub use relative::{ErrorInterval, Refusal, RelativeError, errors};
