//! Random functions of integers: what makes numbers a pure function of their place.

use glam::UVec2;

/// Mixes 64 bits so that each depends on all.
///
/// Three rounds of multiply and fold; a bijection, so that different inputs never meet.
///
/// Tests: avalanche, here below.
#[inline]
pub fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(GOLDEN);
    let x = (x ^ (x >> 32)).wrapping_mul(ODD_A);
    let x = (x ^ (x >> 29)).wrapping_mul(ODD_B);
    x ^ (x >> 32)
}

/// The key of everything that happens in one pixel.
#[inline]
pub fn pixel_key(seed: u64, pixel: UVec2) -> u64 {
    mix(mix(seed) ^ (u64::from(pixel.x) | u64::from(pixel.y) << 32))
}

/// The key of one dimension under another key.
#[inline]
pub fn dimension_key(key: u64, dimension: u32) -> u64 {
    mix(key ^ u64::from(dimension))
}

/// A key made from another and a small number, in one wide multiplication: half of [`mix`] in cost.
///
/// Tests: the independence of scrambled digits.
#[inline]
pub fn absorb(key: u64, word: u32) -> u64 {
    let product = u128::from(key ^ u64::from(word).wrapping_mul(GOLDEN) ^ ODD_B) * u128::from(ODD_A);
    (product >> 64) as u64 ^ product as u64
}

/// The upper and the lower half of a key, as two random words.
#[inline]
pub fn halves(key: u64) -> (u32, u32) {
    ((key >> 32) as u32, key as u32)
}

/// A random permutation of 0 … n − 1: where `i` goes.
///
/// - `i` < `n` ≤ 2³¹; `key` chooses the permutation
///
/// Tests: bijective for every n, all orders of few elements equally likely, pairs of many even.
#[inline]
pub fn permute(i: u32, n: u32, key: u64) -> u32 {
    debug_assert!(i < n);
    if n <= MAX_SHUFFLED { shuffle(i, n, key) } else { walk(i, n, key) }
}

/// 16! < 2⁴⁵: one key holds all the choices of a shuffle, to a relative precision of 2⁻¹⁹.
const MAX_SHUFFLED: u32 = 16;

/// Follows one element through a shuffle: place k, from the last, changes with a random one of 0 … k.
///
/// Source: Fisher and Yates, *Statistical tables* (1938).
#[inline]
fn shuffle(i: u32, n: u32, key: u64) -> u32 {
    // The key as a fraction; its digits in the bases n, n − 1, … are the choices.
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

/// A bijection of the smallest power of two that holds n, walked until the value lies below n.
///
/// The walk stays on `i`'s cycle, so no two values meet. It takes less than 2 steps on average.
///
/// Source: the idea is Kensler's, *Correlated Multi-Jittered Sampling* (2013).
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

/// Nested uniform scrambling in base 2: each binary digit is flipped or not by a random function of the digits before it.
///
/// In reversed bits "the digits before" are the lower bits, and on those depends exactly what
/// sums, odd factors and x ↦ x ⊕ 2c·x give.
///
/// - `x`: a fraction, the most significant bit is the first digit
///
/// Source: Owen, *Randomly permuted (t,m,s)-nets* (1995); by a hash: Laine and Karras, *Stratified
/// sampling for stochastic transparency* (2011). Tests: elementary intervals, digits flip evenly and independently.
#[inline]
pub fn scramble(x: u32, key: u64) -> u32 {
    scramble_reversed(x.reverse_bits(), key).reverse_bits()
}

/// [`scramble`] of a number whose bits are reversed, and reversed it stays: the first digit is the least significant bit.
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

/// A uniform number within cell `cell` of the `cells` equal ones that [0, 1) is cut into.
///
/// The multiples of 2⁻²⁴ within the cell, one of them by chance: exactly inside, never 1.0.
///
/// - `cell` < `cells` ≤ 2²⁴; `random`: uniform bits
#[inline]
pub fn within_cell(cell: u32, cells: u32, random: u32) -> f32 {
    let first_at_or_above = |i: u32| (u64::from(i) << 24).div_ceil(u64::from(cells));
    let (from, to) = (first_at_or_above(cell), first_at_or_above(cell + 1));
    let place = from + ((u64::from(random) * (to - from)) >> 32);
    place as f32 * (1.0 / 16_777_216.0)
}

/// Fractional binary places of irrational numbers, odd or even as named: φ, √2, √3; √5, √7.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
const ODD_A: u64 = 0x6a09_e667_f3bc_c909;
const ODD_B: u64 = 0xbb67_ae85_84ca_a73b;
const EVEN_A: u32 = 0x3c6e_f372;
const EVEN_B: u32 = 0xa54f_f53a;

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
                // Where one goes, and how far from it the other: each of n, of n − 1 is equally likely.
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
