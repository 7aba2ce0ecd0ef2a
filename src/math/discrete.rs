//! Sampling of discrete distributions.

use super::float::ONE_MINUS_EPSILON;

/// Discrete distribution over the indices 0 … n − 1.
///
/// pmf(i) = wᵢ / Σ wⱼ
///
/// The sums are in `f64` and not normalised, so that scaling all weights by a power of two changes no bit of a result.
///
/// Tests: never picks weight 0, pmf sums to 1, frequencies, power-of-two scaling.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// Sums w₀ + … + wᵢ₋₁ at i, one more than there are weights.
    cumulative: Vec<f64>,
}

impl Discrete {
    /// A distribution with the given weights; `None` if no weight is above 0, or one is negative or not finite.
    pub fn new(weights: &[f32]) -> Option<Discrete> {
        if weights.iter().any(|w| !w.is_finite() || *w < 0.0) || weights.iter().all(|w| *w == 0.0) {
            return None;
        }
        let mut sum = 0.0;
        let sums = weights.iter().map(|&w| {
            sum += f64::from(w);
            sum
        });
        Some(Discrete { cumulative: std::iter::once(0.0).chain(sums).collect() })
    }

    /// Samples an index in proportion to its weight.
    ///
    /// - `choice`: uniform in [0, 1) with 24 bits, so that probabilities are accurate to 2⁻²⁴
    ///
    /// Returns the index, its pmf, and `choice` rescaled to the interval of the index. The rescaled number is again uniform in [0, 1),
    /// with fewer random bits.
    #[inline]
    pub fn sample(&self, choice: f32) -> (usize, f32, f32) {
        let target = f64::from(choice) * self.total();
        // The first interval that ends above the target is never an empty one.
        let i = self.cumulative[1..].partition_point(|&end| end <= target).min(self.len() - 1);
        let width = self.cumulative[i + 1] - self.cumulative[i];
        let rescaled = ((target - self.cumulative[i]) / width) as f32;
        (i, self.pmf(i), rescaled.clamp(0.0, ONE_MINUS_EPSILON))
    }

    /// Probability of index `i`; 0 beyond the end.
    #[inline]
    pub fn pmf(&self, i: usize) -> f32 {
        match self.cumulative.get(i..i + 2) {
            Some(ends) => ((ends[1] - ends[0]) / self.total()) as f32,
            None => 0.0,
        }
    }

    /// Sum Σ wⱼ of the weights.
    #[inline]
    pub fn total(&self) -> f64 {
        self.cumulative[self.len()]
    }

    /// Number of indices.
    #[inline]
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }
}
