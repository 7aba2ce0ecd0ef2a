//! Equal-area map between the unit square and the sphere.
//!
//! The square is folded to an octahedron and inflated to the sphere: its middle becomes +z, its four corners −z, and the diamond between
//! the middles of its sides the equator. Equal areas of the square become equal solid angles.
//!
//! Source: Clarberg, *Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD* (2008); the orientation is that of pbrt-v4.
//! Tests: the_square_maps_to_the_sphere_as_in_pbrt, equal_areas_are_equal_solid_angles.

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3};

use super::float::{atan2, sin_cos_octant};

/// Direction of a point of the unit square.
///
/// With p = 2·square − 1 and the signed distance d = 1 − |pₓ| − |p_y| to the equator: r = 1 − |d|, z = ±(1 − r²).
pub fn square_to_sphere(square: Vec2) -> Vec3 {
    let p = 2.0 * square - 1.0;
    let side = p.abs();
    let d = 1.0 - (side.x + side.y);
    let r = 1.0 - d.abs();
    // Angle in the first quadrant, π/4 (1 + (y − x)/r), computed from the nearer axis because a sine of up to π/4 suffices then.
    let (x, y) = if d >= 0.0 { (side.x, side.y) } else { (1.0 - side.y, 1.0 - side.x) };
    let angle = if r == 0.0 { 0.0 } else { FRAC_PI_4 * (2.0 * x.min(y) / r).min(1.0) };
    let (sin, cos) = sin_cos_octant(angle);
    let (along_x, along_y) = if y < x { (cos, sin) } else { (sin, cos) };
    let radius = r * (2.0 - r * r).sqrt();
    Vec3::new((radius * along_x).copysign(p.x), (radius * along_y).copysign(p.y), (1.0 - r * r).copysign(d))
}

/// Point of the unit square that [`square_to_sphere`] maps to a unit direction.
pub fn sphere_to_square(w: Vec3) -> Vec2 {
    let side = w.abs();
    // r = √(1 − |z|), by the sine where |z| is nearly 1.
    let r = (w.truncate().length_squared() / (1.0 + side.z)).sqrt().min(1.0);
    // Share of the quarter turn from the x axis.
    let share = atan2(side.y, side.x) / (2.0 * FRAC_PI_4);
    let (x, y) = (r * (1.0 - share), r * share);
    let (x, y) = if w.z < 0.0 { (1.0 - y, 1.0 - x) } else { (x, y) };
    (0.5 * (Vec2::new(x.copysign(w.x), y.copysign(w.y)) + 1.0)).clamp(Vec2::ZERO, Vec2::ONE)
}
