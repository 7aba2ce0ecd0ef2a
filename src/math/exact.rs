//! Exact sums.

use std::fmt;

/// Exact sum of f32 numbers, which does not depend on their order.
///
/// A finite f32 is m·2^(e − 149) with |m| < 2²⁴ and 0 ≤ e ≤ 253. The sum is kept as an integer multiple of 2⁻¹⁴⁹, in digits
/// of 32 bits, each in an i64, so that 2³¹ numbers can be added before digits must be carried.
///
/// Source: Kulisch, *Arithmetic Operations in Floating-Point* (1971). Tests: `exact_sums_have_no_order`.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct ExactSum {
    /// Digits, the lowest first.
    digits: [i64; DIGITS],
}

/// Writes the value of the sum, not its digits.
impl fmt::Debug for ExactSum {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_tuple("ExactSum").field(&self.get()).finish()
    }
}

/// Number of digits: 254 + 24 bits for numbers and 32 for sums.
const DIGITS: usize = 10;
/// Bits per digit.
const BITS: u32 = 32;

impl ExactSum {
    /// Adds a number. Numbers that are not finite are ignored.
    pub fn add(&mut self, x: f32) {
        if !x.is_finite() {
            return;
        }
        let bits = x.to_bits();
        let (exponent, fraction) = (bits >> 23 & 0xff, i64::from(bits & 0x7f_ffff));
        let (m, e) = if exponent == 0 { (fraction, 0) } else { (fraction | 1 << 23, exponent - 1) };
        let (digit, shifted) = ((e / BITS) as usize, m << (e % BITS));
        let sign = if x.is_sign_negative() { -1 } else { 1 };
        self.digits[digit] += sign * (shifted & 0xffff_ffff);
        self.digits[digit + 1] += sign * (shifted >> BITS);
    }

    /// Exact sum of the numbers of both sums.
    pub fn join(&self, other: &ExactSum) -> ExactSum {
        let digits = std::array::from_fn(|i| self.digits[i] + other.digits[i]);
        ExactSum { digits }.carried()
    }

    /// Carries, so that all digits but the highest are from 0 to 2³² − 1 and equal sums have equal digits.
    fn carried(mut self) -> ExactSum {
        for i in 0..DIGITS - 1 {
            self.digits[i + 1] += self.digits[i] >> BITS;
            self.digits[i] &= 0xffff_ffff;
        }
        self
    }

    /// Value of the sum with a relative error of at most 2⁻⁵².
    pub fn get(&self) -> f64 {
        // A negative number has the digits of a complement, whose rounding would lose precision.
        let carried = self.clone().carried();
        if carried.digits[DIGITS - 1] < 0 {
            return -ExactSum { digits: carried.digits.map(|digit| -digit) }.get();
        }
        let value = |(i, digit): (usize, &i64)| *digit as f64 * 2f64.powi((BITS as usize * i) as i32 - 149);
        carried.digits.iter().enumerate().rev().map(value).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::hash::mix;

    fn sum(numbers: impl IntoIterator<Item = f32>) -> ExactSum {
        let mut sum = ExactSum::default();
        numbers.into_iter().for_each(|x| sum.add(x));
        sum
    }

    /// Numbers of all sizes: in any order and any division the same digits; with their negatives nothing at all.
    #[test]
    fn exact_sums_have_no_order() {
        let numbers: Vec<f32> = (0..2000).map(|i| f32::from_bits(mix(i) as u32)).collect();
        let whole = sum(numbers.iter().copied()).join(&ExactSum::default());
        let halves = sum(numbers[700..].iter().rev().copied()).join(&sum(numbers[..700].iter().copied()));
        assert_eq!(halves, whole);
        let nothing = whole.join(&sum(numbers.iter().map(|x| -x)));
        assert_eq!((nothing.get(), nothing), (0.0, ExactSum::default()));
    }

    /// Against whole numbers of 128 bits: ±m·2^e with m ≤ 2²³, in units of 2⁻⁶⁰.
    #[test]
    fn exact_sums_are_exact() {
        let parts = |i: u64| (((mix(i) >> 40) as i64 - (1 << 23)) as f64, (mix(!i) % 60) as i32);
        let exact: i128 = (0..5000).map(parts).map(|(m, e)| (m as i128) << e).sum();
        let found = sum((0..5000).map(parts).map(|(m, e)| (m * 2f64.powi(e - 60)) as f32)).get();
        let expected = exact as f64 * 2f64.powi(-60);
        assert!((found - expected).abs() <= f64::EPSILON * expected.abs(), "{found} {expected}");
        for x in [f32::MAX, f32::MIN_POSITIVE, 1e-45, -1.5] {
            assert_eq!(sum([x]).get(), f64::from(x));
            assert_eq!(sum([x, -x]).get(), 0.0);
        }
        assert_eq!(sum([f32::NAN, f32::INFINITY]).get(), 0.0);
    }

    #[test]
    fn sums_are_shown_as_numbers() {
        assert_eq!(format!("{:?}", sum([0.5, 0.25])), "ExactSum(0.75)");
    }
}
