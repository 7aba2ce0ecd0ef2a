//! Equal-area map between the unit square and the sphere.
//!
//! The square is folded to an octahedron and inflated to the sphere: its middle becomes +z, its four corners −z, and the diamond between
//! the middles of its sides the equator. Equal areas of the square become equal solid angles.
//!
//! Source: Clarberg, *Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD* (2008); the orientation is that of pbrt-v4.
//! Tests: the_square_maps_to_the_sphere_as_in_pbrt, equal_areas_are_equal_solid_angles.

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3};

use super::float::{atan2_lanes, sin_cos_octant_lanes};
use super::lanes::{Lanes, One, Vector};

/// Direction of a point of the unit square.
pub fn square_to_sphere(square: Vec2) -> Vec3 {
    square_to_sphere_lanes::<One>(square.to_array()).into()
}

/// Point of the unit square that [`square_to_sphere`] maps to a unit direction.
pub fn sphere_to_square(w: Vec3) -> Vec2 {
    sphere_to_square_lanes::<One>(w.into()).into()
}

/// [`square_to_sphere`] in each lane.
///
/// With p = 2·square − 1 and the signed distance d = 1 − |pₓ| − |p_y| to the equator: r = 1 − |d|, z = ±(1 − r²).
#[inline(always)]
pub fn square_to_sphere_lanes<L: Lanes>(square: [L::F32; 2]) -> Vector<L> {
    let (zero, one, two) = (L::f32(0.0), L::f32(1.0), L::f32(2.0));
    let p = [two * square[0] - one, two * square[1] - one];
    let side = [L::abs(p[0]), L::abs(p[1])];
    let d = one - (side[0] + side[1]);
    let r = one - L::abs(d);
    // Angle in the first quadrant, π/4 (1 + (y − x)/r), computed from the nearer axis because a sine of up to π/4 suffices then.
    let is_upper = L::le(zero, d);
    let (x, y) = (L::select(is_upper, side[0], one - side[1]), L::select(is_upper, side[1], one - side[0]));
    // At the poles, 0/0 becomes 0.
    let angle = L::f32(FRAC_PI_4) * L::min(two * L::min(x, y) / L::max(r, L::f32(f32::MIN_POSITIVE)), one);
    let (sin, cos) = sin_cos_octant_lanes::<L>(angle);
    let is_flat = L::lt(y, x);
    let (along_x, along_y) = (L::select(is_flat, cos, sin), L::select(is_flat, sin, cos));
    let radius = r * L::sqrt(two - r * r);
    Vector { x: L::copysign(radius * along_x, p[0]), y: L::copysign(radius * along_y, p[1]), z: L::copysign(one - r * r, d) }
}

/// [`sphere_to_square`] in each lane.
#[inline(always)]
pub fn sphere_to_square_lanes<L: Lanes>(w: Vector<L>) -> [L::F32; 2] {
    let (zero, one) = (L::f32(0.0), L::f32(1.0));
    // r = √(1 − |z|), by the sine where |z| is nearly 1.
    let r = L::min(L::sqrt((w.x * w.x + w.y * w.y) / (one + L::abs(w.z))), one);
    // Share of the quarter turn from the x axis.
    let share = atan2_lanes::<L>(L::abs(w.y), L::abs(w.x)) / L::f32(2.0 * FRAC_PI_4);
    let (x, y) = (r * (one - share), r * share);
    let is_lower = L::lt(w.z, zero);
    let (x, y) = (L::select(is_lower, one - y, x), L::select(is_lower, one - x, y));
    let (x, y) = (L::f32(0.5) * (L::copysign(x, w.x) + one), L::f32(0.5) * (L::copysign(y, w.y) + one));
    [L::min(L::max(x, zero), one), L::min(L::max(y, zero), one)]
}
