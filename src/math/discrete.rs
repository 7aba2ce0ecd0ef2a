//! Choosing one of many with given weights.

use super::float::ONE_MINUS_EPSILON;

/// A distribution over the indices 0 … n − 1.
///
/// pmf(i) = wᵢ / Σ wⱼ
///
/// Sums are `f64` and never normalised: scaling all weights by a power of two changes no bit of any answer.
///
/// Tests: never picks weight 0, pmf sums to 1, frequencies, power-of-two scaling.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// w₀ + … + wᵢ₋₁ at i: one entry more than there are weights.
    cumulative: Vec<f64>,
}

impl Discrete {
    /// `None` if nothing can be picked: no weight above 0, or one that is negative or not finite.
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

    /// Picks an index in proportion to its weight.
    ///
    /// - `choice`: uniform in [0, 1), of 24 bits: probabilities are met to 2⁻²⁴, so many small ones want a tree
    /// - returns the index, its pmf, and `choice` stretched over the picked interval: uniform in
    ///   [0, 1) again, with as many bits fewer as the pick has used
    #[inline]
    pub fn sample(&self, choice: f32) -> (usize, f32, f32) {
        let target = f64::from(choice) * self.total();
        // The first interval that ends above the target: an empty one never does before its predecessor.
        let i = self.cumulative[1..].partition_point(|&end| end <= target).min(self.len() - 1);
        let width = self.cumulative[i + 1] - self.cumulative[i];
        let rest = ((target - self.cumulative[i]) / width) as f32;
        (i, self.pmf(i), rest.clamp(0.0, ONE_MINUS_EPSILON))
    }

    /// The probability of index `i`; 0 beyond the end.
    #[inline]
    pub fn pmf(&self, i: usize) -> f32 {
        match self.cumulative.get(i..i + 2) {
            Some(ends) => ((ends[1] - ends[0]) / self.total()) as f32,
            None => 0.0,
        }
    }

    /// Σ wⱼ
    #[inline]
    pub fn total(&self) -> f64 {
        self.cumulative[self.len()]
    }

    #[inline]
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }
}
