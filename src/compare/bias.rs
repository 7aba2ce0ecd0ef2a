//! Bias: the distance from the reference that more samples do not remove.
//!
//! ```text
//! b² = 1/3P Σ ((x̄ − r)² − u) / (r² + ε),   u = v_x̄ + v_r
//! ```
//!
//! By the noise, (x̄ − r)² has the variance 2u² + 4b²u. The colours are taken as fully correlated.

use crate::film::Image;
use crate::measure::error::{errors, floor};

/// Number of standard errors by which b² must differ from a value to exclude it. For normal noise the probability of a wrong statement
/// is 10⁻⁴, with room for heavy tails.
const SURE: f64 = 4.0;

/// Estimate of b², which may be negative, with its standard error.
#[derive(Clone, Copy, Debug)]
pub struct SquaredBias {
    square: f64,
    error: f64,
}

impl SquaredBias {
    /// Estimate from the mean of all replicates and the reference, with the standard errors of both; `None` for a black reference.
    pub fn between(image: &Image, reference: &Image) -> Option<SquaredBias> {
        let floor = floor(reference)?;
        let errors = [errors(image), errors(reference)];
        let variance_of = |c: usize, i: usize| errors.iter().flatten().map(|channels| f64::from(channels[c][i]).powi(2)).sum::<f64>();
        let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
        for (i, (x, r)) in image.pixels().zip(reference.pixels()).enumerate() {
            let mut spread = 0.0;
            for c in 0..3 {
                let below = 3.0 * (f64::from(r[c]).powi(2) + floor);
                let u = variance_of(c, i);
                let square = f64::from(x[c] - r[c]).powi(2) - u;
                sum += square / below;
                spread += (2.0 * u * u + 4.0 * square.max(0.0) * u).sqrt() / below;
            }
            variance += spread * spread;
            count += 1.0;
        }
        Some(SquaredBias { square: sum / count, error: variance.sqrt() / count })
    }

    /// An estimate that is known.
    #[cfg(test)]
    pub fn new(square: f64, error: f64) -> SquaredBias {
        SquaredBias { square, error }
    }

    /// Relative error b with its standard error; `None` if noise explains the difference.
    pub fn detected(&self) -> Option<(f64, f64)> {
        let SquaredBias { square, error } = *self;
        (square > SURE * error && square > 0.0).then(|| (square.sqrt(), 0.5 * error / square.sqrt()))
    }

    /// Relative error that the bias does not exceed. A smaller one is not excluded.
    pub fn bound(&self) -> f64 {
        (self.square.max(0.0) + SURE * self.error).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::super::synthetic::image;
    use super::*;

    /// +0.1 and −0.1 equally often.
    fn noise(i: usize) -> f32 {
        if (i * 7919) % 1024 < 512 { 0.1 } else { -0.1 }
    }

    fn between(image: &Image, reference: &Image) -> SquaredBias {
        SquaredBias::between(image, reference).expect("no black reference")
    }

    /// A picture that is a fifth too bright, with noise of a tenth: b² = 0.2²/(1 + ε). Noise alone is no bias.
    #[test]
    fn bias_is_what_noise_does_not_explain() {
        let reference = image(|_| 1.0, 0.0);
        let (found, error) = between(&image(|i| 1.2 + noise(i), 0.1), &reference).detected().expect("a bias");
        let wanted = 0.2 / 1.01f64.sqrt();
        assert!((found - wanted).abs() < 4.0 * error && error < 0.05 * wanted, "{found} ± {error}, wanted {wanted}");
        assert!(between(&image(|i| 1.0 + noise(i), 0.1), &reference).detected().is_none());
        // The reference's own errors count as noise too.
        assert!(between(&image(|i| 1.0 + noise(i), 0.0), &image(|_| 1.0, 0.1)).detected().is_none());
    }

    /// With noise alone b² = 0 ± √2·u/(1 + ε)/√P, of which four standard errors are not excluded; a bias that is there is below its bound.
    #[test]
    fn a_bias_below_the_bound_is_not_excluded() {
        let unbiased = between(&image(|i| 1.0 + noise(i), 0.1), &image(|_| 1.0, 0.0));
        assert_relative_eq!(unbiased.bound().powi(2), 4.0 * 2f64.sqrt() * 0.01 / 1.01 / 32.0, max_relative = 1e-4);
        // Errors of picture and reference both widen it: the sum of the variances is the same.
        let half = 0.1 / 2f32.sqrt();
        let shared = between(&image(|i| 1.0 + noise(i), half), &image(|_| 1.0, half));
        assert_relative_eq!(shared.bound(), unbiased.bound(), max_relative = 1e-4);
        let biased = between(&image(|i| 1.2 + noise(i), 0.1), &image(|_| 1.0, 0.0));
        assert!(biased.bound() > 0.2 / 1.01f64.sqrt());
    }
}
