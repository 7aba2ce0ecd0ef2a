//! Squared differences: what variance and bias² add up to. One firefly can outweigh a picture.

use super::Pair;

/// (a − r)²
///
/// Tests: by hand, symmetric, ·s² when both are scaled by s.
pub fn square(pair: &Pair, _: Option<f64>) -> Vec<f64> {
    pair.map(|a, r| (a - r) * (a - r))
}
