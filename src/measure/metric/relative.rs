//! Squared differences relative to the reference: a dark corner counts as much as a lamp.
//!
//! Five programs have five formulas. They differ in the term that avoids division by zero at black reference pixels, and that term
//! decides the result wherever a picture is dark.

use super::ImagePair;
use super::absolute::over;

/// Relative squared error (a − r)²/(r² + ε) of each value a against its reference r, with ε = 0.01·mean²(r) unless it is given.
///
/// With pt's own ε, errors turn from relative to absolute at a tenth of the mean brightness, and nothing changes when both pictures
/// are scaled. For a black reference every difference is infinite.
///
/// Tests: by hand, scaling by 2^k bit for bit.
pub fn relmse(pair: &ImagePair, epsilon: Option<f64>) -> Vec<f64> {
    let mean = pair.reference_mean();
    let epsilon = epsilon.unwrap_or(0.01 * mean * mean);
    pair.map(|a, r| over((a - r) * (a - r), r * r + epsilon))
}

/// Relative squared error (a − r)²/(r² + 0.01) of tev.
///
/// Source: tev, RelativeSquaredError.
pub fn tev(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    relmse(pair, Some(0.01))
}

/// Relative squared error (a − r)²/(r² + 0.01) of SeeSharp, 0 where r = 0.
///
/// Source: SeeSharp and its SimpleImageIO, relMSE.
pub fn seesharp(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    pair.map(|a, r| if r == 0.0 { 0.0 } else { (a - r) * (a - r) / (r * r + 0.01) })
}

/// Relative squared error (a − r)²/(r + 0.01)² of pbrt, 0 where it is infinite.
///
/// Source: pbrt-v4, `imgtool diff --metric MRSE`.
pub fn pbrt(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    let error = |a: f64, r: f64| over((a - r) * (a - r), (r + 0.01) * (r + 0.01));
    pair.map(|a, r| Some(error(a, r)).filter(|e| e.is_finite()).unwrap_or(0.0))
}

/// Relative squared error (a − r)²/(r² + 10⁻⁴) of JERI.
///
/// Source: JERI, MRSE.
pub fn jeri(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    relmse(pair, Some(1e-4))
}

/// Relative squared error (a − r)²/(a² + 10⁻³) of Tungsten, where the first picture, a, is the reference.
///
/// Source: Tungsten's hdrmanip, which calls it rmse.
pub fn tungsten(pair: &ImagePair, _: Option<f64>) -> Vec<f64> {
    pair.map(|a, r| (a - r) * (a - r) / (a * a + 1e-3))
}
