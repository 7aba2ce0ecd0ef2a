//! Test of two whole images whose noise comes from a few samples.
//!
//! A sum s with variance v, whose noise is that of h equal samples of size x = √(v/h), is modelled as c + x N: a constant c = s − h x, and a
//! Poisson-distributed number of samples N, of which h were found. If the truth is μ, the expected number is λ = (μ − c)/x, and
//!
//! ```text
//! p_low(μ)  = P(N ≤ h) = Γ(h + 1, λ) / Γ(h + 1)        for the darker image, which may lack samples
//! p_high(μ) = P(N ≥ h) = γ(h, λ) / Γ(h)                for the brighter one, which may have too many
//! p         = 2 max_μ min(p_low(μ), p_high(μ))
//! ```
//!
//! The darker image may also lack samples of a size that only the brighter one has met so far. So its noise counts as that of fewer,
//! larger samples if those of the brighter one are larger: x is the larger of both, and h = v/x².
//!
//! p is below α if no μ lies in both intervals of the level α/2. So a few samples more or less may explain a difference,
//! and only a difference that they cannot explain is significant.
//!
//! Tests: few_samples_explain_what_poisson_allows, samples_that_only_one_side_has_met_are_no_difference,
//! a_heavy_tail_does_not_hide_a_brighter_lamp.

use statrs::function::gamma::{gamma_lr, gamma_ur};

use super::pixel_group::GroupSum;

/// p of the difference of two sums.
pub(super) fn p(sums: [&GroupSum; 2]) -> f64 {
    let [a, b] = sums;
    let (darker, brighter) = if a.mean.value <= b.mean.value { (a, b) } else { (b, a) };
    let (mut low, mut high) = (darker.mean.value, brighter.mean.value);
    let [darker, brighter] = [darker, brighter].map(RareSamples::of);
    let darker = darker.with_samples_of(&brighter);
    // p_low falls with μ, p_high rises.
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if darker.at_most(middle) > brighter.at_least(middle) { low = middle } else { high = middle }
    }
    let both = |mu: f64| darker.at_most(mu).min(brighter.at_least(mu));
    (2.0 * both(low).max(both(high))).min(1.0)
}

/// A sum as a dark part and h equal samples.
struct RareSamples {
    value: f64,
    /// c
    dark: f64,
    /// x; 0 if there is no noise.
    each: f64,
    /// h
    count: f64,
}

impl RareSamples {
    fn of(sum: &GroupSum) -> RareSamples {
        let (value, count) = (sum.mean.value, sum.samples());
        if sum.mean.variance.is_nan() || sum.mean.variance <= 0.0 || !count.is_finite() {
            return RareSamples { value, dark: value, each: 0.0, count: 0.0 };
        }
        let each = (sum.mean.variance / count).sqrt();
        RareSamples { value, dark: value - count * each, each, count }
    }

    /// Describes the sum by fewer, larger samples, as large as those of `other`. Its value and its variance stay; nothing changes if its
    /// samples are as large already.
    fn with_samples_of(self, other: &RareSamples) -> RareSamples {
        if other.each <= self.each {
            return self;
        }
        let count = self.count * (self.each / other.each).powi(2);
        RareSamples { dark: self.value - count * other.each, each: other.each, count, ..self }
    }

    /// Probability of at most so many samples if the truth is `mu`.
    fn at_most(&self, mu: f64) -> f64 {
        match self.expected(mu) {
            None => f64::from(mu <= self.value),
            Some(expected) if expected <= 0.0 => 1.0,
            Some(expected) => gamma_ur(self.count + 1.0, expected),
        }
    }

    /// Probability of at least so many samples if the truth is `mu`.
    fn at_least(&self, mu: f64) -> f64 {
        match self.expected(mu) {
            None => f64::from(mu >= self.value),
            Some(expected) if expected <= 0.0 => 0.0,
            Some(expected) => gamma_lr(self.count, expected),
        }
    }

    /// λ; `None` if there is no noise.
    fn expected(&self, mu: f64) -> Option<f64> {
        (self.each > 0.0).then(|| (mu - self.dark) / self.each)
    }
}
