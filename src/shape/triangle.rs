//! Ray-triangle intersection.

use glam::{DVec3, Vec2, Vec3};

use super::ShapeHit;
use crate::math::Ray;

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
/// Architectures* (2007). Tests: watertight, distances_and_weights_match_integers.
#[inline(always)]
pub fn intersect(ray: &Ray, t_max: f32, corners: [Vec3; 3]) -> Option<ShapeHit> {
    intersect_within(ray, t_max, corners, Exact)
}

/// Hit of `ray` with a triangle, or with the plane of the triangle at most the tolerance outside, as seen along the ray, and at most
/// 1/1024 of the triangle. The weights are those of the nearest point of the triangle.
///
/// An edge function is 2 |d × e| times the distance at which the ray passes the edge e.
#[inline(always)]
pub fn intersect_within<T: Tolerance>(ray: &Ray, t_max: f32, corners: [Vec3; 3], tolerance: T) -> Option<ShapeHit> {
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
    let is_outside = wa.min(wb).min(wc) < 0.0 && wa.max(wb).max(wc) > 0.0;
    if is_outside && (T::IS_EXACT || !is_near(d, [wa, wb, wc], [c - b, ac, ab], f64::from(tolerance.get()))) {
        return None;
    }
    (sum != 0.0).then(|| {
        let [wb, wc] = if T::IS_EXACT { [wb / sum, wc / sum] } else { inside(wb / sum, wc / sum) };
        ShapeHit { t: hit, uv: Vec2::new(wb as f32, wc as f32) }
    })
}

/// Whether a ray passes the triangle at most `tolerance` outside, and at most 1/1024 of the triangle.
///
/// - `d`: unit direction
/// - `edges`: edges opposite to the corners with the edge functions `w`
#[inline(never)]
fn is_near(d: DVec3, w: [f64; 3], edges: [DVec3; 3], tolerance: f64) -> bool {
    let sum: f64 = w.iter().sum();
    let least = |edge: DVec3| -(2.0 * tolerance * d.cross(edge).length()).min(sum.abs() / 1024.0);
    w.into_iter().zip(edges).all(|(w, edge)| w * sum.signum() >= least(edge))
}

/// Weights of a point of the triangle near the point with these weights, which may be outside.
fn inside(wb: f64, wc: f64) -> [f64; 2] {
    let (wb, wc) = (wb.max(0.0), wc.max(0.0));
    let sum = (wb + wc).max(1.0);
    [wb / sum, wc / sum]
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
