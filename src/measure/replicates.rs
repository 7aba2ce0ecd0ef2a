//! Means over replicates: renders that differ by their random numbers alone.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// A number, and the ends of the interval that holds it with the requested probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Interval {
    /// Applies a non-decreasing function to the estimate and to both ends.
    pub fn map(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval { value: f(self.value), low: f(self.low), high: f(self.high) }
    }

    /// The interval of 1 − x.
    pub fn complement(self) -> Interval {
        Interval { value: 1.0 - self.value, low: 1.0 - self.high, high: 1.0 - self.low }
    }
}

/// Mean of a number over the replicates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replicates {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean; 0 for one replicate.
    pub error: f64,
    count: f64,
    /// Share of the squared deviations that one replicate has.
    largest: f64,
}

/// Probability of a heavy tail among normal values.
const RARE: f64 = 1e-5;

impl Replicates {
    /// Mean of values, one for each replicate.
    pub fn new(values: &[f64]) -> Replicates {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        Replicates::around(mean, values.iter().map(|x| x - mean), count)
    }

    /// Ratio ρ of two means, whose values come in pairs, one of each replicate. The error is that of the mean of a − ρ b over the mean of b.
    ///
    /// Source: Cochran, *Sampling Techniques* (1977), §2.11. Tests: known value, `intervals_hold_the_shares_of_a_furnace`.
    pub fn ratio(a: &[f64], b: &[f64]) -> Replicates {
        let count = a.len() as f64;
        let below = b.iter().sum::<f64>() / count;
        let mean = a.iter().sum::<f64>() / count / below;
        Replicates::around(mean, a.iter().zip(b).map(|(a, b)| (a - mean * b) / below), count)
    }

    fn around(mean: f64, deviations: impl Iterator<Item = f64>, count: f64) -> Replicates {
        let (sum, largest) = deviations.map(|x| x * x).fold((0.0, 0.0), |(sum, largest), x| (sum + x, f64::max(largest, x)));
        let error = if count > 1.0 { (sum / (count * (count - 1.0))).sqrt() } else { 0.0 };
        Replicates { mean, error, count, largest: if sum > 0.0 { largest / sum } else { 0.0 } }
    }

    /// Whether one replicate has so much of the variance that normal values would do so in 1 of 10⁵ cases. It is a sign of rare bright paths,
    /// of which there may be more than the samples met: then no interval is stated.
    ///
    /// q = share · n/(n − 1),   t² = q (n − 2)/(1 − q) for the largest of n values, with n − 2 degrees of freedom
    ///
    /// Source: Grubbs, *Sample Criteria for Testing Outlying Observations* (1950). Tests: values by hand, false alarms.
    pub fn has_heavy_tail(&self) -> bool {
        let q = self.largest * self.count / (self.count - 1.0);
        let freedom = self.count - 2.0;
        let Some(student) = Some(freedom).filter(|freedom| *freedom >= 1.0).and_then(|freedom| StudentsT::new(0.0, 1.0, freedom).ok())
        else {
            return false;
        };
        let t = (q * freedom / (1.0 - q).max(0.0)).sqrt();
        2.0 * self.count * student.cdf(-t) < RARE
    }

    /// Quantile of Student's t, with one degree of freedom less than there are replicates.
    pub fn quantile(&self, p: f64) -> f64 {
        StudentsT::new(0.0, 1.0, (self.count - 1.0).max(1.0)).map_or(0.0, |t| t.inverse_cdf(p))
    }

    /// The mean with the interval that holds the true one with this probability.
    pub fn interval(&self, confidence: f64) -> Interval {
        let reach = self.quantile(0.5 + 0.5 * confidence) * self.error;
        Interval { value: self.mean, low: self.mean - reach, high: self.mean + reach }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, 2, 3, 4: mean 2.5, s² = 5/3, so that the standard error is √(5/12), and t₀.₉₇₅ with 3 degrees of freedom is 3.1824.
    #[test]
    fn an_interval_by_hand() {
        let found = Replicates::new(&[1.0, 2.0, 3.0, 4.0]).interval(0.95);
        let reach = 3.182_446 * (5.0f64 / 12.0).sqrt();
        assert!((found.value - 2.5).abs() < 1e-15 && (found.high - 2.5 - reach).abs() < 1e-5 && (found.low - 2.5 + reach).abs() < 1e-5);
    }

    /// a = 2, 4, 9 and b = 1, 2, 2: ρ = 3, a − ρ b = −1, −2, 3, and the standard error is √(14/6)/(5/3). Common factors of a replicate cancel.
    #[test]
    fn a_ratio_by_hand() {
        let found = Replicates::ratio(&[2.0, 4.0, 9.0], &[1.0, 2.0, 2.0]);
        assert!((found.mean - 3.0).abs() < 1e-15 && (found.error - (14.0f64 / 6.0).sqrt() * 0.6).abs() < 1e-12, "{found:?}");
        assert!(Replicates::ratio(&[2.0, 4.0, 9.0], &[1.0, 2.0, 4.5]).error < 1e-15);
    }

    /// One of 32 values may hold half of the variance: a normal distribution has such a value once in 10⁴ cases (t = 5.7). It may not hold six
    /// tenths, for which it would be 3 in 10⁶ (t = 7). Equal values have no heavy tail, and two values say nothing about either of them.
    #[test]
    fn one_replicate_with_most_of_the_variance_is_a_heavy_tail() {
        // ±1, and x for one of them: x² is the share x²/(31 + x²), but for the mean.
        let values = |share: f64| {
            let x = (31.0 * share / (1.0 - share)).sqrt();
            (0..32).map(|i| if i == 31 { x } else { f64::from(i % 2) * 2.0 - 1.0 + 1.0 / 31.0 - x / 31.0 }).collect::<Vec<_>>()
        };
        assert!(!Replicates::new(&values(0.5)).has_heavy_tail() && Replicates::new(&values(0.61)).has_heavy_tail());
        assert!(!Replicates::new(&[3.0; 9]).has_heavy_tail() && !Replicates::new(&[0.0, 1e9]).has_heavy_tail());
    }
}
