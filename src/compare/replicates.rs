//! Numbers of each replicate of a method.

use super::Measurement;
use crate::measure::Replicates;

/// Takes a number of each replicate; `None` if one of the replicates has no such number.
pub fn replicates(measurements: &[Measurement], value: impl Fn(&[&Measurement]) -> Option<f64>) -> Option<Replicates> {
    let count = measurements.iter().map(|m| m.replicate + 1).max()?;
    let one = |r: u32| value(&measurements.iter().filter(|m| m.replicate == r).collect::<Vec<_>>());
    let values: Vec<f64> = (0..count).map(one).collect::<Option<_>>()?;
    Some(Replicates::new(&values))
}
