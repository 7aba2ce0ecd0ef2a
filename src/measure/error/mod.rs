//! The relative error of a picture, estimated from its own samples.

mod contribution;
mod correlation;
pub(in crate::measure) mod epsilon;
mod local_reference;
mod most_pixels;
mod relative;
mod scope;
mod tiles;

pub use epsilon::{EPSILON, floor};
pub use most_pixels::MostPixels;
pub use relative::{ErrorInterval, Refusal, RelativeError, errors};
pub use scope::{FEWEST_PIXELS, Scope};
pub use tiles::{Tile, tile_errors, tiles, worst_tile};
