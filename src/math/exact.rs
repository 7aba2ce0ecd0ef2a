//! Sums without rounding.

/// The exact sum of f32 numbers: the same in any order, however it is divided.
///
/// A finite f32 is m·2^(e − 149) with |m| < 2²⁴ and 0 ≤ e ≤ 253. The sum is kept as an integer multiple of 2⁻¹⁴⁹, in digits
/// of 32 bits, each in an i64: 2³¹ numbers fit in before digits must be carried.
///
/// Source: Kulisch, *Arithmetic Operations in Floating-Point* (1971). Tests: `exact_sums_have_no_order`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExactSum {
    /// Lowest first.
    digits: [i64; DIGITS],
}

/// 254 + 24 bits of numbers, 32 of room for sums.
const DIGITS: usize = 10;
const BITS: u32 = 32;

impl ExactSum {
    /// What is not finite has no place in a sum and is left out.
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

    /// The sum of both.
    pub fn join(&self, other: &ExactSum) -> ExactSum {
        let digits = std::array::from_fn(|i| self.digits[i] + other.digits[i]);
        ExactSum { digits }.carried()
    }

    /// All digits but the highest from 0 to 2³² − 1: one sum, one form.
    fn carried(mut self) -> ExactSum {
        for i in 0..DIGITS - 1 {
            self.digits[i + 1] += self.digits[i] >> BITS;
            self.digits[i] &= 0xffff_ffff;
        }
        self
    }

    /// Rounded.
    pub fn get(&self) -> f64 {
        // Digits of a negative number are those of a complement, whose rounding would show.
        let carried = self.clone().carried();
        if carried.digits[DIGITS - 1] < 0 {
            return -ExactSum { digits: carried.digits.map(|digit| -digit) }.get();
        }
        let value = |(i, digit): (usize, &i64)| *digit as f64 * 2f64.powi((BITS as usize * i) as i32 - 149);
        carried.digits.iter().enumerate().rev().map(value).sum()
    }
}
