//! Standard errors of the pixels of a picture.
//!
//! A pixel's own estimate v of its variance is right on average, but the square root of one such estimate is a poor standard error:
//!
//! - Where the samples of a pixel are divided among two scramblings, v = (m₁ − m₂)²/4 is near 0 whenever both means are nearly equal by
//!   chance: a tenth of all pixels deviate from the truth by more than six of their own √v.
//! - Independent samples are skewed: a pixel that lacks its rare bright samples is too dark, and its samples look too much alike. With
//!   64 of them as few as 87 % of the pixels deviate by less than 1.96 of their own √v, where 95 % are meant.
//!
//! The variances of neighbouring pixels are therefore averaged. A pixel counts a part w of its estimate v for itself and divides the
//! remaining part 1 − w among the 7 × 7 pixels around it, in proportion to the standard deviation u of the samples of each. The variance of
//! pixel i is the part that it counts for itself plus what it receives from its neighbours:
//!
//! ```text
//! σ²ᵢ = wᵢ vᵢ + uᵢ Σ (1 − w_q) v_q / Σ u_j        over the neighbours q of i, and over the neighbours j of q
//! ```
//!
//! w is the share that a pixel keeps for itself: 0 with fewer than 16 scramblings, 1 from there on, and n/(n + 256) with n independent
//! samples, whose own v becomes certain in the end. The sum of σ² over the picture is that of v, so that it is still right on average. A
//! pixel with an outlier keeps a larger error than its neighbours. Where pixels have different numbers n of samples, n v takes the place
//! of v and n σ² that of σ².
//!
//! At the edge of a crop fewer neighbours are known than in the whole picture, so that standard errors there may differ from those of the
//! whole picture.
//!
//! Tests: standard_errors_of_scramblings_hold, standard_errors_of_skewed_samples_hold, standard_errors_keep_their_sum;
//! `cargo bench --bench accuracy -- pixels` counts on scenes.

use rayon::prelude::*;

use super::FilmSpec;
use super::neighborhood::neighborhood;
use super::pixel_sums::{Estimate, PixelSums, Skew};
use crate::sampler::ErrorEstimator;

/// Radius of the neighbourhood (pixels): 49 pixels of two scramblings each give 49 degrees of freedom.
const REACH: usize = 3;

/// Number of scramblings from which the variance of a pixel needs no neighbours: with 15 degrees of freedom, 93 % of the pixels deviate
/// by less than 1.96 standard errors, where 95 % are meant.
const ENOUGH: u32 = 16;

/// Number of independent samples of which a pixel keeps half of its own variance: with 64 and with 256 of them, 93 to 97 % of the pixels of
/// the scenes in the table `pixels` deviate by less than 1.96 standard errors.
const HALF: f64 = 256.0;

/// Standard error of red, green and blue of each pixel.
///
/// - `estimates`: mean and variance of each pixel
/// - `taken`: number of samples of pixel i
pub(super) fn standard_errors(
    spec: &FilmSpec,
    sums: &PixelSums,
    estimates: &[Estimate],
    taken: &(dyn Fn(usize) -> u64 + Sync),
) -> Vec<[f64; 3]> {
    let own = |pixel: &Estimate| pixel.map(|(_, variance)| variance.sqrt());
    if matches!(sums.error_estimator(), ErrorEstimator::Scramblings(ENOUGH..)) {
        return estimates.iter().map(own).collect();
    }
    // The share w that pixel i keeps.
    let kept = |i: usize| match sums.error_estimator() {
        ErrorEstimator::Scramblings(_) => 0.0,
        ErrorEstimator::Samples => taken(i) as f64 / (taken(i) as f64 + HALF),
    };
    let deviation = |(i, pixel)| {
        let n = taken(i);
        (Skew::of(sums.error_estimator(), pixel, n).variance * n as f64).sqrt()
    };
    let deviations: Vec<f64> = sums.pixels().enumerate().map(deviation).collect();
    let around = |i: usize| neighborhood(i, REACH, spec.crop.size().x as usize, estimates.len());
    let totals: Vec<f64> = (0..estimates.len()).into_par_iter().map(|i| around(i).map(|j| deviations[j]).sum()).collect();
    // (1 − w) n v / Σ u, for each colour
    let share = |q: usize| {
        let of = |variance: f64| if totals[q] > 0.0 { (1.0 - kept(q)) * taken(q) as f64 * variance / totals[q] } else { 0.0 };
        estimates[q].map(|(_, variance)| of(variance))
    };
    let shares: Vec<[f64; 3]> = (0..estimates.len()).into_par_iter().map(share).collect();
    let error = |i: usize| {
        if totals[i] == 0.0 {
            return own(&estimates[i]);
        }
        let sum = around(i).fold([0.0; 3], |sum, q| std::array::from_fn(|c| sum[c] + shares[q][c]));
        std::array::from_fn(|c| (kept(i) * estimates[i][c].1 + deviations[i] * sum[c] / taken(i) as f64).sqrt())
    };
    (0..estimates.len()).into_par_iter().map(error).collect()
}
