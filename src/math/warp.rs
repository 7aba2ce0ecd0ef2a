//! Maps from the unit square to where samples are needed, each with its density and its inverse.
//!
//! To the disk goes Shirley and Chiu's concentric map; all maps to the sphere pass through it, so
//! that neighbours stay neighbours and stratification survives. z is the axis. Every u in [0, 1)²,
//! with 0 and 1 − 2⁻²⁴, gives a finite result inside the domain.

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use super::float::{ONE_MINUS_EPSILON, atan2, exp_f64, exp_m1_f64, ln_f64, sin_cos_octant};

const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
const INV_2PI: f32 = INV_PI / 2.0;

/// Uniform on the unit disk.
///
/// (r, φ) = (a, π/4 · b/a) if |a| > |b|, else (b, π/2 − π/4 · a/b),    a = 2u − 1, b = 2v − 1
///
/// Source: Shirley and Chiu, *A low distortion map between disk and square* (1997).
/// Tests: pdf_is_inverse_jacobian, inverse_round_trip, inside.
#[inline]
pub fn disk(u: Vec2) -> Vec2 {
    let (r, direction) = polar(u);
    r * direction
}

/// 1/π per unit area, inside the disk.
#[inline]
pub fn disk_pdf() -> f32 {
    INV_PI
}

#[inline]
pub fn disk_inverse(p: Vec2) -> Vec2 {
    let r = p.length();
    if r == 0.0 {
        return Vec2::splat(0.5);
    }
    let (a, b) = if p.x.abs() > p.y.abs() {
        let a = r.copysign(p.x);
        (a, a * atan2(p.y * p.x.signum(), p.x.abs()) / FRAC_PI_4)
    } else {
        let b = r.copysign(p.y);
        (b * atan2(p.x * p.y.signum(), p.y.abs()) / FRAC_PI_4, b)
    };
    to_unit_square(0.5 * (Vec2::new(a, b) + 1.0))
}

/// Uniform on the unit sphere.
///
/// pdf = 1/(4π)                                                        [sr⁻¹]
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 2.0)
}

/// 1/(4π) in every direction.
#[inline]
pub fn uniform_sphere_pdf() -> f32 {
    INV_2PI / 2.0
}

#[inline]
pub fn uniform_sphere_inverse(w: Vec3) -> Vec2 {
    uniform_cone_inverse(w, 2.0)
}

/// Uniform on the hemisphere z > 0.
///
/// pdf = 1/(2π)                                                        [sr⁻¹]
#[inline]
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 1.0)
}

/// 1/(2π) above the horizon, 0 below.
#[inline]
pub fn uniform_hemisphere_pdf(w: Vec3) -> f32 {
    if w.z > 0.0 { INV_2PI } else { 0.0 }
}

#[inline]
pub fn uniform_hemisphere_inverse(w: Vec3) -> Vec2 {
    uniform_cone_inverse(w, 1.0)
}

/// On the hemisphere z > 0 with density proportional to the cosine.
///
/// pdf = z/π                                                           [sr⁻¹]
///
/// The disk lifted to the sphere: z = √(1 − r²), and z > 0 for every u.
///
/// Source: Malley; see Pharr, Jakob, Humphreys, *Physically Based Rendering* (2023), A.5.3.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (r, direction) = polar(u);
    (r * direction).extend(((1.0 - r) * (1.0 + r)).sqrt())
}

/// z/π above the horizon, 0 below.
#[inline]
pub fn cosine_hemisphere_pdf(w: Vec3) -> f32 {
    INV_PI * w.z.max(0.0)
}

#[inline]
pub fn cosine_hemisphere_inverse(w: Vec3) -> Vec2 {
    disk_inverse(w.truncate())
}

/// Uniform on the cone of directions about +z.
///
/// h = r² (1 − cos θmax) = 1 − z,    sin θ = √(h (2 − h)),    pdf = 1/(2π (1 − cos θmax))    [sr⁻¹]
///
/// - `one_minus_cos_max`: in (0, 2]; the cosine itself would round the angle of a small light away
///
/// Tests: pdf_is_inverse_jacobian, tiny cones, inverse_round_trip.
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3 {
    let (r, direction) = polar(u);
    let h = one_minus_cos_max * r * r;
    // 2 − h, with the exact (1 − r)(1 + r): at the far pole of the sphere h is nearly 2.
    let rest = (2.0 - one_minus_cos_max) + one_minus_cos_max * ((1.0 - r) * (1.0 + r));
    (r * (one_minus_cos_max * rest).sqrt() * direction).extend(1.0 - h)
}

/// 1/(2π (1 − cos θmax)) inside the cone.
#[inline]
pub fn uniform_cone_pdf(one_minus_cos_max: f32) -> f32 {
    INV_2PI / one_minus_cos_max
}

#[inline]
pub fn uniform_cone_inverse(w: Vec3, one_minus_cos_max: f32) -> Vec2 {
    let sin = w.truncate();
    // 1 − z, from the sine where z has lost it.
    let h = if w.z > 0.0 { sin.length_squared() / (1.0 + w.z) } else { 1.0 - w.z };
    let r = (h / one_minus_cos_max).sqrt().min(1.0);
    disk_inverse(r * sin.normalize_or(Vec2::X))
}

/// Uniform on a triangle, as barycentrics (b₁, b₂) of its second and third corner.
///
/// pdf = 2 per unit of (b₁, b₂), 1/area per unit area
///
/// The square is folded along its diagonal, not squashed into a corner.
///
/// Source: Heitz, *A Low-Distortion Map Between Triangle and Square* (2019).
/// Tests: pdf_is_inverse_jacobian, inverse_round_trip, inside.
#[inline]
pub fn triangle(u: Vec2) -> Vec2 {
    let half = 0.5 * u;
    if u.y > u.x { Vec2::new(half.x, u.y - half.x) } else { Vec2::new(u.x - half.y, half.y) }
}

/// 2 per unit of (b₁, b₂): divide by twice the area for a density per area.
#[inline]
pub fn triangle_pdf() -> f32 {
    2.0
}

#[inline]
pub fn triangle_inverse(b: Vec2) -> Vec2 {
    let sum = b.x + b.y;
    to_unit_square(if b.y > b.x { Vec2::new(2.0 * b.x, sum) } else { Vec2::new(sum, 2.0 * b.y) })
}

/// On the hemisphere z > 0 with density proportional to a power of the cosine.
///
/// z = (1 − r²)^(1/(n + 1)),    pdf = (n + 1)/(2π) zⁿ                    [sr⁻¹]
///
/// - `n` ≥ 0; for large `n` all directions crowd about the axis, so 1 − z is computed, not z
///
/// Tests: pdf_is_inverse_jacobian, mean cosine (n + 1)/(n + 2) up to n = 10⁸.
#[inline]
pub fn cos_power_hemisphere(u: Vec2, n: f32) -> Vec3 {
    let (r, direction) = polar(u);
    let r = f64::from(r);
    let h = -exp_m1_f64(ln_f64((1.0 - r) * (1.0 + r)) / (f64::from(n) + 1.0));
    let sin = (h * (2.0 - h)).sqrt() as f32;
    (sin * direction).extend((1.0 - h) as f32)
}

/// (n + 1)/(2π) zⁿ above the horizon, 0 below.
#[inline]
pub fn cos_power_hemisphere_pdf(w: Vec3, n: f32) -> f32 {
    let n = f64::from(n);
    if w.z <= 0.0 { 0.0 } else { (f64::from(INV_2PI) * (n + 1.0) * exp_f64(n * ln_cosine(w))) as f32 }
}

#[inline]
pub fn cos_power_hemisphere_inverse(w: Vec3, n: f32) -> Vec2 {
    let r = (-exp_m1_f64((f64::from(n) + 1.0) * ln_cosine(w))).max(0.0).sqrt() as f32;
    disk_inverse(r * w.truncate().normalize_or(Vec2::X))
}

/// ln z of a unit direction above the horizon, from the sine where z is too near 1 to tell.
#[inline]
fn ln_cosine(w: Vec3) -> f64 {
    let (x, y) = (f64::from(w.x), f64::from(w.y));
    let sin2 = x * x + y * y;
    if sin2 < 0.5 { 0.5 * ln_f64(1.0 - sin2) } else { ln_f64(f64::from(w.z)) }
}

/// The concentric map in polar form: a radius in [0, 1), and a unit direction.
#[inline]
pub(crate) fn polar(u: Vec2) -> (f32, Vec2) {
    // Uniform numbers are the lower ends of cells of width 2⁻²⁴; taking the cells' centres is
    // exact in f32, symmetric, and keeps the radius below 1, where a cosine would be 0: 2u − 1 + 2⁻²⁴.
    let signed = 2.0 * u - ONE_MINUS_EPSILON;
    let side = signed.abs();
    let r = side.max_element();
    // At the centre 0/0 is to be 0.
    let ratio = side.min_element() / r.max(f32::MIN_POSITIVE);
    let (sin, cos) = sin_cos_octant(FRAC_PI_4 * ratio);
    // The complement of a steep angle: its sine and cosine trade places. Selected, not branched: which it is cannot be foretold.
    let flat = Vec4::new(cos, sin, 0.0, 0.0);
    let steep = Vec4::splat(side.x).cmple(Vec4::splat(side.y));
    let direction = Vec4::select(steep, flat.yxzw(), flat).copysign(Vec4::new(signed.x, signed.y, 0.0, 0.0));
    (r, direction.xy())
}

/// Rounding may carry an inverse just past an edge of [0, 1)².
#[inline]
fn to_unit_square(u: Vec2) -> Vec2 {
    u.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
}
