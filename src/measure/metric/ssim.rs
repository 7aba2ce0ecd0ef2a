//! Structural similarity: compares brightness, contrast and structure of every neighbourhood.
//!
//! SSIM = (2 μa μr + C₁)(2 σar + C₂) / ((μa² + μr² + C₁)(σa² + σr² + C₂)),    C₁ = 0.01², C₂ = 0.03²
//!
//! Means, variances and covariance are taken over a Gaussian window. Source: Wang, Bovik, Sheikh, Simoncelli, *Image Quality
//! Assessment: From Error Visibility to Structural Similarity* (2004). That paper uses only windows that lie wholly within the
//! picture; here every pixel has its own window, and at the border the remaining weights are scaled up.

use super::ImagePair;
use super::filter::{Border, Kernel, convolve};
use crate::math::photometry::luminance;

const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// 1 − SSIM of the luma of the tone-mapped pictures, for every pixel.
///
/// Tests: flat pictures by hand, against an independent evaluation, symmetric.
pub fn ssim(pair: &ImagePair) -> Vec<f64> {
    let [width, _] = pair.size();
    let [a, r] = pair.displayed().map(|pixels| pixels.iter().map(luma).collect::<Vec<f64>>());
    let window = Kernel::gaussian(5, 1.5);
    let blur = |values: &[f64]| convolve(values, width, &window, &window, Border::Renormalise);
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).collect::<Vec<f64>>();
    let (mean_a, mean_r) = (blur(&a), blur(&r));
    let (square_a, square_r, cross) = (blur(&product(&a, &a)), blur(&product(&r, &r)), blur(&product(&a, &r)));
    let error = |i: usize| {
        let (m, n) = (mean_a[i], mean_r[i]);
        let covariance = cross[i] - m * n;
        let variances = (square_a[i] - m * m) + (square_r[i] - n * n);
        1.0 - (2.0 * m * n + C1) * (2.0 * covariance + C2) / ((m * m + n * n + C1) * (variances + C2))
    };
    (0..a.len()).map(error).collect()
}

/// Y′ of Rec. 709 from encoded values.
fn luma(rgb: &[f32; 3]) -> f64 {
    luminance(rgb.map(f64::from))
}
