//! The checkpoints of a method as a curve of errors with their intervals.
//!
//! ```text
//! error = √relMSE,   interval = error · exp(±½ t s/relMSE)
//! ```
//!
//! with s the standard error of the mean relMSE and t Student's quantile for the number of replicates less one:
//! an interval of the logarithm, so that it stays positive. A relMSE at or below 0, which is no farther from the
//! reference than that is from the truth, has no place on a logarithmic axis and is left out.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::compare::{Method, Point};

/// A checkpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkpoint {
    pub samples: f64,
    pub seconds: f64,
    pub error: f64,
    pub low: f64,
    pub high: f64,
}

pub fn course(method: &Method, confidence: f64) -> Vec<Checkpoint> {
    let visible = method.curve.iter().filter(|point| point.relmse.0 > 0.0 && point.seconds > 0.0);
    visible.map(|point| checkpoint(method, point, confidence)).collect()
}

fn checkpoint(method: &Method, point: &Point, confidence: f64) -> Checkpoint {
    let replicates = method.measurements.iter().filter(|m| m.samples == point.samples).count();
    let (mean, deviation) = point.relmse;
    let reach = 0.5 * quantile(0.5 + 0.5 * confidence, replicates) * deviation / mean;
    let reach = if reach.is_finite() { reach } else { 0.0 };
    let error = mean.sqrt();
    let [low, high] = [-reach, reach].map(|r| error * r.exp());
    Checkpoint { samples: point.samples as f64, seconds: point.seconds, error, low, high }
}

/// Of Student's distribution; of the normal one where the number of replicates is not known.
fn quantile(p: f64, replicates: usize) -> f64 {
    match StudentsT::new(0.0, 1.0, replicates as f64 - 1.0) {
        Ok(student) if replicates > 1 => student.inverse_cdf(p),
        _ => Normal::standard().inverse_cdf(p),
    }
}
