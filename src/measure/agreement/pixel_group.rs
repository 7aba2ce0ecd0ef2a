//! Groups of neighbouring pixels, with an estimate of how many samples make their noise.
//!
//! Let m be the light of a pixel above its surroundings, and v its variance. At least
//!
//! h = m²/v
//!
//! samples make its noise, and at least one: h equal samples of value x that arrive by chance (Poisson) have the cumulants κₙ = h
//! xⁿ, so m = h x and v = h x². The cumulants of a sum are the sums of the cumulants, and the noise of the sum is that of v²/κ₄
//! equal samples.
//!
//! Tests: the edge of a lamp, light that is rarely found.

use crate::measure::Mean;

/// Neighbouring pixels and their sums.
pub(super) struct PixelGroup {
    /// Both estimates of each pixel. No variance is below the mean variance of this group or of a part from which the group was
    /// joined.
    pub pixels: Vec<[Mean; 2]>,
    /// Sums over the pixels, for both images.
    pub sums: [GroupSum; 2],
}

/// Sum of the means of pixels, and the cumulants of its noise. The noise of a pixel counts as that of h samples.
#[derive(Clone, Copy, Default)]
pub(super) struct GroupSum {
    /// Sum of the means, with its variance.
    pub mean: Mean,
    /// κ₃ = v^1.5 / h^0.5
    pub third: f64,
    /// κ₄ = v² / h
    fourth: f64,
}

/// Adds to each mean the light of its surroundings: the median of all the means.
pub(super) fn with_surroundings(means: impl Iterator<Item = Mean>) -> impl Iterator<Item = (Mean, f64)> {
    let means: Vec<Mean> = means.collect();
    let mut values: Vec<f64> = means.iter().map(|mean| mean.value).collect();
    let middle = values.len() / 2;
    let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
    means.into_iter().map(move |mean| (mean, median))
}

/// h of a pixel: the number of samples that make its noise.
pub(super) fn samples(mean: Mean, surroundings: f64) -> f64 {
    ((mean.value - surroundings).powi(2) / mean.variance).max(1.0)
}

impl GroupSum {
    /// Sum over pixels.
    pub fn of(means: impl Iterator<Item = Mean>) -> GroupSum {
        let of_one = |(mean, surroundings): (Mean, f64)| {
            let samples = samples(mean, surroundings);
            GroupSum { mean, third: mean.variance.powf(1.5) / samples.sqrt(), fourth: mean.variance.powi(2) / samples }
        };
        with_surroundings(means).map(of_one).fold(GroupSum::default(), GroupSum::add)
    }

    fn add(self, next: GroupSum) -> GroupSum {
        GroupSum { mean: add(self.mean, &next.mean), third: self.third + next.third, fourth: self.fourth + next.fourth }
    }

    /// v² / κ₄: the number of equal samples that would make this noise. NaN if there is no noise.
    pub fn samples(&self) -> f64 {
        self.mean.variance.powi(2) / self.fourth
    }
}

impl PixelGroup {
    /// Group of these pixels.
    pub fn of(pixels: Vec<[Mean; 2]>) -> PixelGroup {
        let sums = [0, 1].map(|k| GroupSum::of(pixels.iter().map(|pixel| pixel[k])));
        PixelGroup::cautious(pixels, sums)
    }

    /// Group of all pixels of these groups.
    pub fn joined(parts: Vec<PixelGroup>) -> PixelGroup {
        let sums = [0, 1].map(|k| parts.iter().map(|part| part.sums[k]).fold(GroupSum::default(), GroupSum::add));
        PixelGroup::cautious(parts.into_iter().flat_map(|part| part.pixels).collect(), sums)
    }

    /// Raises the variance of each pixel to at least the mean variance of the group.
    fn cautious(pixels: Vec<[Mean; 2]>, sums: [GroupSum; 2]) -> PixelGroup {
        let floor = sums.map(|sum| sum.mean.variance / pixels.len() as f64);
        let sure = |mean: Mean, k: usize| Mean { variance: mean.variance.max(floor[k]), ..mean };
        PixelGroup { pixels: pixels.into_iter().map(|[a, b]| [sure(a, 0), sure(b, 1)]).collect(), sums }
    }

    /// Returns whether the noise of both sides comes from at least so many samples, or there is no noise.
    pub fn has_samples(&self, among: f64) -> bool {
        !self.sums.iter().any(|sum| sum.samples() < among)
    }
}

/// Sum of independent estimates: values, variances and numbers of samples add.
pub(super) fn add(sum: Mean, next: &Mean) -> Mean {
    Mean { value: sum.value + next.value, variance: sum.variance + next.variance, samples: sum.samples + next.samples }
}
