//! Hash functions of integers, which make random numbers a pure function of pixel, sample and dimension.

use glam::UVec2;

/// Mixes 64 bits so that each output bit depends on all input bits.
///
/// The function multiplies and xors with shifts. It is a bijection: different inputs have different outputs.
///
/// Tests: mix_flips_half_of_the_bits_for_each_bit.
#[inline]
pub fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(GOLDEN);
    let x = (x ^ (x >> 32)).wrapping_mul(ODD_A);
    let x = (x ^ (x >> 29)).wrapping_mul(ODD_B);
    x ^ (x >> 32)
}

/// Key of all numbers of a pixel.
#[inline]
pub fn pixel_key(seed: u64, pixel: UVec2) -> u64 {
    mix(mix(seed) ^ (u64::from(pixel.x) | u64::from(pixel.y) << 32))
}

/// Key of a dimension, derived from another key.
#[inline]
pub fn dimension_key(key: u64, dimension: u32) -> u64 {
    mix(key ^ u64::from(dimension))
}

/// Key derived from another key and a word by one wide multiplication, at half the cost of [`mix`].
///
/// Tests: the independence of scrambled digits.
#[inline]
pub fn absorb(key: u64, word: u32) -> u64 {
    let product = u128::from(key ^ u64::from(word).wrapping_mul(GOLDEN) ^ ODD_B) * u128::from(ODD_A);
    (product >> 64) as u64 ^ product as u64
}

/// Upper and lower half of a key, as two random words.
#[inline]
pub fn halves(key: u64) -> (u32, u32) {
    ((key >> 32) as u32, key as u32)
}

/// Image of `i` under a random permutation of 0 … n − 1.
///
/// - `i` < `n` ≤ 2³¹
/// - `key`: chooses the permutation
///
/// Tests: bijective for every n, all orders of few elements equally likely, pairs of many even.
#[inline]
pub fn permute(i: u32, n: u32, key: u64) -> u32 {
    debug_assert!(i < n);
    if n <= MAX_SHUFFLED { shuffle(i, n, key) } else { walk(i, n, key) }
}

/// Greatest n that is shuffled. Because 16! < 2⁴⁵, one key provides all choices of a shuffle with a relative precision of 2⁻¹⁹.
const MAX_SHUFFLED: u32 = 16;

/// Position of one element after a Fisher-Yates shuffle: from the last position k on, position k is swapped with a random one of 0 … k.
///
/// Source: Fisher and Yates, *Statistical tables* (1938).
#[inline]
fn shuffle(i: u32, n: u32, key: u64) -> u32 {
    // The key is used as a fraction, whose digits in the bases n, n − 1, … are the choices.
    let (mut fraction, mut i) = (key, i);
    for k in (1..n).rev() {
        let product = u128::from(fraction) * u128::from(k + 1);
        let other = (product >> 64) as u32;
        fraction = product as u64;
        if i == other {
            return k;
        }
        if i == k {
            i = other;
        }
    }
    i
}

/// Permutation by cycle walking: a bijection of 0 … 2ᵏ − 1 ≥ n − 1 is applied until the value is below n.
///
/// The walk stays on the cycle of `i`, so that different values have different images. It takes less than 2 steps on average.
///
/// Source: Kensler, *Correlated Multi-Jittered Sampling* (2013).
#[inline]
fn walk(i: u32, n: u32, key: u64) -> u32 {
    let mask = n.next_power_of_two() - 1;
    let half = mask.count_ones().div_ceil(2);
    let quarter = half / 2 + 1;
    let mut i = i;
    loop {
        // Odd factors, shifts of the upper half and sums are bijections modulo a power of two.
        let mut words = key;
        for _ in 0..5 {
            let (high, low) = halves(words);
            i = i.wrapping_add(high) & mask;
            i = i.wrapping_mul(low | 1) & mask;
            i ^= (i >> half) ^ (i >> quarter);
            words = words.rotate_left(17).wrapping_mul(ODD_A);
        }
        i = i.wrapping_add((words >> 32) as u32) & mask;
        if i < n {
            return i;
        }
    }
}

/// Owen scrambling (nested uniform scrambling) in base 2: each binary digit is flipped by a random function of the previous digits.
///
/// With reversed bits, the previous digits are the lower bits. Sums, odd factors and x ↦ x ⊕ 2c·x change each bit by a function of
/// the lower bits only.
///
/// - `x`: a fraction whose most significant bit is the first digit
///
/// Source: Owen, *Randomly permuted (t,m,s)-nets* (1995); as a hash: Laine and Karras, *Stratified
/// sampling for stochastic transparency* (2011). Tests: elementary intervals, digits flip evenly and independently.
#[inline]
pub fn scramble(x: u32, key: u64) -> u32 {
    scramble_reversed(x.reverse_bits(), key).reverse_bits()
}

/// [`scramble`] for a number with reversed bits, whose first digit is the least significant bit. The result is reversed as well.
#[inline]
pub fn scramble_reversed(x: u32, key: u64) -> u32 {
    let (a, b) = halves(key);
    let (c, d) = halves(key.wrapping_mul(ODD_B).rotate_left(32));
    let mut x = x.wrapping_add(a);
    x ^= x.wrapping_mul(EVEN_A);
    x = x.wrapping_mul(b | 1);
    x ^= x.wrapping_mul(c & !1);
    x = x.wrapping_add(d);
    x ^= x.wrapping_mul(EVEN_B);
    x.wrapping_mul(a.rotate_left(16) | 1)
}

/// Uniform number within cell `cell` of `cells` equal cells of [0, 1).
///
/// The result is a random one of the multiples of 2⁻²⁴ within the cell, never 1.0.
///
/// - `cell` < `cells` ≤ 2²⁴; `random`: uniform bits
#[inline]
pub fn within_cell(cell: u32, cells: u32, random: u32) -> f32 {
    let first_at_or_above = |i: u32| (u64::from(i) << 24).div_ceil(u64::from(cells));
    let (from, to) = (first_at_or_above(cell), first_at_or_above(cell + 1));
    let place = from + ((u64::from(random) * (to - from)) >> 32);
    place as f32 * (1.0 / 16_777_216.0)
}

// Fractional binary digits of the irrational numbers φ, √2, √3, √5 and √7, made odd or even as named.
pub(super) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
pub(super) const ODD_A: u64 = 0x6a09_e667_f3bc_c909;
pub(super) const ODD_B: u64 = 0xbb67_ae85_84ca_a73b;
pub(super) const EVEN_A: u32 = 0x3c6e_f372;
pub(super) const EVEN_B: u32 = 0xa54f_f53a;

#[cfg(test)]
mod tests {
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    use super::*;

    #[test]
    fn permutations_are_bijective() {
        for n in (1..300).chain([1000, 1024, 1025, 8161]) {
            for key in 0..10 {
                let mut places: Vec<u32> = (0..n).map(|i| permute(i, n, mix(key))).collect();
                places.sort_unstable();
                assert!(places.into_iter().eq(0..n), "{n}");
            }
        }
    }

    #[test]
    fn permutations_move_pairs_evenly() {
        for n in [3, 7, 16, 17, 23, 32, 33, 64, 101] {
            for (i, j) in [(0, 1), (0, n - 1), (1, 2), (0, n / 2), (n - 2, n - 1)] {
                // All n images of one element are equally likely, and so are all n − 1 distances of the other from it.
                let (mut places, mut distances) = (vec![0u64; n as usize], vec![0u64; n as usize - 1]);
                for key in 0..1u64 << 17 {
                    let [a, b] = [i, j].map(|i| permute(i, n, mix(key)));
                    places[a as usize] += 1;
                    distances[((b + n - a) % n) as usize - 1] += 1;
                }
                for counts in [places, distances] {
                    let expected = (1u64 << 17) as f64 / counts.len() as f64;
                    let chi2: f64 = counts.iter().map(|&c| (c as f64 - expected).powi(2) / expected).sum();
                    let p = ChiSquared::new(counts.len() as f64 - 1.0).unwrap().sf(chi2);
                    // 1 % for all 90 tests together.
                    assert!(p > 0.01 / 90.0, "{i} and {j} of {n}: p = {p}");
                }
            }
        }
    }

    #[test]
    fn mix_flips_half_of_the_bits_for_each_bit() {
        for bit in 0..64 {
            let flips: u32 = (0..4096u64).map(|i| (mix(i) ^ mix(i ^ (1 << bit))).count_ones()).sum();
            // 4096 · 64 fair coins: 5 σ = 5 · √(4096·64)/2 = 1280
            assert!((f64::from(flips) - 4096.0 * 32.0).abs() < 1280.0, "bit {bit}: {flips}");
        }
    }
}
