//! Neighbouring pixels, and how many samples make their noise.
//!
//! Of a pixel's light above its surroundings, m, and variance v, they are at least
//!
//! h = m²/v
//!
//! and at least one: h equal samples x that come by chance (Poisson) have the cumulants κₙ = h xⁿ, so that m = h x and v = h x². The
//! cumulants of a sum are the sums of them; its noise is that of v²/κ₄ equal samples.
//!
//! Tests: the edge of a lamp, light that is rarely found.

use crate::measure::Mean;

/// Neighbouring pixels and their sums.
pub(super) struct Block {
    /// None surer than the block, or one of the parts it was joined of, is in the mean.
    pub pixels: Vec<[Mean; 2]>,
    pub sums: [Sum; 2],
}

/// A sum of means, and the cumulants of its noise, of every pixel that of h samples.
#[derive(Clone, Copy, Default)]
pub(super) struct Sum {
    pub mean: Mean,
    /// κ₃ = v^1.5 / h^0.5
    pub third: f64,
    /// κ₄ = v² / h
    fourth: f64,
}

/// Neighbouring pixels, and the light around them: their median.
pub(super) fn with_surroundings(means: impl Iterator<Item = Mean>) -> impl Iterator<Item = (Mean, f64)> {
    let means: Vec<Mean> = means.collect();
    let mut values: Vec<f64> = means.iter().map(|mean| mean.value).collect();
    let middle = values.len() / 2;
    let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
    means.into_iter().map(move |mean| (mean, median))
}

/// h of a pixel.
pub(super) fn samples(mean: Mean, surroundings: f64) -> f64 {
    ((mean.value - surroundings).powi(2) / mean.variance).max(1.0)
}

impl Sum {
    pub fn of(means: impl Iterator<Item = Mean>) -> Sum {
        let of_one = |(mean, surroundings): (Mean, f64)| {
            let samples = samples(mean, surroundings);
            Sum { mean, third: mean.variance.powf(1.5) / samples.sqrt(), fourth: mean.variance.powi(2) / samples }
        };
        with_surroundings(means).map(of_one).fold(Sum::default(), Sum::add)
    }

    fn add(self, next: Sum) -> Sum {
        Sum { mean: add(self.mean, &next.mean), third: self.third + next.third, fourth: self.fourth + next.fourth }
    }

    /// v² / κ₄: how many equal samples would make this noise. NaN without noise.
    pub fn samples(&self) -> f64 {
        self.mean.variance.powi(2) / self.fourth
    }
}

impl Block {
    pub fn of(pixels: Vec<[Mean; 2]>) -> Block {
        let sums = [0, 1].map(|k| Sum::of(pixels.iter().map(|pixel| pixel[k])));
        Block::cautious(pixels, sums)
    }

    pub fn joined(parts: Vec<Block>) -> Block {
        let sums = [0, 1].map(|k| parts.iter().map(|part| part.sums[k]).fold(Sum::default(), Sum::add));
        Block::cautious(parts.into_iter().flat_map(|part| part.pixels).collect(), sums)
    }

    /// Makes no pixel surer than the block is in the mean.
    fn cautious(pixels: Vec<[Mean; 2]>, sums: [Sum; 2]) -> Block {
        let floor = sums.map(|sum| sum.mean.variance / pixels.len() as f64);
        let sure = |mean: Mean, k: usize| Mean { variance: mean.variance.max(floor[k]), ..mean };
        Block { pixels: pixels.into_iter().map(|[a, b]| [sure(a, 0), sure(b, 1)]).collect(), sums }
    }

    /// Whether at least so many samples make the noise of both sides, where there is noise.
    pub fn is_shared(&self, among: f64) -> bool {
        !self.sums.iter().any(|sum| sum.samples() < among)
    }
}

/// Sums of independent estimates: values and variances add, and so do samples.
pub(super) fn add(sum: Mean, next: &Mean) -> Mean {
    Mean { value: sum.value + next.value, variance: sum.variance + next.variance, samples: sum.samples + next.samples }
}
