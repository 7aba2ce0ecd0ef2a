//! Fresnel's and Snell's laws: handbook values, identities, and the edges where formulas cancel.
//!
//! The oracle is the textbook form in `f64`, written differently from the library's.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec3, Vec3, Vec3A};
use proptest::prelude::*;
use pt::math::fresnel::{self, dielectric, reflect, refract};

use crate::random::{Random, cases};

/// One rounding to `f32` of a value up to 1: the formulas themselves are `f64`.
const ROUNDING: f64 = 6e-8;

/// Effect of the rounding of a cosine to `f32` on a reflectance: half an ulp times the slope.
fn slope_error(reflectance: impl Fn(f64) -> f64, cos: f64) -> f64 {
    let step = 1e-7 * cos.max(1e-3);
    let (above, below) = (reflectance((cos + step).min(1.0)), reflectance(cos - step));
    ROUNDING + 6e-8 * cos * (above - below).abs() / step
}

fn conductor(cos: f32, eta: f32, k: f32) -> f32 {
    fresnel::conductor(cos, Vec3A::splat(eta), Vec3A::splat(k)).x
}

/// Textbook: r_s = (cos i − n cos t)/(cos i + n cos t), r_p = (n cos i − cos t)/(n cos i + cos t).
fn textbook(cos_i: f64, n: f64) -> f64 {
    let sin2_t = (1.0 - cos_i * cos_i) / (n * n);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let r_s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let r_p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    0.5 * (r_s * r_s + r_p * r_p)
}

fn at_degrees(degrees: f64, eta: f64) -> (f64, f64) {
    let cos = degrees.to_radians().cos();
    (f64::from(dielectric(cos as f32, eta as f32)), slope_error(|c| textbook(c, eta), cos))
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected} ± {tolerance}");
}

#[test]
fn total_reflection_is_exactly_one_and_approached_continuously() {
    let critical = (1.0 / 1.5f64).asin();
    let approach = [0.10028199, 0.43957606, 0.76364119, 0.91723792, 0.97293684, 0.99134959];
    for (k, exact) in approach.into_iter().enumerate() {
        let (found, error) = at_degrees(180.0 - (critical - 10f64.powi(-1 - k as i32)).to_degrees(), 1.5);
        // The angle is off by half an ulp of its cosine, and near the critical angle the slope is infinite.
        let near = 6e-8 * 0.745 / (2.0 * 10f64.powi(-1 - k as i32));
        assert_near(found, exact, 3e-5 + 5.0 * near * (1.0 - exact) + error.min(1e-6), "approach");
    }
    let at_critical = -(critical.cos() as f32);
    for steps in -200_000..=200_000 {
        let cos = f32::from_bits(at_critical.to_bits().wrapping_add_signed(steps));
        let exact = textbook(f64::from(-cos), 1.0 / 1.5);
        let found = dielectric(cos, 1.5);
        assert_near(f64::from(found), exact, ROUNDING, "around the critical angle");
        assert_eq!(found == 1.0, exact == 1.0);
        let wo = Vec3::new((1.0 - f64::from(cos).powi(2)).sqrt() as f32, 0.0, cos);
        assert_eq!(refract(wo, 1.5).is_none(), found == 1.0);
    }
    let first_transmitted = (0..).map(|k| f32::from_bits(at_critical.to_bits() + k)).find(|&c| dielectric(c, 1.5) < 1.0).unwrap();
    // Evaluated with 40 digits at this cosine, 0.745356023311614990234375.
    assert_near(f64::from(dielectric(first_transmitted, 1.5)), 0.9981330251, ROUNDING, "first cosine beyond the critical one");
    assert_eq!((dielectric(-0.0f32.next_up(), 1.5), dielectric(-0.001, 1000.0)), (1.0, 1.0));
}

#[test]
fn nearly_equal_indices_keep_their_digits() {
    // Normal incidence: ((n − 1)/(n + 1))² of the f32 n, relative.
    for n in [1.0001f32, 1.000001, 1.0000001, 0.9999999] {
        let exact = ((f64::from(n) - 1.0) / (f64::from(n) + 1.0)).powi(2);
        assert_near(f64::from(dielectric(1.0, n)) / exact, 1.0, ROUNDING, "normal");
        assert_near(f64::from(dielectric(-1.0, n)) / exact, 1.0, ROUNDING, "normal, inside");
    }
    for (n, exact) in [(1.0001, 0.6111295666), (1.000001, 0.0146309), (1.0000001, 3.548e-4)] {
        let (found, _) = at_degrees(89.9, n);
        // The first index is not rounded in the handbook value: |dR/dn| · half an ulp = 600 · 6e-8.
        assert_near(found, exact, if n == 1.0001 { 4e-4 } else { 1e-4 * exact }, "grazing");
    }
    // The textbook's differences cancel here; taken first, q − c = (n² − 1)/(q + c), they do not.
    let mut random = Random::new(2);
    for _ in 0..100_000 {
        let n = (1.0 + random.magnitude(1e-7, 1e-2)) as f32;
        let cos = random.magnitude(1e-4, 1.0) as f32;
        let (n64, c) = (f64::from(n), f64::from(cos));
        let difference = (n64 * n64 - 1.0) / (c + (n64 * n64 - 1.0 + c * c).sqrt());
        let q = c + difference;
        let r_s = difference / (q + c);
        // r_p = −r_s (cos i cos t − sin i sin t)/(cos i cos t + sin i sin t) with cos t = q/n, sin t = sin i/n
        let sin2 = 1.0 - c * c;
        let r_p = r_s * (c * q - sin2) / (c * q + sin2);
        let exact = 0.5 * (r_s * r_s + r_p * r_p);
        assert_near(f64::from(dielectric(cos, n)) / exact, 1.0, 1e-7, "near 1");
    }
}

#[test]
fn energy_is_conserved_by_amplitudes() {
    // r² + t² n cos θt / cos θi = 1 for each polarisation, t_s = 2 cos i/(cos i + n cos t), t_p = 2 cos i/(n cos i + cos t)
    let mut random = Random::new(4);
    for _ in 0..1_000_000 {
        let (cos, eta) = (random.range(1e-3, 1.0) as f32, random.magnitude(1.0, 1e3) as f32);
        let (c, n) = (f64::from(cos), f64::from(eta));
        let cos_t = (1.0 - (1.0 - c * c) / (n * n)).sqrt();
        let (t_s, t_p) = (2.0 * c / (c + n * cos_t), 2.0 * c / (n * c + cos_t));
        let transmitted = 0.5 * (t_s * t_s + t_p * t_p) * n * cos_t / c;
        assert_near(f64::from(dielectric(cos, eta)) + transmitted, 1.0, 1e-7, "R + T");
    }
}

#[test]
fn a_conductor_follows_the_complex_fresnel_equations() {
    // r_s = (c − q)/(c + q), r_p = (N²c − q)/(N²c + q), q = √(N² − sin²θ), N = n + ik: multiplied out as complex numbers.
    type Complex = (f64, f64);
    let mul = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let abs2 = |a: Complex| a.0 * a.0 + a.1 * a.1;
    let reflectance = |a: Complex, q: Complex| abs2((a.0 - q.0, a.1 - q.1)) / abs2((a.0 + q.0, a.1 + q.1));
    let exact = |cos2: f64, n: Complex| {
        let (c, n2) = (cos2.sqrt(), mul(n, n));
        let square = (n2.0 - (1.0 - cos2), n2.1);
        let (length, angle) = (abs2(square).powf(0.25), 0.5 * square.1.atan2(square.0));
        let q = (length * angle.cos(), length * angle.sin());
        0.5 * (reflectance((c, 0.0), q) + reflectance((n2.0 * c, n2.1 * c), q))
    };
    // After the sums that cancel nine operations in f32, half an ulp of 1 each.
    let rounding = 9.0 * ROUNDING;
    let mut random = Random::new(5);
    for _ in 0..1_000_000 {
        let (cos, eta, k) = (random.range(1e-3, 1.0) as f32, random.magnitude(0.05, 20.0) as f32, random.magnitude(1e-3, 50.0) as f32);
        let (c, n) = (f64::from(cos), (f64::from(eta), f64::from(k)));
        assert_near(f64::from(conductor(cos, eta, k)), exact(c * c, n), rounding, &format!("cos {cos} eta {eta} k {k}"));
        let of_square = fresnel::conductor_of_square(cos * cos, Vec3A::splat(eta), Vec3A::splat(k)).x;
        assert_near(f64::from(of_square), exact(f64::from(cos * cos), n), rounding, &format!("cos² {} eta {eta} k {k}", cos * cos));
    }
}

#[test]
fn grazing_and_extreme_input_is_finite() {
    let extremes = [0.0f32, -0.0, 1e-45, 1e-38, 1e-7, 1e-3, 1.0];
    for z in extremes.into_iter().flat_map(|z| [z, -z]) {
        let wo = Vec3::new((1.0 - f64::from(z).powi(2)).sqrt() as f32, 0.0, z);
        for eta in [1e-30f32, 1e-3, 1f32.next_down(), 1.0, 1f32.next_up(), 1.5, 1e3, 1e30] {
            let reflectance = dielectric(z, eta);
            assert!((0.0..=1.0).contains(&reflectance), "R({z:e}, {eta:e}) = {reflectance}");
            let wi = refract(wo, eta);
            assert!(wi.is_none_or(|w| (w.length() - 1.0).abs() < 2e-7), "{wo} {eta:e}: {wi:?}");
            for k in [0.0, 1e-30, 1.0, 1e4] {
                assert!((0.0..=1.0).contains(&conductor(z, eta, k)), "R({z:e}, {eta:e} + {k:e}i)");
            }
        }
    }
    assert_eq!(dielectric(0.0, 1.5), 1.0, "grazing light is reflected");
}

proptest! {
    #![proptest_config(cases(10_000))]

    #[test]
    fn the_reflectance_is_the_textbooks(angle in 0.0..FRAC_PI_2, eta in 0.2f32..5.0, inside: bool) {
        prop_assume!((eta - 1.0).abs() > 1e-3);
        let cos = angle.cos() as f32;
        let n = if inside { 1.0 / f64::from(eta) } else { f64::from(eta) };
        let found = dielectric(if inside { -cos } else { cos }, eta);
        prop_assert!((f64::from(found) - textbook(f64::from(cos), n)).abs() < 1e-7);
    }

    #[test]
    fn reflection_is_an_exact_mirror(x in -1f32..1.0, y in -1f32..1.0, z in -1f32..1.0) {
        let wo = Vec3::new(x, y, z);
        let wi = reflect(wo);
        prop_assert_eq!(reflect(wi), wo);
        prop_assert_eq!(wo + wi, Vec3::new(0.0, 0.0, 2.0 * z));
        prop_assert_eq!(DVec3::from(wo).length(), DVec3::from(wi).length());
    }
}
