//! Means with standard errors, and tests on them.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Estimate of a mean from independent samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    /// The estimated mean.
    pub value: f64,
    /// Variance of the mean: s²/n.
    pub variance: f64,
    /// n, the number of samples.
    pub samples: f64,
}

/// Statistic of Welch's test of two means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// Difference divided by its standard error.
    pub t: f64,
    /// ν, the degrees of freedom.
    pub freedom: f64,
}

impl Mean {
    /// Mean from sums: s² = (Σx² − (Σx)²/n)/(n − 1), variance = s²/n.
    ///
    /// - `sum`, `square`: Σx, Σx² of `samples` ≥ 2 independent samples
    pub fn from_sums(sum: f64, square: f64, samples: u64) -> Mean {
        let n = samples as f64;
        let spread = (square - sum * sum / n).max(0.0) / (n - 1.0);
        Mean { value: sum / n, variance: spread / n, samples: n }
    }

    /// Standard error of the mean, √variance.
    pub fn standard_error(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Number of standard errors by which the mean lies above `truth`; ±∞ if the variance is 0.
    pub fn z(&self, truth: f64) -> f64 {
        over(self.value - truth, self.standard_error())
    }

    /// Statistic for the question whether two means estimate the same number. Their variances and numbers of samples may differ.
    ///
    /// t = (m₁ − m₂)/√(v₁ + v₂),  ν = (v₁ + v₂)² / (v₁²/(n₁ − 1) + v₂²/(n₂ − 1)),  v = s²/n
    ///
    /// Source: Welch, *The Generalization of Student's Problem* (1947). Tests: known value, false alarms at their level.
    pub fn welch(&self, other: &Mean) -> Welch {
        let (v, w) = (self.variance, other.variance);
        let freedom = (v + w) * (v + w) / (v * v / (self.samples - 1.0) + w * w / (other.samples - 1.0));
        Welch { t: over(self.value - other.value, (v + w).sqrt()), freedom }
    }
}

impl Welch {
    /// Probability of a difference at least this large between estimates of the same number.
    pub fn p(&self) -> f64 {
        if self.t.is_infinite() {
            return 0.0;
        }
        // If both variances are 0, ν is not a number; then the difference is 0 too, and t = 0.
        let freedom = if self.freedom >= 1.0 { self.freedom } else { 1.0 };
        match StudentsT::new(0.0, 1.0, freedom) {
            Ok(student) => 2.0 * student.cdf(-self.t.abs()),
            Err(_) => 0.0,
        }
    }
}

/// x/y, where 0/0 is 0.
fn over(difference: f64, error: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_small_numbers() {
        // 1, 2, 3, 4: mean 2.5, s² = 5/3.
        let mean = Mean::from_sums(10.0, 30.0, 4);
        assert!((mean.value - 2.5).abs() < 1e-15 && (mean.variance - 5.0 / 12.0).abs() < 1e-15);
        assert!((mean.z(2.0) - 0.5 / (5.0f64 / 12.0).sqrt()).abs() < 1e-12);
    }

    /// v₁ = .04, n₁ = 10, v₂ = .09, n₂ = 20: ν = .13²/(.0016/9 + .0081/19) by hand; at t = 2.0639, ν = 24 a table of Student's t gives p = .05.
    #[test]
    fn welch_by_hand() {
        let a = Mean { value: 1.0, variance: 0.04, samples: 10.0 };
        let b = Mean { value: 2.0, variance: 0.09, samples: 20.0 };
        let welch = a.welch(&b);
        assert!((welch.t + 1.0 / 0.13f64.sqrt()).abs() < 1e-12);
        assert!((welch.freedom - 0.0169 / (0.0016 / 9.0 + 0.0081 / 19.0)).abs() < 1e-9);
        assert!((Welch { t: 2.063_899, freedom: 24.0 }.p() - 0.05).abs() < 1e-6);
    }

    #[test]
    fn without_spread_only_equality_agrees() {
        let one = Mean { value: 1.0, variance: 0.0, samples: 9.0 };
        let two = Mean { value: 2.0, ..one };
        assert!(one.welch(&one).p() > 0.999);
        assert_eq!(one.welch(&two).p(), 0.0);
        assert_eq!(one.z(2.0), f64::NEG_INFINITY);
    }
}
