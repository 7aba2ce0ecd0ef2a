//! ε of the relative error, which limits how much a dark pixel counts.

use crate::film::Image;

/// ε divided by the square of the picture's mean.
pub const EPSILON: f64 = 0.01;

/// ε = 0.01 · mean(r)² of a reference r; `None` if it is not above 0.
pub fn floor(image: &Image) -> Option<f64> {
    let mean = image.pixels().flatten().map(f64::from).sum::<f64>() / (3.0 * image.pixels().count() as f64);
    floor_at(mean)
}

/// ε = 0.01 · `mean`² of a picture with this mean; `None` if it is not above 0.
pub(in crate::measure) fn floor_at(mean: f64) -> Option<f64> {
    Some(EPSILON * mean * mean).filter(|floor| floor.is_normal())
}
