//! Scrambled Sobol' sequences of up to three dimensions.

use glam::{UVec2, Vec2};

use super::hash::{dimension_key, mix, pixel_key, scramble, scramble_reversed};
use super::{SampleKey, Sampler};
use crate::math::float::unit_f32;

/// Padded, Owen-scrambled Sobol' points.
///
/// Every 2ᵏ consecutive samples (from a multiple of 2ᵏ) put one point into each of the 2ᵏ boxes of every shape 2⁻ᵃ × 2⁻ᵇ, a + b = k, and
/// 1-D numbers one into each of 2ᵏ intervals. A choice and the pair that belongs to it put one point into each box of 4⁻ᶜ for
/// the choice and 2⁻ᵃ × 2⁻ᵇ for the pair, a + b + 2c = k. The index is scrambled for each use, so that different uses are not correlated.
///
/// The digits of the index are the coefficients of a polynomial over the integers modulo 2. The digits of the dimensions are those of the
/// polynomial in powers of x, of x + 1 and of x² + x + 1. Because these have no factors in common, the digits of the lowest powers in all
/// three determine one polynomial of a lower degree than their number (Chinese remainder theorem): that is one sample for each box.
///
/// Source: Sobol' (1967); Niederreiter, *Low-discrepancy and low-dispersion sequences* (1988); Kollig and Keller, *Efficient
/// Multidimensional Sampling* (2002); Burley, *Practical Hash-based Owen Scrambling* (2020). Tests: elementary intervals, no correlation
/// of dimensions, chi².
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
        pair(place, mix(key), mix(mix(key)))
    }

    /// The first number is that of the third dimension, so that the pair is as even as that of [`get_2d`](Sampler::get_2d).
    #[inline]
    fn get_3d(&self, key: SampleKey, dimension: u32) -> (f32, Vec2) {
        let (key, place) = scrambled_index(key, dimension);
        let key_x = mix(key);
        let key_y = mix(key_x);
        (unit_f32(scramble(third_dimension(place), mix(key_y))), pair(place, key_x, key_y))
    }
}

/// The first two dimensions at a scrambled index with reversed bits.
#[inline]
fn pair(place: u32, key_x: u64, key_y: u64) -> Vec2 {
    Vec2::new(unit_f32(scramble(place, key_x)), unit_f32(scramble(second_dimension(place), key_y)))
}

/// Key of a dimension's scrambling, and the scrambled index of the sample with reversed bits.
#[inline]
fn scrambled_index(SampleKey { hash, index }: SampleKey, dimension: u32) -> (u64, u32) {
    let key = dimension_key(hash, dimension);
    // Owen scrambling of the index keeps aligned blocks of 2ᵏ samples together.
    (key, scramble_reversed(index as u32, key))
}

/// Digits of a polynomial in powers of x + 1. The highest bit of the argument and of the result belongs to the power 0.
///
/// y_j = ⊕ₖ C(k, j) x_k mod 2 = ⊕ { x_k : the bits of k contain those of j }
///
/// There is one step for each bit of j and k, because Lucas' theorem makes the binomial a product over bits.
#[inline]
fn second_dimension(x: u32) -> u32 {
    let x = x ^ ((x << 1) & 0xaaaa_aaaa);
    let x = x ^ ((x << 2) & 0xcccc_cccc);
    let x = x ^ ((x << 4) & 0xf0f0_f0f0);
    let x = x ^ ((x << 8) & 0xff00_ff00);
    x ^ ((x << 16) & 0xffff_0000)
}

/// Digits of a polynomial in powers of p = x² + x + 1, two bits each. The highest bits of the argument and of the result belong to the
/// power 0.
///
/// Polynomials are divided by p⁸, the quotient and the remainder by p⁴, and so on. Modulo 2, pᵐ is x²ᵐ + xᵐ + 1 for a power of two m, and
///
/// ```text
/// b₀ + b₁ xᵐ + a₀ x²ᵐ + a₁ x³ᵐ  =  (q + a₁ xᵐ) pᵐ + (b₀ + q) + (b₁ + q + a₁) xᵐ,   q = a₀ + a₁
/// ```
#[inline]
fn third_dimension(x: u32) -> u32 {
    let x = divided::<8>(x, 0x0000_ff00, 0xffff_0000, 0x00ff_0000);
    let x = divided::<4>(x, 0x00f0_00f0, 0xff00_ff00, 0x0f00_0f00);
    let x = divided::<2>(x, 0x0c0c_0c0c, 0xf0f0_f0f0, 0x3030_3030);
    divided::<1>(x, 0x2222_2222, 0xcccc_cccc, 0x4444_4444)
}

/// Remainders (upper halves) and quotients (lower halves) of polynomials with 4 `M` coefficients, which lie side by side.
///
/// - `a0`, `b`, `b1`: the bits of a₀, of b₀ and b₁, and of b₁ alone
#[inline]
fn divided<const M: u32>(x: u32, a0: u32, b: u32, b1: u32) -> u32 {
    let x = x ^ ((x << M) & a0);
    x ^ ((x << (2 * M)) & b) ^ ((x << M) & b1)
}
