//! Levels of significance that many tests share.

use statrs::distribution::{ContinuousCDF, Normal};

/// Level of each of `tests` independent tests that together have the level `alpha`.
///
/// αₛ = 1 − (1 − α)^(1/m)
///
/// - `alpha`: in (0, 1)
/// - `tests`: m, where 0 counts as 1
///
/// Source: Šidák, *Rectangular Confidence Regions* (1967). Tests: known values, one test keeps its level.
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    -((-alpha).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// Number of standard errors that a mean may deviate before one of `tests` two-sided tests refuses it.
///
/// z = Φ⁻¹(1 − αₛ/2)
///
/// Tests: known values from 5 to 6·10⁶ tests.
pub fn critical_z(alpha: f64, tests: usize) -> f64 {
    // The lower tail is used, where the level keeps all its digits.
    -Normal::standard().inverse_cdf(0.5 * sidak(alpha, tests))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_test_keeps_its_level() {
        assert!((sidak(0.01, 1) - 0.01).abs() < 1e-16);
        assert!((critical_z(0.05, 1) - 1.959_963_984_540_054).abs() < 1e-9);
    }

    /// 1 − (1 − αₛ)^m = α, even if αₛ is far below the rounding of 1.
    #[test]
    fn together_the_tests_have_the_level() {
        for tests in [2, 5, 100, 10_000, 6_220_800] {
            let together = -(tests as f64 * (-sidak(0.01, tests)).ln_1p()).exp_m1();
            assert!((together - 0.01).abs() < 1e-14, "{tests}: {together}");
        }
    }

    /// Computed with 25 digits.
    #[test]
    fn known_critical_values() {
        for (tests, z) in [(5, 3.089), (60, 3.764), (100, 3.889), (1000, 4.416), (16_384, 4.987), (65_536, 5.248), (6_220_800, 6.032)] {
            assert!((critical_z(0.01, tests) - z).abs() < 6e-4, "{tests}: {}", critical_z(0.01, tests));
        }
    }
}
