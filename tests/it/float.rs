//! Uniform numbers and elementary functions. The oracle is the platform's `f64` arithmetic.

use std::f32::consts::PI;
use std::f64;

use pt::math::float::*;
use pt::math::lanes::{Kernel, Lanes, Width, to_array};

use crate::random::Random;
use crate::statistics::ulps;

/// The tolerance is half an ulp for the last rounding, and 2⁻³³ of the result for the error of the `f64` computation before it.
const ROUNDED_ONCE: f64 = 0.501;

#[test]
fn unit_f32_has_all_multiples_of_2_to_the_minus_24_below_1_and_no_other() {
    for k in 0..1u32 << 24 {
        let exact = f64::from(k) / 16_777_216.0;
        assert_eq!(f64::from(unit_f32(k << 8)), exact);
        assert_eq!(f64::from(unit_f32(k << 8 | 0xff)), exact);
    }
    assert_eq!(unit_f32(u32::MAX), ONE_MINUS_EPSILON);
    assert_eq!(ONE_MINUS_EPSILON, 1f32.next_down());
}

#[test]
fn gamma_bounds_the_error_of_n_roundings() {
    // n ε / (1 − n ε), ε = 2⁻²⁴
    for (n, exact) in [(1, 5.96046e-8), (2, 1.192093e-7), (3, 1.788140e-7), (7, 4.172327e-7), (9, 5.364421e-7)] {
        assert!((f64::from(gamma(n)) / exact - 1.0).abs() < 1e-6, "γ({n}) = {}", gamma(n));
    }
}

#[test]
fn sin_cos_are_rounded_once_over_all_finite_numbers() {
    let mut random = Random::new(1);
    let any_bits = (0..1_000_000).map(|_| f32::from_bits(random.bits() as u32)).filter(|x| x.is_finite());
    let mut random = Random::new(2);
    let usual = (0..1_000_000).map(|_| random.range(-10.0, 10.0) as f32);
    // The f32 nearest to multiples of π/2, where the range reduction loses most digits.
    let near_zeros = (1..100_000).map(|k| (f64::from(k) * f64::consts::FRAC_PI_2) as f32);
    for x in any_bits.chain(usual).chain(near_zeros) {
        let (sin, cos) = sin_cos(x);
        assert!(ulps(sin, f64::from(x).sin()) <= ROUNDED_ONCE, "sin {x:e} = {sin:e}");
        assert!(ulps(cos, f64::from(x).cos()) <= ROUNDED_ONCE, "cos {x:e} = {cos:e}");
        assert_eq!((sin_cos(-x).0.to_bits(), sin_cos(-x).1), ((-sin).to_bits(), cos), "odd and even at {x:e}");
        assert_eq!((self::sin(x), self::cos(x)), (sin, cos));
    }
    assert_eq!(sin_cos(0.0), (0.0, 1.0));
    for x in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        assert!(sin_cos(x).0.is_nan() && sin_cos(x).1.is_nan());
    }
}

/// The oracle: erf x = 2/√π Σ (−1)ⁿ x²ⁿ⁺¹ / (n! (2n + 1)) below 3, where it loses 4 digits of 16; the continued fraction
/// erfc x = e^(−x²)/√π · 1/(x + ½/(x + 1/(x + 3/2/(x + …)))) above 2, where 100 levels give all digits.
#[test]
fn erfc_within_an_ulp() {
    let series = |x: f64| {
        let (mut term, mut sum) = (x, x);
        for n in 1..100 {
            term *= -x * x / f64::from(n);
            sum += term / f64::from(2 * n + 1);
        }
        1.0 - sum * 2.0 / f64::consts::PI.sqrt()
    };
    let fraction = |x: f64| (-x * x).exp() / f64::consts::PI.sqrt() / (1..100).rev().fold(x, |rest, n| x + 0.5 * f64::from(n) / rest);
    for k in -20_000..93_000 {
        let x = k as f32 * 1e-4;
        let exact = if x < 2.0 { series(f64::from(x)) } else { fraction(f64::from(x)) };
        assert!(ulps(erfc(x), exact) <= 0.55, "erfc {x} = {} but {exact}", erfc(x));
    }
    assert_eq!((erfc(0.0), erfc(f32::INFINITY), erfc(f32::NEG_INFINITY)), (1.0, 0.0, 2.0));
}

#[test]
fn the_two_reductions_of_angles_meet() {
    // Angles on both sides of the switch between the two range reductions, and where the integers of the second no longer hold all bits.
    for around in [8192f32, 33_554_432.0] {
        for offset in -10_000..10_000 {
            let x = f32::from_bits(around.to_bits().wrapping_add_signed(offset));
            assert!(ulps(sin(x), f64::from(x).sin()) <= ROUNDED_ONCE, "{x}");
            assert!(ulps(cos(x), f64::from(x).cos()) <= ROUNDED_ONCE, "{x}");
        }
    }
}

#[test]
fn degrees_are_exact_at_quarter_turns_and_2_ulp_elsewhere() {
    for quarter in -40..40i32 {
        let exact = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarter.rem_euclid(4) as usize];
        assert_eq!(sin_cos_degrees(90.0 * f64::from(quarter)), exact, "{quarter} quarter turns");
    }
    let mut random = Random::new(3);
    for _ in 0..100_000 {
        let degrees = random.range(-720.0, 720.0);
        let (sin, cos) = sin_cos_degrees(degrees);
        // The conversion of degrees to radians rounds π/180 and the product: 2⁻⁵² of an angle up to 4π.
        let (exact_sin, exact_cos) = degrees.to_radians().sin_cos();
        assert!((sin - exact_sin).abs() < 1e-14 && (cos - exact_cos).abs() < 1e-14, "{degrees}°");
        assert!((sin * sin + cos * cos - 1.0).abs() < 4.0 * f64::EPSILON);
    }
}

#[test]
fn acos_is_rounded_once_and_takes_rounded_cosines() {
    let mut random = Random::new(4);
    for _ in 0..1_000_000 {
        let x = random.range(-1.0, 1.0) as f32;
        assert!(ulps(acos(x), f64::from(x).acos()) <= ROUNDED_ONCE, "acos {x:e}");
        let near_one = 1.0 - random.magnitude(6e-8, 1.0) as f32;
        assert!(ulps(acos(near_one), f64::from(near_one).acos()) <= ROUNDED_ONCE, "acos {near_one:e}");
    }
    assert_eq!((acos(1.0), acos(-1.0), acos(1.000001), acos(-1.000001)), (0.0, PI, 0.0, PI));
    assert!(acos(f32::NAN).is_nan());
}

#[test]
fn atan2_is_rounded_once_in_all_octants() {
    let mut random = Random::new(5);
    for _ in 0..1_000_000 {
        let (y, x) = (f32::from_bits(random.bits() as u32), f32::from_bits(random.bits() as u32));
        let alike = x * random.range(-4.0, 4.0) as f32;
        for y in [y, alike] {
            let exact = f64::from(y).atan2(f64::from(x));
            assert!(ulps(atan2(y, x), exact) <= ROUNDED_ONCE || exact.is_nan() && atan2(y, x).is_nan(), "atan2({y:e}, {x:e})");
        }
    }
    // The values that IEEE 754 requires for zeros and infinities, with their signs.
    let special = [0.0, -0.0, 1.0, -1.0, f32::INFINITY, f32::NEG_INFINITY];
    for y in special {
        for x in special {
            let exact = f64::from(y).atan2(f64::from(x)) as f32;
            assert_eq!(atan2(y, x).to_bits(), exact.to_bits(), "atan2({y}, {x})");
        }
    }
    assert!(atan2(f32::NAN, 1.0).is_nan() && atan2(1.0, f32::NAN).is_nan() && atan2(0.0, f32::NAN).is_nan());
}

#[test]
fn exp_and_ln_are_rounded_once() {
    let mut random = Random::new(6);
    for _ in 0..1_000_000 {
        let x = random.range(-104.0, 88.7) as f32;
        assert!(ulps(exp(x), f64::from(x).exp()) <= ROUNDED_ONCE, "exp {x:e} = {:e}", exp(x));
        let x = random.magnitude(1e-45, 1.0) as f32;
        assert!(ulps(exp(-x), f64::from(-x).exp()) <= ROUNDED_ONCE, "exp {x:e}");
        let x = f32::from_bits(random.bits() as u32 >> 1);
        let near_one = random.range(0.5, 2.0) as f32;
        for x in [x, near_one].into_iter().filter(|x| x.is_finite()) {
            let exact = f64::from(x).ln();
            assert!(ln(x) as f64 == exact || ulps(ln(x), exact) <= ROUNDED_ONCE, "ln {x:e}");
        }
    }
    assert_eq!((exp(0.0), ln(1.0)), (1.0, 0.0));
    assert_eq!((exp(f32::NEG_INFINITY), exp(-104.0), exp(89.0), exp(f32::INFINITY)), (0.0, 0.0, f32::INFINITY, f32::INFINITY));
    assert_eq!((ln(0.0), ln(f32::INFINITY)), (f32::NEG_INFINITY, f32::INFINITY));
    assert!(ln(-1.0).is_nan() && ln(f32::NAN).is_nan() && exp(f32::NAN).is_nan());
}

#[test]
fn powf_is_rounded_once_with_ieee_special_cases() {
    let mut random = Random::new(7);
    for _ in 0..1_000_000 {
        let (x, y) = (random.magnitude(1e-30, 1e30) as f32, random.range(-10.0, 10.0) as f32);
        let exact = f64::from(x).powf(f64::from(y));
        let is_f32 = exact < f64::from(f32::MAX);
        assert!(if is_f32 { ulps(powf(x, y), exact) <= ROUNDED_ONCE } else { powf(x, y) >= f32::MAX }, "{x:e}^{y}");
    }
    let special = [0.0, -0.0, 0.5, 1.0, -1.0, -0.5, 2.0, -2.0, 3.0, -3.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    for x in special {
        for y in special {
            let (result, exact) = (powf(x, y), f64::from(x).powf(f64::from(y)) as f32);
            assert!(result.to_bits() == exact.to_bits() || result.is_nan() && exact.is_nan(), "{x}^{y} = {result}, not {exact}");
        }
    }
}

/// Sines, cosines, angles of points, exponential functions and logarithms of absolute values in each lane.
struct Functions([f32; 16], [f32; 16]);

impl Kernel for Functions {
    type Output = [[f32; 16]; 5];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [[f32; 16]; 5] {
        let (x, y) = (L::load(&self.0), L::load(&self.1));
        let (sin, cos) = sin_cos_lanes::<L>(x);
        let positive = L::max(L::abs(x), L::f32(f32::from_bits(1)));
        [sin, cos, atan2_lanes::<L>(y, x), exp_lanes::<L>(x), ln_lanes::<L>(positive)].map(to_array::<L>)
    }
}

/// Also near multiples of quarter turns, for both signs of 0, and near the angles where the series are exchanged.
#[test]
fn lanes_have_the_bits_of_plain_functions() {
    let mut random = Random::new(8);
    let quarters = (-12..=12).map(|k| k as f32 * PI / 4.0).flat_map(|x| [x.next_down(), x, x.next_up()]);
    let special = [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, 1e-42, 8191.9, -8191.9, 0.267_949_2, -0.267_949_2, 3.732_05];
    let mut numbers: Vec<f32> = special.into_iter().chain(quarters).collect();
    numbers.extend((0..80).map(|_| (random.decade(-6.0, 3.9) * if random.bits() & 1 == 0 { 1.0 } else { -1.0 }) as f32));
    let ends = [f32::INFINITY, f32::NEG_INFINITY];
    let pairs: Vec<[f32; 2]> = numbers.iter().flat_map(|&x| numbers.iter().chain(&ends).map(move |&y| [x, y])).collect();
    for group in pairs.chunks_exact(16) {
        let [x, y] = [0, 1].map(|axis| std::array::from_fn(|k| group[k][axis]));
        for width in Width::available() {
            let found = width.run(Functions(x, y));
            for lane in 0..width.count() {
                let (sin, cos) = sin_cos(x[lane]);
                let positive = x[lane].abs().max(f32::from_bits(1));
                let wanted = [sin, cos, atan2(y[lane], x[lane]), exp(x[lane]), ln(positive)].map(f32::to_bits);
                assert_eq!(found.map(|row| row[lane].to_bits()), wanted, "({}, {}), {width:?}", x[lane], y[lane]);
            }
        }
    }
}
