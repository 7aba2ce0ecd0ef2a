//! Statistical functions for tests.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The significance for each of `tests` tests, so that all together raise a false alarm with probability 1 %.
pub fn sidak(tests: usize) -> f64 {
    1.0 - 0.99f64.powf(1.0 / tests as f64)
}

/// The probability of counts at least as far from equal as these, if all cells are equally likely.
pub fn uniformity(counts: &[u64]) -> f64 {
    let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
    assert!(expected >= 5.0, "chi² needs 5 per cell");
    let statistic: f64 = counts.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
    ChiSquared::new(counts.len() as f64 - 1.0).expect("at least two cells").sf(statistic)
}

/// The distance of a result from the exact value, in units of the last place of an `f32` there.
pub fn ulps(result: f32, exact: f64) -> f64 {
    let exponent = if exact == 0.0 { -126 } else { exact.abs().log2().floor().max(-126.0) as i32 };
    (f64::from(result) - exact).abs() / 2f64.powi(exponent - 23)
}
