//! The (0,2)-sequence of Sobol', scrambled, one for each pair of dimensions.

use glam::{UVec2, Vec2};

use super::Sampler;
use super::hash::{dimension_key, mix, pixel_key, scramble, scramble_reversed};
use crate::math::float::unit_f32;

/// Padded, Owen-scrambled Sobol' points.
///
/// Every 2ᵏ consecutive samples (from a multiple of 2ᵏ) put one point into each of the 2ᵏ boxes of
/// every shape 2⁻ᵃ × 2⁻ᵇ, a + b = k; 1-D numbers one into each of 2ᵏ intervals. Each pair has an
/// order of its own, by scrambling the index, so that pairs do not move in step.
///
/// Source: Sobol' (1967); Kollig and Keller, *Efficient Multidimensional Sampling* (2002); Burley,
/// *Practical Hash-based Owen Scrambling* (2020). Tests: elementary intervals, no correlation of dimensions, chi².
pub struct Sobol {
    seed: u64,
    key: u64,
    /// The sample index, bits reversed: the first digit is the lowest of them.
    reversed: u32,
    dimension: u32,
}

impl Sobol {
    pub fn new(seed: u64) -> Sobol {
        Sobol { seed, key: pixel_key(seed, UVec2::ZERO), reversed: 0, dimension: 0 }
    }

    /// The key of this dimension's scrambling, and the sample's place in this dimension's order, bits reversed.
    #[inline]
    fn place(&mut self, consumed: u32) -> (u64, u32) {
        let key = dimension_key(self.key, self.dimension);
        self.dimension = self.dimension.wrapping_add(consumed);
        // The index is scrambled from its highest bit down, so that aligned blocks of 2ᵏ samples stay together.
        (key, scramble_reversed(self.reversed, key))
    }
}

impl Sampler for Sobol {
    fn start(&mut self, pixel: UVec2, index: u64) {
        // Every 2³² samples the sequence begins anew with another scrambling.
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

/// The second Sobol' dimension from the first, which is the index with its bits reversed.
///
/// y_j = ⊕ₖ C(k, j) x_k mod 2 = ⊕ { x_k : the bits of k contain those of j },    digits from the highest
///
/// One step for each bit of j and k (Lucas' theorem makes the binomial a product over bits).
#[inline]
fn pascal(x: u32) -> u32 {
    let x = x ^ ((x << 1) & 0xaaaa_aaaa);
    let x = x ^ ((x << 2) & 0xcccc_cccc);
    let x = x ^ ((x << 4) & 0xf0f0_f0f0);
    let x = x ^ ((x << 8) & 0xff00_ff00);
    x ^ ((x << 16) & 0xffff_0000)
}
