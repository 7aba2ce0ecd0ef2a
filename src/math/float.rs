//! Floating-point numbers: uniform numbers, error bounds, and elementary functions with the same bits on all machines.
//!
//! The `sin` and `exp` of different platforms may differ in the last bit, and then two machines would render different images. The
//! functions here use only IEEE addition, multiplication, division and square root, never fused, so that their bits are the same
//! everywhere.
//!
//! All functions reduce the argument, evaluate a Taylor polynomial in `f64` (29 bits more precise than the result) and round once, so
//! that the error is at most 1 ulp, and in practice below 0.501 ulp.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, LN_2, LOG2_E, PI};

use super::f64x2::F64x2;
use super::lanes::Lanes;

/// Greatest `f32` below 1, the greatest value of a uniform number.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - 1.0 / 16_777_216.0;

/// Greatest relative error of one rounding, 2⁻²⁴: half the distance from 1 to the next `f32`.
pub const ROUNDING: f32 = f32::EPSILON / 2.0;

/// Uniform number from random bits.
///
/// u = ⌊bits / 2⁸⌋ · 2⁻²⁴,    in [0, 1 − 2⁻²⁴]
///
/// Only the upper 24 bits are used, because all 32 would round to 1.0 for 128 inputs.
///
/// Tests: exhaustive over all 2²⁴ results.
#[inline]
pub const fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Bound of the relative error of `n` consecutive roundings.
///
/// γₙ = n ε / (1 − n ε),    ε = 2⁻²⁴
///
/// - `n`: number of operations, below 2²⁴
///
/// Source: Higham, *Accuracy and Stability of Numerical Algorithms* (2002), lemma 3.1.
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let error = n as f32 * ROUNDING;
    error / (1.0 - error)
}

/// Sine and cosine of an angle in radians.
///
/// x = q·π/2 + r, |r| ≤ π/4;    the Taylor series of sin r and cos r are exchanged and signed by q mod 4
///
/// Infinite and NaN angles give NaN. The reduction of every finite `f32` is precise enough for 1 ulp.
///
/// Tests: within 1 ulp, sin² + cos² = 1, odd and even, exact at 0.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let (quadrant, r) = if x.abs() < REDUCE_BY_SUBTRACTION { reduce(x) } else { reduce_large(x) };
    let (sin, cos) = series(r);
    let (sin, cos) = turn(quadrant, sin, cos);
    (sin as f32, cos as f32)
}

/// Sine and cosine of an angle within ±π/4, with the same bits as [`sin_cos`].
///
/// Tests: sin_cos_are_rounded_once_over_all_finite_numbers.
#[inline]
pub fn sin_cos_octant(x: f32) -> (f32, f32) {
    let (sin, cos) = series(f64::from(x));
    (sin as f32, cos as f32)
}

/// [`sin_cos_octant`] in each lane.
#[inline(always)]
pub fn sin_cos_octant_lanes<L: Lanes>(x: L::F32) -> (L::F32, L::F32) {
    let r = L::widen(x);
    let square = r * r;
    let (sin, cos) = (polynomial_lanes::<L, 0>(square), polynomial_lanes::<L, 1>(square));
    (L::narrow(r + r * square * sin), L::narrow(L::f64(1.0) + square * cos))
}

/// [`sin_cos`] in each lane, of angles whose size is below 8192.
///
/// Tests: lanes_have_the_bits_of_plain_functions.
#[inline(always)]
pub fn sin_cos_lanes<L: Lanes>(x: L::F32) -> (L::F32, L::F32) {
    let x = L::widen(x);
    let quadrant = round_lanes::<L>(x * L::f64(std::f64::consts::FRAC_2_PI));
    let r = (x - quadrant * L::f64(FRAC_PI_2_HIGH)) - quadrant * L::f64(FRAC_PI_2_LOW);
    let square = r * r;
    let sin = r + r * square * polynomial_lanes::<L, 0>(square);
    let cos = L::f64(1.0) + square * polynomial_lanes::<L, 1>(square);
    let (sin, cos) = turn_lanes::<L>(quadrant, sin, cos);
    (L::narrow(sin), L::narrow(cos))
}

/// [`turn`] in each lane.
#[inline(always)]
fn turn_lanes<L: Lanes>(quadrant: L::F64, sin: L::F64, cos: L::F64) -> (L::F64, L::F64) {
    // Modulo 4, from −2 to 2.
    let quadrant = quadrant - L::f64(4.0) * round_lanes::<L>(quadrant * L::f64(0.25));
    let size = L::abs_f64(quadrant);
    let is_odd = L::lt_f64(L::f64(0.5), size) & L::lt_f64(size, L::f64(1.5));
    let (sin, cos) = (L::select_f64(is_odd, cos, sin), L::select_f64(is_odd, sin, cos));
    let flips_sin = L::lt_f64(quadrant, L::f64(-0.5)) | L::lt_f64(L::f64(1.5), quadrant);
    let flips_cos = L::lt_f64(quadrant, L::f64(-1.5)) | L::lt_f64(L::f64(0.5), quadrant);
    (L::select_f64(flips_sin, -sin, sin), L::select_f64(flips_cos, -cos, cos))
}

/// Polynomial `K` of [`polynomial_pair`] in each lane, for the sine or the cosine.
#[inline(always)]
fn polynomial_lanes<L: Lanes, const K: usize>(x: L::F64) -> L::F64 {
    let c = const { [SIN_COS_14[0][K], SIN_COS_14[1][K], SIN_COS_14[2][K], SIN_COS_14[3][K], SIN_COS_14[4][K], SIN_COS_14[5][K]] };
    let (low, middle, high) = (L::f64(c[0]) + L::f64(c[1]) * x, L::f64(c[2]) + L::f64(c[3]) * x, L::f64(c[4]) + L::f64(c[5]) * x);
    let square = x * x;
    low + square * (middle + square * high)
}

/// Taylor series of sin r and cos r for |r| ≤ π/4.
#[inline]
fn series(r: f64) -> (f64, f64) {
    let square = r * r;
    let [sin, cos] = polynomial_pair(square, SIN_COS_14);
    (r + r * square * sin, 1.0 + square * cos)
}

/// Sine of an angle in radians; see [`sin_cos`].
#[inline]
pub fn sin(x: f32) -> f32 {
    sin_cos(x).0
}

/// Cosine of an angle in radians; see [`sin_cos`].
#[inline]
pub fn cos(x: f32) -> f32 {
    sin_cos(x).1
}

/// Sine and cosine in double precision of an angle within ±2π, with an absolute error below 10⁻¹⁵.
#[inline]
pub(crate) fn sin_cos_f64(x: f64) -> (f64, f64) {
    let quadrant = round(x * std::f64::consts::FRAC_2_PI);
    let r = (x - quadrant * FRAC_PI_2_HIGH) - quadrant * FRAC_PI_2_LOW;
    let square = r * r;
    turn(quadrant as i32, r * horner(square, SIN_16), horner(square, COS_18))
}

/// [`sin_cos_f64`] in each lane.
///
/// Tests: double_precision_in_lanes_has_the_bits_of_plain_functions.
#[inline(always)]
pub(crate) fn sin_cos_f64_lanes<L: Lanes>(x: L::F64) -> (L::F64, L::F64) {
    let quadrant = round_lanes::<L>(x * L::f64(std::f64::consts::FRAC_2_PI));
    let r = (x - quadrant * L::f64(FRAC_PI_2_HIGH)) - quadrant * L::f64(FRAC_PI_2_LOW);
    let square = r * r;
    turn_lanes::<L>(quadrant, r * horner_lanes::<L, _>(square, SIN_16), horner_lanes::<L, _>(square, COS_18))
}

/// Sine and cosine of an angle in degrees, in double precision.
///
/// Multiples of 90° give exactly −1, 0 and 1, because the reduction by quarter turns has no rounding.
///
/// Tests: exact quarter turns, within 2 ulp.
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let within_turn = degrees % 360.0;
    let quadrant = (within_turn / 90.0).round();
    let r = (within_turn - quadrant * 90.0) * (PI / 180.0);
    let square = r * r;
    turn(quadrant as i32, r * horner(square, SIN_16), horner(square, COS_18))
}

/// Arc cosine of `x`, in [0, π].
///
/// acos x = 2 atan(√(1 − x) / √(1 + x))
///
/// - `x` is clamped to [−1, 1], because computed cosines have rounding errors
/// - the result is accurate relative to its size also near 1, where 1 − x is exact
///
/// Tests: within 1 ulp, inverse of `cos`.
#[inline]
pub fn acos(x: f32) -> f32 {
    acos_f64(x.into()) as f32
}

/// Arc cosine of a cosine in double precision, for narrow cones whose cosines f32 rounds to 1. The relative error is below 10⁻¹¹ for an
/// exact cosine.
///
/// Tests: narrow cones fall off in the angle.
#[inline]
pub fn acos_f64(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    2.0 * angle_below_quarter_turn((1.0 - x).sqrt(), (1.0 + x).sqrt())
}

/// Angle of the point (x, y), in [−π, π].
///
/// Zeros and infinities are treated as in IEEE 754: atan2(±0, −1) = ±π, atan2(±0, 1) = ±0
///
/// Tests: within 1 ulp, all eight octants, all signed zeros and infinities.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    atan2_f64(y.into(), x.into()) as f32
}

/// [`atan2`] in each lane, of numbers that are not NaN and not both infinite.
///
/// Tests: lanes_have_the_bits_of_plain_functions.
#[inline(always)]
pub fn atan2_lanes<L: Lanes>(y: L::F32, x: L::F32) -> L::F32 {
    let zero = L::f64(0.0);
    let (along, across) = (L::widen(L::abs(x)), L::widen(L::abs(y)));
    let is_zero = !(L::lt_f64(zero, along) | L::lt_f64(zero, across));
    let angle = L::select_f64(is_zero, zero, angle_below_quarter_turn_lanes::<L>(across, along));
    let is_left = L::lt(L::copysign(L::f32(1.0), x), L::f32(0.0));
    let angle = L::select_f64(is_left, L::f64(PI) - angle, angle);
    L::copysign(L::narrow(angle), y)
}

/// Angle of the point (x, y) in double precision, with a relative error below 10⁻¹¹.
#[inline]
pub(crate) fn atan2_f64(y: f64, x: f64) -> f64 {
    let (mut along, mut across) = (x.abs(), y.abs());
    if along.is_infinite() && across.is_infinite() {
        (along, across) = (1.0, 1.0);
    }
    let angle = if across == 0.0 && along == 0.0 { 0.0 } else { angle_below_quarter_turn(across, along) };
    let angle = if x.is_sign_negative() { PI - angle } else { angle };
    angle.copysign(y)
}

/// [`atan2_f64`] in each lane, of finite numbers. Zeros count as positive.
///
/// Tests: double_precision_in_lanes_has_the_bits_of_plain_functions.
#[inline(always)]
pub(crate) fn atan2_f64_lanes<L: Lanes>(y: L::F64, x: L::F64) -> L::F64 {
    let zero = L::f64(0.0);
    let (along, across) = (L::abs_f64(x), L::abs_f64(y));
    let is_zero = !(L::lt_f64(zero, along) | L::lt_f64(zero, across));
    let angle = L::select_f64(is_zero, zero, angle_below_quarter_turn_lanes::<L>(across, along));
    let angle = L::select_f64(L::lt_f64(x, zero), L::f64(PI) - angle, angle);
    L::select_f64(L::lt_f64(y, zero), -angle, angle)
}

/// Exponential function eˣ.
///
/// x = k ln 2 + r, |r| ≤ ½ ln 2;    eˣ = 2ᵏ (1 + r + r²/2! + …)
///
/// Tests: within 1 ulp including subnormal results; infinite above 88.72, 0 below −103.98.
#[inline]
pub fn exp(x: f32) -> f32 {
    exp_f64(f64::from(x)) as f32
}

/// [`exp`] in each lane, of numbers that are not NaN.
///
/// Tests: lanes_have_the_bits_of_plain_functions.
#[inline(always)]
pub fn exp_lanes<L: Lanes>(x: L::F32) -> L::F32 {
    L::narrow(exp_f64_lanes::<L>(L::widen(x)))
}

/// Natural logarithm.
///
/// x = 2ᵏ m, m ∈ [√½, √2);    ln x = k ln 2 + 2 (s + s³/3 + s⁵/5 + …),    s = (m − 1)/(m + 1)
///
/// ln 0 = −∞, and the result is NaN for negative `x`.
///
/// Tests: within 1 ulp including subnormal arguments, inverse of `exp`.
#[inline]
pub fn ln(x: f32) -> f32 {
    ln_f64(f64::from(x)) as f32
}

/// [`ln`] in each lane, of positive finite numbers.
///
/// Tests: lanes_have_the_bits_of_plain_functions.
#[inline(always)]
pub fn ln_lanes<L: Lanes>(x: L::F32) -> L::F32 {
    let bits = L::bits_f64(L::widen(x));
    let shifted = bits + L::u64(1.0f64.to_bits() - std::f64::consts::FRAC_1_SQRT_2.to_bits());
    // 2⁵² + an exponent below 2¹¹, exactly.
    let exponent = L::from_bits_f64(L::shr_u64::<52>(shifted) | L::u64(TWO_TO_52.to_bits()));
    let k = exponent - L::f64(TWO_TO_52 + 1023.0);
    let m = L::from_bits_f64((shifted & L::u64(TWO_TO_52 as u64 - 1)) + L::u64(std::f64::consts::FRAC_1_SQRT_2.to_bits()));
    let one = L::f64(1.0);
    let s = (m - one) / (m + one);
    L::narrow(k * L::f64(LN_2) + L::f64(2.0) * s * horner_lanes::<L, _>(s * s, ATANH_16))
}

/// Power xʸ = e^(y ln x).
///
/// Special cases are treated as in IEEE 754: x⁰ = 1ʸ = 1 always, and a negative `x` requires an integer `y`.
///
/// Tests: within 1 ulp, special cases.
#[inline]
pub fn powf(x: f32, y: f32) -> f32 {
    if x == 1.0 || y == 0.0 {
        return 1.0;
    }
    let log = ln_f64(f64::from(x).abs());
    let magnitude = if log == 0.0 && !y.is_nan() { 1.0 } else { exp_f64(f64::from(y) * log) as f32 };
    if x.is_sign_positive() || x.is_nan() {
        return magnitude;
    }
    let half = f64::from(y) / 2.0;
    let is_integer = y.is_infinite() || y.trunc() == y;
    let is_odd = is_integer && half.is_finite() && half.trunc() != half;
    match (is_integer || x == 0.0 || x.is_infinite(), is_odd) {
        (true, true) => -magnitude,
        (true, false) => magnitude,
        (false, _) => f32::NAN,
    }
}

/// Complementary error function 1 − erf x, and e^(−x²), for x ≥ 0.
///
/// erfc x = 2/√π ∫ₓ^∞ e^(−t²) dt = e^(−x²) t P(t),    t = 1/(1 + x/2)
///
/// - P: polynomial that interpolates e^(x²) erfc(x)/t at the Chebyshev points of t ∈ [0, 1], with a relative error below 2·10⁻⁹
/// - the result is accurate relative to its size also in the tail; x = ∞ gives 0 and 0
///
/// Tests: erfc_within_an_ulp.
#[inline]
pub(crate) fn erfc_and_gaussian(x: f64) -> (f64, f64) {
    let gaussian = if x < 12.0 { exp_f64(-x * x) } else { 0.0 };
    let t = 1.0 / (1.0 + 0.5 * x);
    (gaussian * t * horner(2.0 * t - 1.0, SCALED_ERFC), gaussian)
}

/// Complementary error function 1 − erf x.
#[inline]
pub fn erfc(x: f32) -> f32 {
    let half = erfc_and_gaussian(f64::from(x).abs()).0;
    (if x < 0.0 { 2.0 - half } else { half }) as f32
}

/// Inverse error function of `x` in (−1, 1).
///
/// The function uses polynomials in w = −ln(1 − x²), with a relative error below 2·10⁻⁷ for every x whose `f32` is not ±1.
///
/// Source: Giles, *Approximating the erfinv Function* (2010), single precision. Tests: inverse of `erfc`.
#[inline]
pub(crate) fn erf_inverse(x: f64) -> f64 {
    let w = -ln_f64((1.0 - x) * (1.0 + x));
    x * if w < 5.0 { horner(w - 2.5, ERF_INVERSE_CENTRE) } else { horner(w.sqrt() - 3.0, ERF_INVERSE_TAIL) }
}

/// Exponential function eˣ in double precision, with a relative error below 10⁻¹¹ in the range of `f32`.
#[inline]
pub(crate) fn exp_f64(x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    // Beyond these bounds the result is not a positive, finite f32.
    let x = x.clamp(-160.0, 160.0);
    let k = round(x * LOG2_E);
    let r = (x - k * LN_2_HIGH) - k * LN_2_LOW;
    let power_of_two = f64::from_bits(((1023 + k as i64) as u64) << 52);
    power_of_two * (1.0 + r * horner(r, EXP_M1_10))
}

/// [`exp_f64`] in each lane, of numbers that are not NaN.
#[inline(always)]
fn exp_f64_lanes<L: Lanes>(x: L::F64) -> L::F64 {
    let x = L::min_f64(L::max_f64(x, L::f64(-160.0)), L::f64(160.0));
    let k = round_lanes::<L>(x * L::f64(LOG2_E));
    let r = (x - k * L::f64(LN_2_HIGH)) - k * L::f64(LN_2_LOW);
    // The lowest bits of 2⁵² + 1023 + k are 1023 + k, the exponent of 2ᵏ.
    let exponent = L::bits_f64(k + L::f64(TWO_TO_52 + 1023.0));
    let power_of_two = L::from_bits_f64(L::shl_u64::<52>(exponent));
    power_of_two * (L::f64(1.0) + r * horner_lanes::<L, _>(r, EXP_M1_10))
}

/// eˣ − 1 without cancellation near 0, with the precision of [`exp_f64`].
#[inline]
pub(crate) fn exp_m1_f64(x: f64) -> f64 {
    if x.abs() < LN_2 / 2.0 { x * horner(x, EXP_M1_10) } else { exp_f64(x) - 1.0 }
}

/// [`exp_m1_f64`] in each lane, of numbers that are not NaN.
///
/// Tests: double_precision_in_lanes_has_the_bits_of_plain_functions.
#[inline(always)]
pub(crate) fn exp_m1_f64_lanes<L: Lanes>(x: L::F64) -> L::F64 {
    let is_small = L::lt_f64(L::abs_f64(x), L::f64(LN_2 / 2.0));
    L::select_f64(is_small, x * horner_lanes::<L, _>(x, EXP_M1_10), exp_f64_lanes::<L>(x) - L::f64(1.0))
}

/// Natural logarithm in double precision of a number in the range of `f32`, with a relative error below 10⁻¹³.
#[inline]
pub(crate) fn ln_f64(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x == 0.0 {
        return f64::NEG_INFINITY;
    }
    if x == f64::INFINITY {
        return x;
    }
    let bits = x.to_bits();
    // Adding the distance from √½ to 1 carries into the exponent exactly if the mantissa is at least √2.
    let shifted = bits + (1.0f64.to_bits() - std::f64::consts::FRAC_1_SQRT_2.to_bits());
    let k = (shifted >> 52) as i64 - 1023;
    let m = f64::from_bits(bits.wrapping_sub((k << 52) as u64));
    let s = (m - 1.0) / (m + 1.0);
    k as f64 * LN_2 + 2.0 * s * horner(s * s, ATANH_16)
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;
const TAN_15: f64 = 2.0 - SQRT_3;

/// atan(y / x) in [0, π/2], for non-negative numbers not both zero.
///
/// The quotient t of the smaller and the larger number is at most tan 45°. Above tan 15° it is reduced by a rotation by 30°:
/// tan(φ − 30°) = (√3 t − 1)/(√3 + t). The remaining quotient is at most tan 15°, for which the series is short.
#[inline]
fn angle_below_quarter_turn(y: f64, x: f64) -> f64 {
    let (small, large) = if y < x { (y, x) } else { (x, y) };
    let (base, t) =
        if small > TAN_15 * large { (FRAC_PI_6, (SQRT_3 * small - large) / (SQRT_3 * large + small)) } else { (0.0, small / large) };
    let angle = base + t * horner(t * t, ATAN_18);
    if y < x { angle } else { FRAC_PI_2 - angle }
}

/// [`angle_below_quarter_turn`] in each lane.
#[inline(always)]
fn angle_below_quarter_turn_lanes<L: Lanes>(y: L::F64, x: L::F64) -> L::F64 {
    let is_flat = L::lt_f64(y, x);
    let (small, large) = (L::select_f64(is_flat, y, x), L::select_f64(is_flat, x, y));
    let is_steep = L::lt_f64(L::f64(TAN_15) * large, small);
    let root = L::f64(SQRT_3);
    let numerator = L::select_f64(is_steep, root * small - large, small);
    let denominator = L::select_f64(is_steep, root * large + small, large);
    let (base, t) = (L::select_f64(is_steep, L::f64(FRAC_PI_6), L::f64(0.0)), numerator / denominator);
    let angle = base + t * horner_lanes::<L, _>(t * t, ATAN_18);
    L::select_f64(is_flat, angle, L::f64(FRAC_PI_2) - angle)
}

/// Angle below which the subtraction of multiples of π/2 in two parts is exact to 2⁻⁸⁰.
const REDUCE_BY_SUBTRACTION: f32 = 8192.0;

/// Splits an angle into the nearest multiple of a quarter turn and the remainder.
#[inline]
fn reduce(x: f32) -> (i32, f64) {
    let x = f64::from(x);
    let q = round(x * std::f64::consts::FRAC_2_PI);
    (q as i32, (x - q * FRAC_PI_2_HIGH) - q * FRAC_PI_2_LOW)
}

/// Splits a large angle into the nearest multiple of a quarter turn and the remainder, by x · 2/π mod 4 in integers with hundreds of
/// bits of 2/π.
///
/// x = m·2ᵉ; the bits of 2/π whose product with 2ᵉ is a multiple of 4 quarter turns are skipped, and the next 96 are used.
///
/// Source: Payne and Hanek, *Radian reduction for trigonometric functions* (1983).
#[cold]
fn reduce_large(x: f32) -> (i32, f64) {
    if !x.is_finite() {
        return (0, f64::NAN);
    }
    const FRACTION_BITS: u32 = 94;
    let exponent = ((x.to_bits() >> 23) & 0xff) as i32 - 150;
    let mantissa = u128::from((x.to_bits() & 0x7f_ffff) | 0x80_0000);
    let skipped = (exponent - 2).max(0) as u32;
    let window = match skipped {
        0 => TWO_OVER_PI[0],
        n => (TWO_OVER_PI[0] << n) | (TWO_OVER_PI[1] >> (128 - n)),
    } >> 32;
    let turns = ((mantissa * window) >> (2 - exponent).max(0)) & ((1 << (FRACTION_BITS + 2)) - 1);
    let quadrant = (turns + (1 << (FRACTION_BITS - 1))) >> FRACTION_BITS;
    let remainder = turns as i128 - (quadrant << FRACTION_BITS) as i128;
    let r = remainder as f64 * (1.0 / (1u128 << FRACTION_BITS) as f64) * FRAC_PI_2;
    if x < 0.0 { (-(quadrant as i32), -r) } else { (quadrant as i32, r) }
}

/// Sine and cosine after a rotation by `quadrant` quarter turns.
#[inline]
fn turn(quadrant: i32, sin: f64, cos: f64) -> (f64, f64) {
    let (sin, cos) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    // Adding zero keeps −0 for the sine of −0 but makes the others +0.
    let sign = |flip: bool, x: f64| if flip { -x } else { x };
    (sign(quadrant & 2 != 0, sin), sign((quadrant + 1) & 2 != 0, cos))
}

/// Nearest integer, ties to even, of a number below 2⁵¹. It needs no library function and has the same bits on all machines.
#[inline]
fn round(x: f64) -> f64 {
    (x + SHIFT) - SHIFT
}

/// [`round`] in each lane.
#[inline(always)]
fn round_lanes<L: Lanes>(x: L::F64) -> L::F64 {
    (x + L::f64(SHIFT)) - L::f64(SHIFT)
}

/// From this number on, the numbers of double precision are integers, up to its double all of them.
const TWO_TO_52: f64 = (1u64 << 52) as f64;

/// Near this number, the numbers of double precision are the integers.
const SHIFT: f64 = 1.5 * (1u64 << 52) as f64;

/// Polynomial c₀ + c₁ x + c₂ x² + … by Horner's method.
#[inline]
fn horner<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for i in (0..N - 1).rev() {
        sum = sum * x + coefficients[i];
    }
    sum
}

/// [`horner`] in each lane.
#[inline(always)]
fn horner_lanes<L: Lanes, const N: usize>(x: L::F64, coefficients: [f64; N]) -> L::F64 {
    let mut sum = L::f64(coefficients[N - 1]);
    for i in (0..N - 1).rev() {
        sum = sum * x + L::f64(coefficients[i]);
    }
    sum
}

/// Two polynomials evaluated together, with pairs of terms, which halves the length of the dependency chain of Horner's method.
///
/// (c₀ + c₁ x) + x² ((c₂ + c₃ x) + x² (c₄ + c₅ x))
#[inline(always)]
fn polynomial_pair(x: f64, c: [[f64; 2]; 6]) -> [f64; 2] {
    let c = c.map(F64x2::from);
    let (square, x) = (F64x2::splat(x * x), F64x2::splat(x));
    let two = |i: usize| c[i] + c[i + 1] * x;
    (two(0) + square * (two(2) + square * two(4))).into()
}

/// Upper part of π/2 with 39 bits, so that its product with a small integer is exact.
const FRAC_PI_2_HIGH: f64 = f64::from_bits(FRAC_PI_2.to_bits() & !0x3fff);
/// Lower part of π/2, including the part beyond the precision of `f64`.
const FRAC_PI_2_LOW: f64 = (FRAC_PI_2 - FRAC_PI_2_HIGH) + 6.123_233_995_736_766e-17;
/// Upper part of ln 2 with 33 bits.
const LN_2_HIGH: f64 = f64::from_bits(LN_2.to_bits() & !0xf_ffff);
/// Lower part of ln 2, including the part beyond the precision of `f64`.
const LN_2_LOW: f64 = (LN_2 - LN_2_HIGH) + 2.319_046_813_846_299_6e-17;
/// First 256 binary digits of 2/π.
const TWO_OVER_PI: [u128; 2] = [0xa2f9_836e_4e44_1529_fc27_57d1_f534_ddc0, 0xdb62_9599_3c43_9041_fe51_63ab_debb_c561];

// Taylor coefficients, named by the power of the first omitted term. The truncation errors on the intervals of use, relative to the sum:
// sin and cos 6·10⁻¹³ (for f32) and 5·10⁻¹⁷ (for f64), exp 7·10⁻¹², atanh 3·10⁻¹⁴, atan 3·10⁻¹².
const SIN_COS_14: [[f64; 2]; 6] = paired_tails(alternating_inverse_factorials(1), alternating_inverse_factorials(0));
const SIN_16: [f64; 9] = alternating_inverse_factorials(1);
const COS_18: [f64; 10] = alternating_inverse_factorials(0);
const EXP_M1_10: [f64; 9] = inverse_factorials();
const ATANH_16: [f64; 8] = odd_inverses(1.0);
const ATAN_18: [f64; 9] = odd_inverses(-1.0);

/// Coefficients of e^(x²) erfc(x)/t in powers of 2t − 1, where t = 1/(1 + x/2).
const SCALED_ERFC: [f64; 13] = [
    0.510791352761223_6,
    0.343580332970096_4,
    0.139736032661886_6,
    0.018221384245757_1,
    -0.010755116152754_6,
    -0.003241854895367_5,
    0.001544047683089_25,
    0.000427020150762249_9,
    -0.000328100147985141_5,
    -3.295153927018533e-5,
    6.768_780_689_734_52e-5,
    -1.327395517676192e-6,
    -8.508869900319126e-6,
];
/// Coefficients of the inverse error function divided by x, in powers of w − 2.5 for w = −ln(1 − x²) < 5.
const ERF_INVERSE_CENTRE: [f64; 9] = [
    1.50140941,
    0.246640727,
    -0.00417768164,
    -0.00125372503,
    0.00021858087,
    -4.39150654e-06,
    -3.5233877e-06,
    3.43273939e-07,
    2.81022636e-08,
];
/// Coefficients of the inverse error function divided by x, in powers of √w − 3 for w ≥ 5.
const ERF_INVERSE_TAIL: [f64; 9] =
    [2.83297682, 1.00167406, 0.00943887047, -0.0076224613, 0.00573950773, -0.00367342844, 0.00134934322, 0.000100950558, -0.000200214257];

/// Coefficients (−1)ⁱ / (2i + first)!, up to the factor first!.
const fn alternating_inverse_factorials<const N: usize>(first: usize) -> [f64; N] {
    let mut c = [1.0; N];
    let mut i = 1;
    while i < N {
        let n = 2 * i + first;
        c[i] = -c[i - 1] / (n * (n - 1)) as f64;
        i += 1;
    }
    c
}

/// Pairs of the coefficients of two series, without the first.
const fn paired_tails(a: [f64; 7], b: [f64; 7]) -> [[f64; 2]; 6] {
    let mut pairs = [[0.0; 2]; 6];
    let mut i = 0;
    while i < 6 {
        pairs[i] = [a[i + 1], b[i + 1]];
        i += 1;
    }
    pairs
}

/// Coefficients 1 / (i + 1)!.
const fn inverse_factorials<const N: usize>() -> [f64; N] {
    let mut c = [1.0; N];
    let mut i = 1;
    while i < N {
        c[i] = c[i - 1] / (i + 1) as f64;
        i += 1;
    }
    c
}

/// Coefficients signⁱ / (2i + 1).
const fn odd_inverses<const N: usize>(sign: f64) -> [f64; N] {
    let mut c = [1.0; N];
    let mut power = 1.0;
    let mut i = 1;
    while i < N {
        power *= sign;
        c[i] = power / (2 * i + 1) as f64;
        i += 1;
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Kernel, Width};

    /// Angle of (x, y), sine and cosine of x, and eˣ − 1, in double precision.
    struct Functions {
        x: [f64; 16],
        y: [f64; 16],
    }

    impl Kernel for Functions {
        type Output = [[f64; 16]; 4];

        #[inline(always)]
        fn run<L: Lanes>(self) -> [[f64; 16]; 4] {
            let (x, y) = (L::load_f64(&self.x), L::load_f64(&self.y));
            let ((sin, cos), mut found) = (sin_cos_f64_lanes::<L>(x), [[0.0; 16]; 4]);
            L::store_f64(atan2_f64_lanes::<L>(y, x), &mut found[0]);
            L::store_f64(sin, &mut found[1]);
            L::store_f64(cos, &mut found[2]);
            L::store_f64(exp_m1_f64_lanes::<L>(x), &mut found[3]);
            found
        }
    }

    #[test]
    fn double_precision_in_lanes_has_the_bits_of_plain_functions() {
        // All quadrants, their borders, and what is between; then numbers of all sizes. Zeros are positive.
        let angles = (-32..=32).map(|k| f64::from(k) * PI / 16.0).flat_map(|x| [x.next_down(), x, x.next_up()]);
        let sizes = [5e-324, 1e-310, 1e-45, 1e-3, 2.0 - 3f64.sqrt(), 1.0, 2.0 + 3f64.sqrt(), 1e39, 1e300];
        let numbers: Vec<f64> = angles.chain(sizes.into_iter().flat_map(|x| [x, -x])).map(|x| x + 0.0).collect();
        let pairs: Vec<[f64; 2]> = numbers.iter().flat_map(|&x| numbers.iter().map(move |&y| [x, y])).collect();
        for group in pairs.chunks(16) {
            let [x, y] = [0, 1].map(|axis| std::array::from_fn(|k| group[k % group.len()][axis]));
            for width in Width::available() {
                let [angle, sin, cos, exp_m1] = width.run(Functions { x, y });
                for k in 0..width.count() {
                    let same = |found: f64, wanted: f64| {
                        assert_eq!(found.to_bits(), wanted.to_bits(), "({:e}, {:e}): {found:e}, not {wanted:e}, {width:?}", x[k], y[k]);
                    };
                    same(angle[k], atan2_f64(y[k], x[k]));
                    same(exp_m1[k], exp_m1_f64(x[k]));
                    // Sines are for angles within ±2π.
                    if x[k].abs() <= 2.0 * PI {
                        let wanted = sin_cos_f64(x[k]);
                        same(sin[k], wanted.0);
                        same(cos[k], wanted.1);
                    }
                }
            }
        }
    }
}
