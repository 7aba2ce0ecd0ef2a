//! Ray-triangle intersection.

use glam::{DVec3, Vec2, Vec3};

use super::ShapeHit;
use crate::math::Ray;
use crate::math::lanes::{Lanes, VectorF64};

/// Hit of `ray` with a triangle before `t_max`, from either side, including edges and corners.
///
/// With corners a, b, c relative to the ray's origin and the ray's direction d, the edge function
///
///   E(p, q) = d · ((q − p) × (q + p))
///
/// is twice the volume that the ray and the edge pq span. The ray hits the triangle if E(b, c), E(c, a) and E(a, b) have the same
/// sign; their values are the barycentric weights of a, b and c up to a factor.
///
/// The test uses f64, multiplications and subtractions only. The differences of f32 corners are then nearly exact, and
/// E(p, q) = −E(q, p) to the last bit, so that a ray never misses both triangles at a common edge. Accelerators may filter triangles
/// in any way that keeps all hits of this test.
///
/// Returns t and the weights of b and c; `None` for edge-on and degenerate triangles.
///
/// Source: Shevtsov, Soupikov, Kapustin, *Ray-Triangle Intersection Algorithm for Modern CPU
/// Architectures* (2007). Tests: row G1 of `pt torture`, distances_and_weights_match_integers.
#[inline(always)]
pub fn intersect(ray: &Ray, t_max: f32, corners: [Vec3; 3]) -> Option<ShapeHit> {
    intersect_with_tolerance(ray, t_max, corners, Exact)
}

/// Hit of `ray` with a triangle, or with the nearest point of its border where the ray passes outside of it within the tolerance.
#[inline(always)]
pub fn intersect_with_tolerance<T: Tolerance>(ray: &Ray, t_max: f32, corners: [Vec3; 3], tolerance: T) -> Option<ShapeHit> {
    let o = ray.origin.as_dvec3();
    let d = ray.direction.as_dvec3();
    let [a, b, c] = corners.map(|v| v.as_dvec3() - o);
    let (ab, ac) = (b - a, c - a);
    // The plane is tested first, because most tested triangles lie behind the ray's origin or beyond its end.
    let n = ab.cross(ac);
    let (height, slope) = (n.dot(a), n.dot(d));
    // The comparison is false also for NaN, which a degenerate triangle gives.
    let is_ahead = height * slope > 0.0;
    if !is_ahead {
        return None;
    }
    let mut t = height / slope;
    if slope * slope < ILL_CONDITIONED * ab.length_squared() * ac.length_squared() * d.length_squared() {
        let along = [a, b, c].map(|v| v.dot(d) / d.length_squared());
        t = t.max(along[0].min(along[1]).min(along[2])).min(along[0].max(along[1]).max(along[2]));
    }
    let hit = t as f32;
    // The comparison is false also if `t_max` is NaN.
    let is_between = hit > 0.0 && hit < t_max;
    if !is_between {
        return None;
    }
    let edge = |p: DVec3, q: DVec3| d.dot((q - p).cross(q + p));
    let (wa, wb, wc) = (edge(b, c), edge(c, a), edge(a, b));
    let sum = wa + wb + wc;
    if wa.min(wb).min(wc) < 0.0 && wa.max(wb).max(wc) > 0.0 {
        return if T::IS_EXACT { None } else { border(d, [a, b, c], f64::from(tolerance.get()), t_max) };
    }
    (sum != 0.0).then(|| ShapeHit { t: hit, uv: Vec2::new((wb / sum) as f32, (wc / sum) as f32) })
}

/// Hits of rays side by side with one triangle.
#[derive(Clone, Copy)]
pub struct HitsOfMany<L: Lanes> {
    /// Which rays hit the triangle, in front of their origins. The other numbers hold for these only.
    pub found: L::Mask,
    /// Ray parameters (m).
    pub t: L::F32,
    /// Barycentric weights of the second corner.
    pub u: L::F32,
    /// Barycentric weights of the third corner.
    pub v: L::F32,
}

/// Hits of several rays with a triangle, with the bits that [`intersect`] finds for each ray. The ends of the rays are left to the caller.
///
/// - `active`: rays to test
///
/// Tests: packets_find_what_single_rays_find.
#[inline(always)]
pub fn intersect_many<L: Lanes>(o: VectorF64<L>, d: VectorF64<L>, corners: [VectorF64<L>; 3], active: L::Mask) -> HitsOfMany<L> {
    let [a, b, c] = corners;
    let (a, b, c) = (a - o, b - o, c - o);
    let (ab, ac) = (b - a, c - a);
    let n = ab.cross(ac);
    let (height, slope) = (n.dot(a), n.dot(d));
    let zero = L::f64(0.0);
    let mut t = height / slope;
    let is_ill_conditioned =
        L::lt_f64(slope * slope, L::f64(ILL_CONDITIONED) * ab.length_squared() * ac.length_squared() * d.length_squared());
    if L::any(is_ill_conditioned & active) {
        let square = d.length_squared();
        let (a, b, c) = (a.dot(d) / square, b.dot(d) / square, c.dot(d) / square);
        let clamped = L::min_f64(L::max_f64(t, L::min_f64(L::min_f64(a, b), c)), L::max_f64(L::max_f64(a, b), c));
        t = L::select_f64(is_ill_conditioned, clamped, t);
    }
    let hit = L::narrow(t);
    let found = active & L::lt_f64(zero, height * slope) & L::lt(L::f32(0.0), hit);
    if !L::any(found) {
        return HitsOfMany { found, t: hit, u: hit, v: hit };
    }
    let (wa, wb, wc) = (edge_of_many(d, b, c), edge_of_many(d, c, a), edge_of_many(d, a, b));
    let sum = wa + wb + wc;
    let least = L::min_f64(L::min_f64(wa, wb), wc);
    let greatest = L::max_f64(L::max_f64(wa, wb), wc);
    let is_outside = L::lt_f64(least, zero) & L::lt_f64(zero, greatest);
    // For finite corners and rays the sum is never NaN.
    let has_area = L::lt_f64(sum, zero) | L::lt_f64(zero, sum);
    HitsOfMany { found: found & !is_outside & has_area, t: hit, u: L::narrow(wb / sum), v: L::narrow(wc / sum) }
}

/// Edge function of [`intersect`] in each lane.
#[inline(always)]
fn edge_of_many<L: Lanes>(d: VectorF64<L>, p: VectorF64<L>, q: VectorF64<L>) -> L::F64 {
    d.dot((q - p).cross(q + p))
}

/// The point of a triangle's border that the line of a ray passes most closely, if it passes within `tolerance` and the point is between
/// 0 and `t_max`.
///
/// - `d`: unit direction of the ray
/// - `corners`: corners relative to the ray's origin
#[inline(never)]
fn border(d: DVec3, corners: [DVec3; 3], tolerance: f64, t_max: f32) -> Option<ShapeHit> {
    let mut nearest = (tolerance * tolerance, None);
    for k in 0..3 {
        let (p, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        // Perpendicular to the ray, its line is the origin.
        let (flat, across) = (p - d * p.dot(d), edge - d * edge.dot(d));
        let along = (-flat.dot(across) / across.length_squared()).clamp(0.0, 1.0);
        // NaN for an edge along the ray.
        let along = if along.is_nan() { 0.0 } else { along };
        let distance_squared = (flat + across * along).length_squared();
        if distance_squared <= nearest.0 {
            let mut weights = [0.0; 3];
            (weights[k], weights[(k + 1) % 3]) = (1.0 - along, along);
            nearest = (distance_squared, Some(((p + edge * along).dot(d) as f32, weights)));
        }
    }
    let (t, [_, wb, wc]) = nearest.1?;
    (t > 0.0 && t < t_max).then(|| ShapeHit { t, uv: Vec2::new(wb as f32, wc as f32) })
}

/// Distance at which a ray may pass a triangle and still hit it. Without one, the hits are exact at no cost.
pub trait Tolerance: Copy {
    /// Whether the distance is 0.
    const IS_EXACT: bool;

    /// The distance (m).
    fn get(self) -> f32;
}

/// No tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

impl Tolerance for Exact {
    const IS_EXACT: bool = true;

    fn get(self) -> f32 {
        0.0
    }
}

/// Tolerance (m).
#[derive(Clone, Copy, Debug)]
pub struct Within(pub f32);

impl Tolerance for Within {
    const IS_EXACT: bool = false;

    fn get(self) -> f32 {
        self.0
    }
}

/// Fraction of its greatest value below which the square of n·d is mostly rounding error, because the ray lies nearly in the plane or
/// the corners nearly on a line. t is then clamped to the range of the corners.
const ILL_CONDITIONED: f64 = 1.0 / (1u64 << 40) as f64;

/// Unit normal in the direction (b − a) × (c − a); `None` if the triangle is degenerate.
///
/// The computation is in f64, because the cross product of tiny edges is below the range of f32.
pub fn normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    cross(a, b, c).try_normalize().map(|n| n.as_vec3())
}

/// Area (m²).
pub fn area([a, b, c]: [Vec3; 3]) -> f32 {
    (0.5 * cross(a, b, c).length()) as f32
}

fn cross(a: Vec3, b: Vec3, c: Vec3) -> DVec3 {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a)
}
