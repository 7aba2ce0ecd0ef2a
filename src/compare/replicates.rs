//! Means over the replicates of a method.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::Measurement;

/// Mean of a number over the replicates.
pub struct Replicates {
    /// The mean.
    pub mean: f64,
    /// Standard error of the mean; 0 for one replicate.
    pub error: f64,
    count: f64,
}

impl Replicates {
    /// Mean of values, one for each replicate.
    pub fn new(values: &[f64]) -> Replicates {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        Replicates { mean, error: if count > 1.0 { (squares / (count * (count - 1.0))).sqrt() } else { 0.0 }, count }
    }

    /// Takes a number of each replicate; `None` if one of the replicates has no such number.
    pub fn of(measurements: &[Measurement], value: impl Fn(&[&Measurement]) -> Option<f64>) -> Option<Replicates> {
        let replicates = measurements.iter().map(|m| m.replicate + 1).max()?;
        let one = |r: u32| value(&measurements.iter().filter(|m| m.replicate == r).collect::<Vec<_>>());
        let values: Vec<f64> = (0..replicates).map(one).collect::<Option<_>>()?;
        Some(Replicates::new(&values))
    }

    /// Quantile of Student's t, with one degree of freedom less than there are replicates.
    pub fn quantile(&self, p: f64) -> f64 {
        StudentsT::new(0.0, 1.0, (self.count - 1.0).max(1.0)).map_or(0.0, |t| t.inverse_cdf(p))
    }
}
