//! Scrambled Halton sequence.

use glam::{UVec2, Vec2};

use super::hash::{absorb, dimension_key, mix, permute, pixel_key, scramble, within_cell};
use super::{SampleKey, Sampler};
use crate::math::float::unit_f32;

/// The Halton sequence with Owen-scrambled digits.
///
/// i = Σ dₖ bᵏ  ↦  Σ π(dₖ) b⁻ᵏ⁻¹,    b: prime of the dimension, π: random permutation that depends on the previous digits
///
/// Every b₁ᵏ¹ b₂ᵏ² … consecutive samples put one point into each box of the grid with that many cells per dimension. The scrambling
/// is keyed by (seed, pixel, dimension), so that pixels are independent and high dimensions are not correlated. Digits beyond
/// 2²⁰ cells are random, and so are dimensions beyond 1024.
///
/// Source: Halton (1960); Owen, *A randomized Halton algorithm in R* (2017).
/// Tests: boxes of prime powers evenly filled, no correlation of dimensions, chi².
pub struct Halton {
    /// Seed of the scrambling.
    pub seed: u64,
}

/// Number of dimensions with a prime of their own, enough for 127 path vertices.
const DIMENSIONS: usize = 1024;

/// Greatest number of cells that digits distinguish. Each cell still contains 16 of the 2²⁴ uniform numbers.
const RESOLUTION: u32 = 1 << 20;

static PRIMES: [u32; DIMENSIONS] = primes();

impl Sampler for Halton {
    fn key(&self, pixel: UVec2, index: u64) -> SampleKey {
        SampleKey { hash: pixel_key(self.seed, pixel), index }
    }

    // Not inlined among the other samplers, whose registers it would take.
    #[inline(never)]
    fn get_1d(&self, SampleKey { hash, index }: SampleKey, dimension: u32) -> f32 {
        let key = dimension_key(hash, dimension);
        match (PRIMES.get(dimension as usize), u32::try_from(index)) {
            (Some(2), Ok(index)) => unit_f32(scramble(index.reverse_bits(), key)),
            (Some(&base), _) => scrambled_radical_inverse(index, base, key),
            (None, _) => unit_f32((mix(key ^ index) >> 32) as u32),
        }
    }

    #[inline(never)]
    fn get_2d(&self, key: SampleKey, dimension: u32) -> Vec2 {
        Vec2::new(self.get_1d(key, dimension), self.get_1d(key, dimension.wrapping_add(1)))
    }
}

/// Radical inverse of `index` in `base`, each digit permuted by a permutation that depends on the previous digits.
#[inline]
fn scrambled_radical_inverse(index: u64, base: u32, key: u64) -> f32 {
    let (mut value, mut cells) = (0, 1);
    let (mut rest, mut prefix) = (index, key);
    while cells <= RESOLUTION / base {
        let digit;
        (digit, rest) = last_digit(rest, base);
        value = value * base + permute(digit, base, prefix);
        cells *= base;
        prefix = absorb(prefix, digit);
    }
    within_cell(value, cells, (mix(prefix ^ rest) >> 32) as u32)
}

/// Last digit, and the number without it. Division in 32 bits, where possible, is several times faster.
#[inline]
fn last_digit(number: u64, base: u32) -> (u32, u64) {
    match u32::try_from(number) {
        Ok(number) => (number % base, u64::from(number / base)),
        Err(_) => ((number % u64::from(base)) as u32, number / u64::from(base)),
    }
}

/// The first primes, by the sieve of Eratosthenes.
const fn primes() -> [u32; DIMENSIONS] {
    // The 1024th prime is 8161. With a smaller bound this function does not compile.
    const BOUND: usize = 8192;
    let mut composite = [false; BOUND];
    let mut primes = [0; DIMENSIONS];
    let (mut n, mut found) = (2, 0);
    while found < DIMENSIONS {
        if !composite[n] {
            primes[found] = n as u32;
            found += 1;
            let mut multiple = n * n;
            while multiple < BOUND {
                composite[multiple] = true;
                multiple += n;
            }
        }
        n += 1;
    }
    primes
}
