//! Sampling of discrete distributions.

use super::float::ONE_MINUS_EPSILON;
use super::lanes::Lanes;

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

    /// The index and the rescaled number of [`Discrete::sample`] in each lane.
    ///
    /// Tests: lanes_have_the_bits_of_plain_samples.
    #[inline(always)]
    pub fn sample_lanes<L: Lanes>(&self, choice: L::F32) -> (L::U32, L::F32) {
        let sums = &self.cumulative[..];
        let target = L::widen(choice) * L::f64(self.total());
        let i = partition_point_lanes(self.len() as u32, &EndsAtMost::<L> { sums, target });
        let (start, end) = (L::gather_f64(sums, i), L::gather_f64(sums, i + L::u32(1)));
        let rescaled = L::narrow((target - start) / (end - start));
        (i, L::min(L::max(rescaled, L::f32(0.0)), L::f32(ONE_MINUS_EPSILON)))
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

/// Whether the interval of an index ends at or before a number, in each lane.
struct EndsAtMost<'a, L: Lanes> {
    sums: &'a [f64],
    target: L::F64,
}

impl<L: Lanes> Condition<L> for EndsAtMost<'_, L> {
    #[inline(always)]
    fn holds(&self, index: L::U32) -> L::Mask {
        !L::lt_f64(self.target, L::gather_f64(self.sums, index + L::u32(1)))
    }
}

/// Condition on indices, in each lane.
pub(crate) trait Condition<L: Lanes> {
    /// Whether it holds for the indices.
    fn holds(&self, index: L::U32) -> L::Mask;
}

/// In each lane, the first of `count` indices for which a condition does not hold, or the last index. The condition must hold for all
/// indices before that one and for none after it, and there must be an index.
#[inline(always)]
pub(crate) fn partition_point_lanes<L: Lanes>(count: u32, condition: &impl Condition<L>) -> L::U32 {
    // The index is one of `length` from `first` on.
    let (mut first, mut length) = (L::u32(0), count);
    while length > 1 {
        let half = length / 2;
        let middle = first + L::u32(half);
        first = L::select_u32(condition.holds(middle - L::u32(1)), middle, first);
        length -= half;
    }
    first
}
