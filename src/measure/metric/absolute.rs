//! Absolute differences, plain and relative. One wrong pixel counts once, not squared.

use super::ImagePair;

/// ε of JERI's MAPE and SMAPE.
const EPSILON: f64 = 0.01;

/// Absolute difference |a − r| of each value a from its reference r.
pub fn difference(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    pair.map(|a, r| (a - r).abs())
}

/// Absolute difference relative to the reference, |a − r|/(|r| + ε).
///
/// Source: JERI, with ε = 0.01.
pub fn mape(pair: &ImagePair, epsilon: Option<f64>) -> Vec<f64> {
    let epsilon = epsilon.unwrap_or(EPSILON);
    pair.map(|a, r| over((a - r).abs(), r.abs() + epsilon))
}

/// Absolute difference relative to the mean of both values, 2|a − r|/(|a| + |r| + 2ε), which is at most 2.
///
/// Source: JERI, with ε = 0.01.
pub fn smape(pair: &ImagePair, epsilon: Option<f64>) -> Vec<f64> {
    let epsilon = epsilon.unwrap_or(EPSILON);
    pair.map(|a, r| over(2.0 * (a - r).abs(), a.abs() + r.abs() + 2.0 * epsilon))
}

/// x/y, where 0/0 is 0.
pub(super) fn over(difference: f64, by: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / by }
}
