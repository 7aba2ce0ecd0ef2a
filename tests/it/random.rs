//! Generated cases, and random numbers, from fixed seeds, so that a test always passes or always fails.

use proptest::test_runner::{Config, RngSeed};

pub use pt::torture::Random;

/// Configuration of generated tests: this number of cases, the same in every run.
pub fn cases(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(0x9e37_79b9_7f4a_7c15), failure_persistence: None, ..Config::default() }
}
