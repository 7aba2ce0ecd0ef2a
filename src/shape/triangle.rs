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
    if wa.min(wb).min(wc) < 0.0 && wa.max(wb).max(wc) > 0.0 {
        return None;
    }
    let sum = wa + wb + wc;
    (sum != 0.0).then(|| ShapeHit { t: hit, uv: Vec2::new((wb / sum) as f32, (wc / sum) as f32) })
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
