//! Scrambled Sobol' (0,2)-sequences, one for each pair of dimensions.

use glam::{UVec2, Vec2};

use super::Sampler;
use super::hash::{dimension_key, mix, pixel_key, scramble, scramble_reversed};
use crate::math::float::unit_f32;

/// Padded, Owen-scrambled Sobol' points.
///
/// Every 2ᵏ consecutive samples (from a multiple of 2ᵏ) put one point into each of the 2ᵏ boxes of
/// every shape 2⁻ᵃ × 2⁻ᵇ, a + b = k, and 1-D numbers one into each of 2ᵏ intervals. The index is scrambled for each pair of
/// dimensions, so that different pairs are not correlated.
///
/// Source: Sobol' (1967); Kollig and Keller, *Efficient Multidimensional Sampling* (2002); Burley,
/// *Practical Hash-based Owen Scrambling* (2020). Tests: elementary intervals, no correlation of dimensions, chi².
pub struct Sobol {
    seed: u64,
    key: u64,
    /// Sample index with reversed bits, so that the first digit is the lowest bit.
    reversed: u32,
    dimension: u32,
}

impl Sobol {
    /// A sampler with the given seed.
    pub fn new(seed: u64) -> Sobol {
        Sobol { seed, key: pixel_key(seed, UVec2::ZERO), reversed: 0, dimension: 0 }
    }

    /// Key of the current dimension's scrambling, and the scrambled sample index with reversed bits.
    #[inline]
    fn place(&mut self, consumed: u32) -> (u64, u32) {
        let key = dimension_key(self.key, self.dimension);
        self.dimension = self.dimension.wrapping_add(consumed);
        // Owen scrambling of the index keeps aligned blocks of 2ᵏ samples together.
        (key, scramble_reversed(self.reversed, key))
    }
}

impl Sampler for Sobol {
    fn start(&mut self, pixel: UVec2, index: u64) {
        // After 2³² samples the sequence starts again with another scrambling.
        self.key = mix(pixel_key(self.seed, pixel) ^ (index >> 32));
        self.reversed = (index as u32).reverse_bits();
        self.dimension = 0;
    }

    fn at(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    fn next_1d(&mut self) -> f32 {
        let (key, place) = self.place(1);
        unit_f32(scramble(place, mix(key)))
    }

    fn next_2d(&mut self) -> Vec2 {
        let (key, place) = self.place(2);
        let key_x = mix(key);
        Vec2::new(unit_f32(scramble(place, key_x)), unit_f32(scramble(pascal(place), mix(key_x))))
    }
}

/// Second Sobol' dimension, computed from the first, which is the index with reversed bits.
///
/// y_j = ⊕ₖ C(k, j) x_k mod 2 = ⊕ { x_k : the bits of k contain those of j },    digits counted from the highest
///
/// There is one step for each bit of j and k, because Lucas' theorem makes the binomial a product over bits.
#[inline]
fn pascal(x: u32) -> u32 {
    let x = x ^ ((x << 1) & 0xaaaa_aaaa);
    let x = x ^ ((x << 2) & 0xcccc_cccc);
    let x = x ^ ((x << 4) & 0xf0f0_f0f0);
    let x = x ^ ((x << 8) & 0xff00_ff00);
    x ^ ((x << 16) & 0xffff_0000)
}
