//! Scrambled Sobol' (0,2)-sequences, one for each pair of dimensions.

use glam::{UVec2, Vec2};

use super::hash::{dimension_key, mix, pixel_key, scramble, scramble_reversed};
use super::{SampleKey, Sampler};
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
    /// Seed of the scrambling.
    pub seed: u64,
}

impl Sampler for Sobol {
    /// The index within the key has reversed bits, so that its first digit is the lowest bit.
    fn key(&self, pixel: UVec2, index: u64) -> SampleKey {
        // After 2³² samples the sequence starts again with another scrambling.
        let hash = mix(pixel_key(self.seed, pixel) ^ (index >> 32));
        SampleKey { hash, index: (index as u32).reverse_bits().into() }
    }

    #[inline]
    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        let (key, place) = scrambled_index(key, dimension);
        unit_f32(scramble(place, mix(key)))
    }

    #[inline]
    fn get_2d(&self, key: SampleKey, dimension: u32) -> Vec2 {
        let (key, place) = scrambled_index(key, dimension);
        let key_x = mix(key);
        Vec2::new(unit_f32(scramble(place, key_x)), unit_f32(scramble(pascal(place), mix(key_x))))
    }
}

/// Key of a dimension's scrambling, and the scrambled index of the sample with reversed bits.
#[inline]
fn scrambled_index(SampleKey { hash, index }: SampleKey, dimension: u32) -> (u64, u32) {
    let key = dimension_key(hash, dimension);
    // Owen scrambling of the index keeps aligned blocks of 2ᵏ samples together.
    (key, scramble_reversed(index as u32, key))
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
