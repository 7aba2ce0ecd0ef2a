//! The one triangle test.

use glam::{DVec3, Vec2, Vec3};

use super::ShapeHit;
use crate::math::Ray;

/// Where `ray` meets the triangle before `t_max`, edges and corners included; from either side.
///
/// With corners a, b, c relative to the ray's origin and the ray's direction d, the edge function
///
///   E(p, q) = d · ((q − p) × (q + p))
///
/// is twice the volume that the ray and the edge pq span: the ray meets the triangle where E(b, c),
/// E(c, a) and E(a, b) agree in sign, and they are the (scaled) weights of a, b and c.
///
/// In f64, multiply and subtract only. The differences of f32 corners are then all but exact and
/// E(p, q) = −E(q, p) to the last bit, so that neighbours never both miss their common edge.
/// Accelerators may filter as they like, if they keep whatever this test would accept.
///
/// - returns t and the weights of b and c; `None` for edge-on and degenerate triangles
///
/// Source: Shevtsov, Soupikov, Kapustin, *Ray-Triangle Intersection Algorithm for Modern CPU
/// Architectures* (2007). Tests: watertight, distances_and_weights_match_integers.
#[inline(always)]
pub fn intersect(ray: &Ray, t_max: f32, corners: [Vec3; 3]) -> Option<ShapeHit> {
    let o = ray.origin.as_dvec3();
    let d = ray.direction.as_dvec3();
    let [a, b, c] = corners.map(|v| v.as_dvec3() - o);
    let (ab, ac) = (b - a, c - a);
    // The plane first: most triangles asked lie behind the ray's origin, or beyond its end.
    let n = ab.cross(ac);
    let (height, slope) = (n.dot(a), n.dot(d));
    // Of the same sign; false for NaN too, which a degenerate triangle gives.
    let is_ahead = height * slope > 0.0;
    if !is_ahead {
        return None;
    }
    let mut t = height / slope;
    if slope * slope < NOISY * ab.length_squared() * ac.length_squared() * d.length_squared() {
        let along = [a, b, c].map(|v| v.dot(d) / d.length_squared());
        t = t.max(along[0].min(along[1]).min(along[2])).min(along[0].max(along[1]).max(along[2]));
    }
    let hit = t as f32;
    // False for a t_max of NaN, too.
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

/// Below this share of its greatest, the square of n·d is mostly rounding: the ray all but lies in the plane, or
/// the corners all but on a line. There t is noise, and kept between the corners.
const NOISY: f64 = 1.0 / (1u64 << 40) as f64;

/// The unit normal (b − a) × (c − a); `None` where the triangle is degenerate.
///
/// In f64: the cross product of tiny edges is below what f32 holds.
pub fn normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    cross(a, b, c).try_normalize().map(|n| n.as_vec3())
}

/// (m²)
pub fn area([a, b, c]: [Vec3; 3]) -> f32 {
    (0.5 * cross(a, b, c).length()) as f32
}

fn cross(a: Vec3, b: Vec3, c: Vec3) -> DVec3 {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a)
}
