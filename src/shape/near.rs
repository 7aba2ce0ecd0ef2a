//! Sampling of flat surfaces by the solid angle under which a near point sees them.
//!
//! Uniform samples by area have a density by solid angle of d² / (A |cos θ|). Near a surface it varies over its points by large
//! factors, which a sample uniform in the solid angle avoids.
//!
//! Tests: near_lights_are_sampled_by_solid_angle.

use glam::{DVec3, Vec2, Vec3};

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
pub(super) fn in_direction([a, b, c]: [Vec3; 3], from: Vec3, w: Vec3) -> Vec2 {
    let [a, b, c, from, w] = [a, b, c, from, w].map(Vec3::as_dvec3);
    let (x, y, line) = (b - a, c - a, a - from);
    let n = x.cross(y);
    let p: DVec3 = w * (n.dot(line) / n.dot(w)) - line;
    let at = Vec2::new((p.cross(y).dot(n) / n.length_squared()) as f32, (x.cross(p).dot(n) / n.length_squared()) as f32);
    // A rounded direction may pass beside the surface.
    if at.is_finite() { at.clamp(Vec2::ZERO, Vec2::ONE) } else { Vec2::ZERO }
}
