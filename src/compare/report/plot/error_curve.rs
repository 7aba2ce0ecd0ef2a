//! Errors of a method at its checkpoints, with intervals.
//!
//! ```text
//! error = √relMSE,   interval = error · exp(±½ t s/relMSE)
//! ```
//!
//! s is the standard error of the mean relMSE, and t Student's quantile for the number of replicates less one. The interval is one
//! of the logarithm, so that it stays positive. A relMSE at or below 0 means that the picture is as close to the truth as the
//! reference; it has no place on a logarithmic axis and is left out.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::compare::{CheckpointStats, Comparison, Method};

/// Error at one checkpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorPoint {
    /// Samples per pixel, if known.
    pub samples: Option<f64>,
    /// Render time.
    pub seconds: f64,
    /// Relative error √relMSE.
    pub error: f64,
    /// Lower end of the interval of the error.
    pub low: f64,
    /// Upper end of the interval of the error.
    pub high: f64,
}

/// Returns the errors of a method at its checkpoints.
pub fn error_curve(method: &Method, confidence: f64) -> Vec<ErrorPoint> {
    let visible = method.curve.iter().filter(|point| point.relmse.0 > 0.0 && point.seconds > 0.0);
    visible.map(|point| checkpoint(method, point, confidence)).collect()
}

/// Returns the error of a method at its last checkpoint, or why it is not told.
pub fn last_error(comparison: &Comparison, method: &Method) -> Result<ErrorPoint, &'static str> {
    if comparison.reference.error.is_some_and(|own| own.refusal().is_some()) {
        return Err("unknown, as is that of the reference");
    }
    match method.curve.last() {
        Some(last) if last.relmse.0 > 0.0 => Ok(checkpoint(method, last, comparison.confidence)),
        Some(last) if last.relmse.0 <= 0.0 => Err("below the reference's"),
        _ => Err("unknown"),
    }
}

fn checkpoint(method: &Method, point: &CheckpointStats, confidence: f64) -> ErrorPoint {
    let replicates = method.measurements.iter().filter(|m| m.samples == point.samples).count();
    let (mean, deviation) = point.relmse;
    let reach = 0.5 * quantile(0.5 + 0.5 * confidence, replicates) * deviation / mean;
    let reach = if reach.is_finite() { reach } else { 0.0 };
    let error = mean.sqrt();
    let [low, high] = [-reach, reach].map(|r| error * r.exp());
    ErrorPoint { samples: method.spp(point.samples).map(|samples| samples as f64), seconds: point.seconds, error, low, high }
}

/// Quantile of Student's distribution; of the normal distribution if the number of replicates is unknown.
pub fn quantile(p: f64, replicates: usize) -> f64 {
    match StudentsT::new(0.0, 1.0, replicates as f64 - 1.0) {
        Ok(student) if replicates > 1 => student.inverse_cdf(p),
        _ => Normal::standard().inverse_cdf(p),
    }
}
