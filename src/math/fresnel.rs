//! Reflection and refraction at a smooth boundary between two media.
//!
//! Directions are local: +z is the normal, which points to the outside. `eta` is the refractive index inside divided by that outside.
//! The functions compute in `f64` and round once, because the formulas cancel near the critical angle and near eta = 1. For metals,
//! only the sums that cancel are in `f64`.

use glam::{Vec3, Vec3A};

use super::float;

/// Mirror direction.
///
/// ωr = (−x, −y, z)
#[inline]
pub fn reflect(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// Refracted direction, or `None` under total reflection.
///
/// n sin θt = sin θo,    n = eta from outside, 1/eta from inside        (Snell)
///
/// - `wo`: unit direction on either side
///
/// Returns a unit direction on the other side, which is exactly −wo for eta = 1, and `None` exactly if [`dielectric`] is 1 because of
/// total reflection.
///
/// Tests: Snell, coplanar, unit length, round trip, total reflection.
#[inline]
pub fn refract(wo: Vec3, eta: f32) -> Option<Vec3> {
    if eta == 1.0 {
        return Some(-wo);
    }
    let n = relative_index(wo.z, eta);
    let (x, y, z) = (f64::from(wo.x), f64::from(wo.y), f64::from(wo.z));
    let by_cosine = cos2_refracted(z * z, n);
    if by_cosine <= 0.0 {
        return None;
    }
    // The smaller one of sin² and cos² is the accurate one.
    let sin2 = x * x + y * y;
    let by_sine = 1.0 - sin2 / (n * n);
    let cos2 = if sin2 < 0.5 && by_sine > 0.0 { by_sine } else { by_cosine };
    let (x, y, z) = (-x / n, -y / n, -cos2.sqrt().copysign(z));
    let length = (x * x + y * y + z * z).sqrt();
    Some(Vec3::new((x / length) as f32, (y / length) as f32, (z / length) as f32))
}

/// Reflectance of a dielectric boundary for unpolarised light.
///
/// R = (r_s² + r_p²)/2,    q = √(n² − sin²θ) = √((n − 1)(n + 1) + c²),    c = |cos θo|
///
/// r_s = (c − q)/(c + q)     = (1 − n²) / (c + q)²
///
/// r_p = (n²c − q)/(n²c + q) = (n² − 1)((n² + 1) c² − 1) / (n²c + q)²
///
/// The right-hand forms are used, because they do not cancel for n near 1.
///
/// - `cos_o`: positive from outside (n = eta), negative from inside (n = 1/eta)
/// - `eta`: inside / outside, positive
///
/// Returns exactly 0 for eta = 1, exactly 1 at and beyond the critical angle, and never less than 0 or more than 1.
///
/// Source: Fresnel (1823); Born and Wolf, *Principles of Optics*, §1.5. Tests: handbook values,
/// Stokes' reversibility, critical angle, Brewster's angle, hemispherical averages.
#[inline]
pub fn dielectric(cos_o: f32, eta: f32) -> f32 {
    if eta == 1.0 {
        return 0.0;
    }
    let n = relative_index(cos_o, eta);
    let c = f64::from(cos_o.abs()).min(1.0);
    if cos2_refracted(c * c, n) <= 0.0 {
        return 1.0;
    }
    let excess = (n - 1.0) * (n + 1.0);
    let q = (excess + c * c).sqrt();
    let (s, p) = (c + q, n * n * c + q);
    let r_s = excess / (s * s);
    let r_p = excess * ((n * n + 1.0) * (c * c) - 1.0) / (p * p);
    (0.5 * (r_s * r_s + r_p * r_p)).min(1.0) as f32
}

/// Mean reflectance of a dielectric boundary for diffuse light from outside.
///
/// R̄ = ∫ R(μ) 2μ dμ = 1/2 + (n − 1)(3n + 1) / (6 (n + 1)²) + n² (n² − 1)² / (n² + 1)³ · ln((n − 1)/(n + 1))
///     − 2 n³ (n² + 2n − 1) / ((n² + 1)(n⁴ − 1)) + 8 n⁴ (n⁴ + 1) / ((n² + 1)(n⁴ − 1)²) · ln n
///
/// The mean reflectance from inside is 1 − (1 − R̄)/n².
///
/// - `eta`: n, inside / outside, at least 1
///
/// Source: Walsh's integral, in Duntley, *The Optical Properties of Diffusing Materials* (1942). Tests: hemispherical averages.
pub fn dielectric_mean(eta: f32) -> f32 {
    let n = f64::from(eta);
    if n - 1.0 < MAX_LINEAR {
        return ((n - 1.0) / 3.0) as f32;
    }
    let (n2, n4) = (n * n, n * n * n * n);
    let (sum, difference) = (n2 + 1.0, (n - 1.0) * (n + 1.0) * (n2 + 1.0));
    let p = (n - 1.0) / (n + 1.0);
    let logarithms = n2 * ((n2 - 1.0) / sum).powi(2) / sum * float::ln_f64(p)
        + 8.0 * n4 * (n4 + 1.0) / (sum * difference * difference) * float::ln_f64(n);
    let algebraic = 0.5 + p * (3.0 * n + 1.0) / (6.0 * (n + 1.0)) - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / (sum * difference);
    (algebraic + logarithms) as f32
}

/// Greatest n − 1 for which R̄ is computed as (n − 1)/3, with an error of 4·10⁻⁸, because the terms of its formula cancel.
const MAX_LINEAR: f64 = 1e-4;

/// Reflectance of a conductor for unpolarised light.
///
/// t = n² − k² − sin²θ,    m = √(t² + 4 n² k²),    a = √((m + t)/2),    c = |cos θ|
///
/// R_s = (m − 2ac + c²) / (m + 2ac + c²)
///
/// R_p = R_s (m c² − 2ac sin²θ + sin⁴θ) / (m c² + 2ac sin²θ + sin⁴θ)
///
/// - `cos_o`: cosine, whose sign does not matter because a conductor has no inside
/// - `eta`, `k`: complex refractive index eta + ik of each colour, relative to the outside
///
/// Returns values in [0, 1] with an error below 6·10⁻⁷, and exactly 0 for eta = 1, k = 0.
///
/// Source: Born and Wolf, *Principles of Optics*, §14.2. Tests: handbook values, k = 0 is the dielectric.
#[inline]
pub fn conductor(cos_o: f32, eta: Vec3A, k: Vec3A) -> Vec3A {
    let c = cos_o.abs().min(1.0);
    conductor_by(c, f64::from(c) * f64::from(c), eta, k)
}

/// [`conductor`] for a given cos²θ, where the square is known first. The root and the rest are then computed in parallel.
///
/// - `cos2`: square of the cosine, not negative
#[inline]
pub fn conductor_of_square(cos2: f32, eta: Vec3A, k: Vec3A) -> Vec3A {
    let c2 = cos2.min(1.0);
    conductor_by(c2.sqrt(), f64::from(c2), eta, k)
}

#[inline(always)]
fn conductor_by(c: f32, c2: f64, eta: Vec3A, k: Vec3A) -> Vec3A {
    let (n, k) = (eta.as_dvec3(), k.as_dvec3());
    // Sums that cancel and are under roots are in double precision. n² − 1 is computed as (n − 1)(n + 1), for n near 1.
    let t = (n - 1.0) * (n + 1.0) - k * k + c2;
    let m = (t * t + 4.0 * (n * n) * (k * k)).sqrt();
    // m ≥ |t| holds also after rounding.
    let (m, a) = (m.as_vec3a(), (0.5 * (m + t)).as_vec3a().sqrt());
    let (c2, s2) = (c2 as f32, (1.0 - c2) as f32);
    // R_s (1 + R_p/R_s)/2 with a common denominator.
    let (s, p, both) = (m + c2, m * c2 + s2 * s2, 2.0 * c * a);
    let r = (s - both) * p / ((s + both) * (p + both * s2));
    // Clamped to [0, 1]. Without a boundary, 0/0 becomes 0.
    Vec3A::select(r.cmpgt(Vec3A::ZERO), r.min(Vec3A::ONE), Vec3A::ZERO)
}

/// Refractive index beyond the boundary divided by that on the side of a direction with this cosine.
#[inline]
fn relative_index(cos_o: f32, eta: f32) -> f64 {
    let eta = f64::from(eta);
    if cos_o < 0.0 { 1.0 / eta } else { eta }
}

/// Squared cosine of the refracted direction, cos²θt = ((n − 1)(n + 1) + cos²θ) / n², without cancellation near n = 1. It is not above 0
/// under total reflection.
#[inline]
fn cos2_refracted(cos2_o: f64, n: f64) -> f64 {
    ((n - 1.0) * (n + 1.0) + cos2_o) / (n * n)
}
