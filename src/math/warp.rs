//! Maps from the unit square to other domains for sampling, each with its density and its inverse.
//!
//! The map to the disk is Shirley and Chiu's concentric map. All maps to the sphere use it, so that neighbouring points stay neighbours
//! and stratification is kept. The axis is z. Every u in [0, 1)², including 0 and 1 − 2⁻²⁴, gives a finite result inside the domain.

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use super::float::{ONE_MINUS_EPSILON, atan2, exp_f64, exp_m1_f64, ln_f64, sin_cos_octant, sin_cos_octant_lanes};
use super::lanes::{Lanes, Vector};

const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
const INV_2PI: f32 = INV_PI / 2.0;

/// Maps uniformly to the unit disk.
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

/// Density of [`disk`] inside the disk: 1/π per unit area.
#[inline]
pub fn disk_pdf() -> f32 {
    INV_PI
}

/// Inverse of [`disk`].
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

/// Maps uniformly to the unit sphere.
///
/// pdf = 1/(4π)                                                        [sr⁻¹]
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 2.0)
}

/// [`uniform_sphere`] in each lane.
///
/// Tests: lanes_have_the_bits_of_the_warp.
#[inline(always)]
pub fn uniform_sphere_lanes<L: Lanes>(u: [L::F32; 2]) -> Vector<L> {
    let (r, [x, y]) = polar_lanes::<L>(u);
    let (one, two) = (L::f32(1.0), L::f32(2.0));
    let radius = r * L::sqrt(two * (two * ((one - r) * (one + r))));
    Vector { x: radius * x, y: radius * y, z: one - two * r * r }
}

/// Density of [`uniform_sphere`]: 1/(4π) in every direction [sr⁻¹].
#[inline]
pub fn uniform_sphere_pdf() -> f32 {
    INV_2PI / 2.0
}

/// Inverse of [`uniform_sphere`].
#[inline]
pub fn uniform_sphere_inverse(w: Vec3) -> Vec2 {
    uniform_cone_inverse(w, 2.0)
}

/// Maps uniformly to the hemisphere z > 0.
///
/// pdf = 1/(2π)                                                        [sr⁻¹]
#[inline]
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 1.0)
}

/// Density of [`uniform_hemisphere`]: 1/(2π) above the horizon, 0 below [sr⁻¹].
#[inline]
pub fn uniform_hemisphere_pdf(w: Vec3) -> f32 {
    if w.z > 0.0 { INV_2PI } else { 0.0 }
}

/// Inverse of [`uniform_hemisphere`].
#[inline]
pub fn uniform_hemisphere_inverse(w: Vec3) -> Vec2 {
    uniform_cone_inverse(w, 1.0)
}

/// Maps to the hemisphere z > 0 with a density proportional to the cosine.
///
/// pdf = z/π                                                           [sr⁻¹]
///
/// The uniform disk is projected up to the sphere: z = √(1 − r²), and z > 0 for every u.
///
/// Source: Malley; see Pharr, Jakob, Humphreys, *Physically Based Rendering* (2023), A.5.3.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (r, direction) = polar(u);
    (r * direction).extend(((1.0 - r) * (1.0 + r)).sqrt())
}

/// [`cosine_hemisphere`] in each lane.
///
/// Tests: lanes_have_the_bits_of_the_warp.
#[inline(always)]
pub fn cosine_hemisphere_lanes<L: Lanes>(u: [L::F32; 2]) -> Vector<L> {
    let (r, [x, y]) = polar_lanes::<L>(u);
    let one = L::f32(1.0);
    Vector { x: r * x, y: r * y, z: L::sqrt((one - r) * (one + r)) }
}

/// Density of [`cosine_hemisphere`]: z/π above the horizon, 0 below [sr⁻¹].
#[inline]
pub fn cosine_hemisphere_pdf(w: Vec3) -> f32 {
    INV_PI * w.z.max(0.0)
}

/// Inverse of [`cosine_hemisphere`].
#[inline]
pub fn cosine_hemisphere_inverse(w: Vec3) -> Vec2 {
    disk_inverse(w.truncate())
}

/// Maps uniformly to a cone of directions around +z.
///
/// h = r² (1 − cos θmax) = 1 − z,    sin θ = √(h (2 − h)),    pdf = 1/(2π (1 − cos θmax))    [sr⁻¹]
///
/// - `one_minus_cos_max`: 1 − cos θmax in (0, 2]. The cosine itself would round to 1 for a small light.
///
/// Tests: pdf_is_inverse_jacobian, tiny cones, inverse_round_trip.
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3 {
    let (r, direction) = polar(u);
    let h = one_minus_cos_max * r * r;
    // 2 − h by the exact (1 − r)(1 + r), because h is nearly 2 at the far pole of the sphere.
    let two_minus_h = (2.0 - one_minus_cos_max) + one_minus_cos_max * ((1.0 - r) * (1.0 + r));
    (r * (one_minus_cos_max * two_minus_h).sqrt() * direction).extend(1.0 - h)
}

/// Density of [`uniform_cone`] inside the cone: 1/(2π (1 − cos θmax)) [sr⁻¹].
#[inline]
pub fn uniform_cone_pdf(one_minus_cos_max: f32) -> f32 {
    INV_2PI / one_minus_cos_max
}

/// Inverse of [`uniform_cone`].
#[inline]
pub fn uniform_cone_inverse(w: Vec3, one_minus_cos_max: f32) -> Vec2 {
    let sin = w.truncate();
    // 1 − z, computed from the sine for z > 0 to avoid cancellation.
    let h = if w.z > 0.0 { sin.length_squared() / (1.0 + w.z) } else { 1.0 - w.z };
    let r = (h / one_minus_cos_max).sqrt().min(1.0);
    disk_inverse(r * sin.normalize_or(Vec2::X))
}

/// Maps uniformly to a triangle, as barycentric weights (b₁, b₂) of the second and third corner.
///
/// pdf = 2 per unit of (b₁, b₂), 1/area per unit area
///
/// The square is folded along its diagonal, which has a low distortion.
///
/// Source: Heitz, *A Low-Distortion Map Between Triangle and Square* (2019).
/// Tests: pdf_is_inverse_jacobian, inverse_round_trip, inside.
#[inline]
pub fn triangle(u: Vec2) -> Vec2 {
    let half = 0.5 * u;
    if u.y > u.x { Vec2::new(half.x, u.y - half.x) } else { Vec2::new(u.x - half.y, half.y) }
}

/// Density of [`triangle`]: 2 per unit of (b₁, b₂). Divided by twice the area, it is the density by area.
#[inline]
pub fn triangle_pdf() -> f32 {
    2.0
}

/// Inverse of [`triangle`].
#[inline]
pub fn triangle_inverse(b: Vec2) -> Vec2 {
    let sum = b.x + b.y;
    to_unit_square(if b.y > b.x { Vec2::new(2.0 * b.x, sum) } else { Vec2::new(sum, 2.0 * b.y) })
}

/// Maps to the hemisphere z > 0 with a density proportional to a power of the cosine.
///
/// z = (1 − r²)^(1/(n + 1)),    pdf = (n + 1)/(2π) zⁿ                    [sr⁻¹]
///
/// - `n` ≥ 0. For large `n` all directions are near the axis, so that 1 − z is computed instead of z.
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

/// Density of [`cos_power_hemisphere`]: (n + 1)/(2π) zⁿ above the horizon, 0 below [sr⁻¹].
#[inline]
pub fn cos_power_hemisphere_pdf(w: Vec3, n: f32) -> f32 {
    let n = f64::from(n);
    if w.z <= 0.0 { 0.0 } else { (f64::from(INV_2PI) * (n + 1.0) * exp_f64(n * ln_cosine(w))) as f32 }
}

/// Inverse of [`cos_power_hemisphere`].
#[inline]
pub fn cos_power_hemisphere_inverse(w: Vec3, n: f32) -> Vec2 {
    let r = (-exp_m1_f64((f64::from(n) + 1.0) * ln_cosine(w))).max(0.0).sqrt() as f32;
    disk_inverse(r * w.truncate().normalize_or(Vec2::X))
}

/// ln z of a unit direction above the horizon, computed from the sine if z is near 1.
#[inline]
fn ln_cosine(w: Vec3) -> f64 {
    let (x, y) = (f64::from(w.x), f64::from(w.y));
    let sin2 = x * x + y * y;
    if sin2 < 0.5 { 0.5 * ln_f64(1.0 - sin2) } else { ln_f64(f64::from(w.z)) }
}

/// Concentric map in polar form: a radius in [0, 1) and a unit direction.
#[inline]
pub(crate) fn polar(u: Vec2) -> (f32, Vec2) {
    // Uniform numbers are the lower ends of cells of width 2⁻²⁴. The centres of the cells, 2u − 1 + 2⁻²⁴, are exact in f32, are
    // symmetric, and keep the radius below 1, where a cosine would be 0.
    let signed = 2.0 * u - ONE_MINUS_EPSILON;
    let side = signed.abs();
    let r = side.max_element();
    // At the centre, 0/0 becomes 0.
    let ratio = side.min_element() / r.max(f32::MIN_POSITIVE);
    let (sin, cos) = sin_cos_octant(FRAC_PI_4 * ratio);
    // Sine and cosine are exchanged for angles above 45°, by a selection because a branch would be unpredictable.
    let flat = Vec4::new(cos, sin, 0.0, 0.0);
    let steep = Vec4::splat(side.x).cmple(Vec4::splat(side.y));
    let direction = Vec4::select(steep, flat.yxzw(), flat).copysign(Vec4::new(signed.x, signed.y, 0.0, 0.0));
    (r, direction.xy())
}

/// [`polar`] in each lane.
#[inline(always)]
fn polar_lanes<L: Lanes>([u, v]: [L::F32; 2]) -> (L::F32, [L::F32; 2]) {
    let (two, shift) = (L::f32(2.0), L::f32(ONE_MINUS_EPSILON));
    let (x, y) = (two * u - shift, two * v - shift);
    let (side_x, side_y) = (L::abs(x), L::abs(y));
    let r = L::max(side_x, side_y);
    let ratio = L::min(side_x, side_y) / L::max(r, L::f32(f32::MIN_POSITIVE));
    let (sin, cos) = sin_cos_octant_lanes::<L>(L::f32(FRAC_PI_4) * ratio);
    let steep = L::le(side_x, side_y);
    (r, [L::copysign(L::select(steep, sin, cos), x), L::copysign(L::select(steep, cos, sin), y)])
}

/// Clamps the result of an inverse to [0, 1)², which rounding may exceed.
#[inline]
fn to_unit_square(u: Vec2) -> Vec2 {
    u.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{Kernel, Width};
    use super::*;

    /// Both warps of the numbers of some lanes.
    struct Warps([[f32; 16]; 2]);

    impl Kernel for Warps {
        type Output = Vec<[Vec3; 2]>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<[Vec3; 2]> {
            let u = [L::load(&self.0[0]), L::load(&self.0[1])];
            let (hemisphere, sphere) = (cosine_hemisphere_lanes::<L>(u), uniform_sphere_lanes::<L>(u));
            let mut all = vec![];
            for k in 0..L::COUNT {
                all.push([hemisphere.get(k), sphere.get(k)]);
            }
            all
        }
    }

    /// Also at the borders of the square and of its octants, where the cases meet.
    #[test]
    fn lanes_have_the_bits_of_the_warp() {
        let special = [0.0, ONE_MINUS_EPSILON, 0.5, 0.5f32.next_down(), 0.25, 0.75, 1.0 / 3.0];
        let numbers: Vec<f32> =
            special.into_iter().chain((0..89u32).map(|k| super::super::float::unit_f32(k.wrapping_mul(0x9e37_79b9)))).collect();
        let pairs: Vec<[f32; 2]> = numbers.iter().flat_map(|&u| numbers.iter().map(move |&v| [u, v])).collect();
        for (group, width) in pairs.chunks_exact(16).flat_map(|group| Width::available().into_iter().map(move |width| (group, width))) {
            let of = |axis: usize| std::array::from_fn(|k| group[k][axis]);
            for (found, [u, v]) in width.run(Warps([of(0), of(1)])).into_iter().zip(group) {
                let u = Vec2::new(*u, *v);
                let bits = |w: Vec3| w.to_array().map(f32::to_bits);
                assert_eq!(found.map(bits), [cosine_hemisphere(u), uniform_sphere(u)].map(bits), "{u}, {width:?}");
            }
        }
    }
}
