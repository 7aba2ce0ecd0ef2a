//! What the tests share: fixed seeds, and the statistics that decide.

use proptest::test_runner::{Config, RngSeed};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Generated cases with a fixed seed: a law holds always or the test fails always.
pub fn laws(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..Config::default() }
}

/// Random numbers of the tests' own.
pub struct Random(Xoshiro256PlusPlus);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * 2f64.powi(-53)
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// A number whose logarithm is uniform.
    pub fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        self.between(from.ln(), to.ln()).exp()
    }

    /// A uniform direction.
    pub fn direction(&mut self) -> glam::DVec3 {
        let (z, phi) = (self.between(-1.0, 1.0), self.between(0.0, std::f64::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        glam::DVec3::new(r * phi.cos(), r * phi.sin(), z)
    }
}

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
