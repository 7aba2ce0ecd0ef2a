//! The test of one triangle.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::{Hit, Line, exact};

/// Hit of a ray without end with a triangle; the index is left to the caller.
///
/// The line passes within the triangle if it passes on the same side of all three edges. That side is also the one from which it comes,
/// and the origin must lie on it, outside of the plane.
pub fn hit(line: &Line, corners: [DVec3; 3]) -> Option<Hit> {
    let [a, b, c] = corners;
    let side = |p, q| exact::side(line.origin, line.scaled, p, q);
    let first = side(a, b);
    if first == Ordering::Equal || side(b, c) != first || side(c, a) != first || exact::height(line.origin, corners) != first {
        return None;
    }
    let (d, [a, b, c]) = (line.direction, corners.map(|corner| corner - line.origin));
    let normal = (b - a).cross(c - a);
    // Nearly in the plane the quotient loses its digits: the hit lies between the corners.
    let along = [a, b, c].map(|corner| corner.dot(d) / d.length_squared());
    let (near, far) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
    let quotient = normal.dot(a) / normal.dot(d);
    let t = if quotient.is_finite() { quotient.max(near).min(far) } else { near };
    let weights = DVec3::new(d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b)));
    let shares = (weights * if first == Ordering::Greater { 1.0 } else { -1.0 }).max(DVec3::ZERO);
    let sum = shares.element_sum();
    let uv = if sum > 0.0 { DVec2::new(shares.y, shares.z) / sum } else { DVec2::splat(1.0 / 3.0) };
    // Exactly, the distance is above 0.
    Some(Hit { t: t.max(f64::MIN_POSITIVE), triangle: 0, uv, enters: first == Ordering::Less })
}
