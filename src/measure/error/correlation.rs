//! Correlation of the errors of different pixels.
//!
//! ```text
//! φ = tr C² / Σ Cᵢᵢ²,   C: covariance of the errors of the pixels, relative to their brightness
//! ```
//!
//! The squared error of the picture is a sum over the pixels, whose variance is φ times that for independent errors. Where each pixel
//! has its own samples φ is 1; paths from the lights are shared by all pixels, and evenly distributed over all of them.
//!
//! The scramblings give independent pictures e₁ … e_K of the same expectation. For four of them
//!
//! ```text
//! E[((e₁ − e₂) · (e₃ − e₄))²] = 4 tr C²
//! ```
//!
//! whatever C is.

use crate::film::{Film, MomentFilm, PixelSamples};
use crate::sampler::ErrorEstimator;

/// Smallest number of scramblings that shows correlation.
const FEWEST: u32 = 4;

/// Factor φ ≥ 1 of the variance of the picture's squared error; 1 if there are too few scramblings to know.
///
/// - `floor`: ε
///
/// Tests: intervals_hold_the_true_error_of_splats, correlated_pixels_are_noticed.
pub(super) fn correlation(film: &MomentFilm, floor: f64) -> f64 {
    let k = match film.error_estimator() {
        Some(ErrorEstimator::Scramblings(k)) if k >= FEWEST => k as usize,
        _ => return 1.0,
    };
    let total = film.total();
    let set = film.sample_set();
    let samples = |i| set.of_pixel(film.spec().allocation.level(i));
    let pixels: Vec<Vec<f64>> = total.pixels().enumerate().map(|(i, pixel)| relative_errors(pixel, k, samples(i), floor)).collect();
    let product = |r: usize, s: usize| pixels.iter().map(|errors| errors[r] * errors[s]).sum::<f64>();
    let gram: Vec<Vec<f64>> = (0..k).map(|r| (0..=r).map(|s| product(r, s)).collect()).collect();
    let dot = |r: usize, s: usize| gram[r.max(s)][r.min(s)];
    let (mut sum, mut count) = (0.0, 0.0);
    for (a, b) in pairs(0, k) {
        for (c, d) in pairs(a + 1, k).filter(|(c, d)| *c != b && *d != b) {
            sum += (dot(a, c) - dot(a, d) - dot(b, c) + dot(b, d)).powi(2);
            count += 4.0;
        }
    }
    // The square of a variance with ν degrees of freedom is too large by (ν + 2)/ν.
    let nu = (k - 1) as f64;
    let variance = |errors: &Vec<f64>| errors.iter().map(|e| e * e).sum::<f64>() / nu;
    let alone: f64 = pixels.iter().map(|errors| variance(errors).powi(2)).sum::<f64>() * nu / (nu + 2.0);
    if alone > 0.0 { (sum / count / alone).max(1.0) } else { 1.0 }
}

/// Pairs of different numbers from `from` to `to` − 1.
fn pairs(from: usize, to: usize) -> impl Iterator<Item = (usize, usize)> {
    (from..to).flat_map(move |a| (a + 1..to).map(move |b| (a, b)))
}

/// Deviations of the scramblings from their mean in a pixel, divided by √(mean² + ε).
///
fn relative_errors(pixel: &[f64], k: usize, samples: PixelSamples, floor: f64) -> Vec<f64> {
    let share = |r: usize| 1.0 / samples.of_scrambling(k as u64, r as u64).max(1) as f64;
    let gray: Vec<f64> = (0..k).map(|r| pixel[3 * r..3 * r + 3].iter().sum::<f64>() / 3.0 * share(r)).collect();
    let mean = gray.iter().sum::<f64>() / k as f64;
    gray.iter().map(|gray| (gray - mean) / (mean * mean + floor).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, FilmSpec, Moments, PixelSums, Wave};
    use crate::math::Spectrum;
    use crate::sampler::hash::mix;

    /// Film of K scramblings whose errors are shared by groups of `group` pixels.
    fn film(group: u64) -> MomentFilm {
        const K: u32 = 32;
        const EDGE: u32 = 24;
        let mut block = PixelSums::with_capacity(ErrorEstimator::Scramblings(K), (EDGE * EDGE) as usize);
        for i in 0..u64::from(EDGE * EDGE) {
            let error = |r: u64| (mix(1000 * (i / group) + r) >> 40) as f32 / (1u32 << 24) as f32;
            let sequences: Vec<Moments> = (0..K.into()).map(|r| Moments::of(Spectrum::gray(1.0 + error(r)))).collect();
            block.push(&sequences, [0.0; 2]);
        }
        let mut film = MomentFilm::new(FilmSpec::new(EDGE, EDGE));
        film.add(Wave { first: 0, level: K.ilog2() }, block);
        film
    }

    /// Where groups of g pixels have the same error, tr C² is g times the sum of the squared variances. The fewest independent errors
    /// are those of 36 groups of 16: with 496 pairs of scramblings they leave a standard error of some 10 %, a quarter of what is allowed.
    #[test]
    fn correlated_pixels_are_noticed() {
        for group in [1, 4, 16] {
            let found = correlation(&film(group), 0.01);
            assert!((found / group as f64 - 1.0).abs() < 0.4, "groups of {group}: {found}");
        }
    }
}
