//! Squared differences: the sum of variance and bias². One firefly can outweigh a picture.

use super::ImagePair;

/// Squared difference (a − r)² of each value a from its reference r.
///
/// Tests: by hand, symmetric, ·s² when both are scaled by s.
pub fn square(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    pair.map(|a, r| (a - r) * (a - r))
}
