//! The one triangle test.

use glam::{DVec3, Vec2, Vec3};

use super::ShapeHit;
use crate::math::Ray;

/// Where `ray` meets the triangle, edges and corners included; from either side.
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
/// Architectures* (2007). Tests: watertight, triangle_matches_exact.
pub fn intersect(ray: &Ray, corners: [Vec3; 3]) -> Option<ShapeHit> {
    let o = ray.origin.as_dvec3();
    let d = ray.direction.as_dvec3();
    let [a, b, c] = corners.map(|v| v.as_dvec3() - o);
    let edge = |p: DVec3, q: DVec3| d.dot((q - p).cross(q + p));
    let (wa, wb, wc) = (edge(b, c), edge(c, a), edge(a, b));
    if wa.min(wb).min(wc) < 0.0 && wa.max(wb).max(wc) > 0.0 {
        return None;
    }
    let sum = wa + wb + wc;
    let n = (b - a).cross(c - a);
    let t = n.dot(a) / n.dot(d);
    // Written so that NaN, from 0/0 of a degenerate triangle, is a miss.
    if !(sum != 0.0 && t > 0.0) {
        return None;
    }
    // Where the ray all but lies in the plane, t is noise: it stays between the corners.
    let along = [a, b, c].map(|v| v.dot(d) / d.length_squared());
    let t = t.max(along[0].min(along[1]).min(along[2])).min(along[0].max(along[1]).max(along[2])) as f32;
    (t > 0.0 && t < ray.t_max).then(|| ShapeHit { t, uv: Vec2::new((wb / sum) as f32, (wc / sum) as f32) })
}

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
