//! Sampling of flat surfaces by the solid angle under which a near point sees them.
//!
//! Uniform samples by area have a density by solid angle of d² / (A |cos θ|). Near a surface it varies over its points by large
//! factors, which a sample uniform in the solid angle avoids.
//!
//! Tests: near_lights_are_sampled_by_solid_angle.

use glam::{Vec2, Vec3};

use crate::math::lanes::{Lanes, One, Vector, VectorF64};
use crate::math::{SphericalRectangle, SphericalTriangle};

/// Number of radii within which a surface is near. Farther surfaces are sampled by area, which is cheaper and hardly noisier.
pub(crate) const NEAR: f32 = 2.5;

/// Whether a surface is near a point.
///
/// - `center`, `radius`: of a sphere around the surface (m)
fn is_near(from: Vec3, center: Vec3, radius: f32) -> bool {
    (from - center).length_squared() < NEAR * NEAR * (radius * radius)
}

/// A near triangle as seen from a point; `None` if it is to be sampled by area.
pub(super) fn triangle([a, b, c]: [Vec3; 3], from: Vec3) -> Option<SphericalTriangle> {
    let center = (a + b + c) / 3.0;
    let radius2 = [a, b, c].map(|corner| (corner - center).length_squared()).into_iter().fold(0.0, f32::max);
    is_near(from, center, radius2.sqrt()).then(|| SphericalTriangle::new([a - from, b - from, c - from])).flatten()
}

/// A near rectangle as seen from a point; `None` if it is to be sampled by area.
pub(super) fn rectangle([a, b, c, d]: [Vec3; 4], from: Vec3) -> Option<SphericalRectangle> {
    let is_near = is_near(from, 0.5 * (a + c), 0.5 * (c - a).length());
    is_near.then(|| SphericalRectangle::new(a - from, [b - a, d - a])).flatten()
}

/// Coordinates of the point p = a + x (b − a) + y (c − a) that is seen in the direction `w`.
pub(super) fn in_direction(corners: [Vec3; 3], from: Vec3, w: Vec3) -> Vec2 {
    in_direction_lanes::<One>(corners, from.into(), w.into()).into()
}

/// [`in_direction`] in each lane.
#[inline(always)]
pub(crate) fn in_direction_lanes<L: Lanes>(corners: [Vec3; 3], from: Vector<L>, w: Vector<L>) -> [L::F32; 2] {
    let [a, b, c] = [corners[0].as_dvec3(), corners[1].as_dvec3(), corners[2].as_dvec3()];
    let n = (b - a).cross(c - a);
    let [a, x, y, normal] = [VectorF64::<L>::splat(a), VectorF64::splat(b - a), VectorF64::splat(c - a), VectorF64::splat(n)];
    let (line, w, square) = (a - from.widened(), w.widened(), L::f64(n.length_squared()));
    let p = w.scaled(normal.dot(line) / normal.dot(w)) - line;
    let at = [L::narrow(p.cross(y).dot(normal) / square), L::narrow(x.cross(p).dot(normal) / square)];
    let (zero, one, infinity) = (L::f32(0.0), L::f32(1.0), L::f32(f32::INFINITY));
    // A rounded direction may pass beside the surface.
    let is_finite = L::lt(L::abs(at[0]), infinity) & L::lt(L::abs(at[1]), infinity);
    [L::select(is_finite, L::min(L::max(at[0], zero), one), zero), L::select(is_finite, L::min(L::max(at[1], zero), one), zero)]
}
