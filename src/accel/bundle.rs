//! Bundles: up to eight slender items of a leaf, such as pieces of hair, which are tested side by side by capsules around them.
//!
//! Seen along the ray, a capsule of the radius R is what lies no further than R from a segment from p to p + e. The ray is the origin there, and
//! passes the capsule at the distance
//!
//!   |p + s e|    with    s = −p·e / e²,    limited to 0 ≤ s ≤ 1.
//!
//! Coordinates are whole numbers of 16 bits, in a power of two as the unit, from a corner of the bundle. The corner is brought into the system of
//! the ray in f64, so that far rays keep their digits, and what follows in f32 is the same at all scales.

use glam::DVec3;

use crate::math::Ray;
use crate::math::simd::{Lanes, dot, splat};
use crate::shape::Capsule;

/// Greatest number of items in a bundle.
pub const SIZE: usize = 8;

/// Capsules around some items.
// Two cache lines.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub struct Bundle {
    /// Origin of the coordinates (m).
    corner: [f32; 3],
    /// Number of units per metre, a power of two.
    per_unit: f32,
    /// Coordinates of both ends, and radii, item by item. Lanes without an item have the radius 0, and those with one have more.
    rows: [[u16; SIZE]; 7],
}

/// The greatest number that is used for coordinates and radii, so that a radius which is enlarged by three of them has 16 bits.
const GREATEST: f64 = 65532.0;

/// The numbers of 16 bits, as a bound of coordinates.
const REACH: f32 = 65536.0;

/// A ray's system: two directions perpendicular to it.
pub struct View {
    origin: DVec3,
    axes: [DVec3; 2],
    /// Sum of the coordinates of the origin, without their signs (m).
    magnitude: f64,
}

impl View {
    /// The system of a ray.
    pub fn new(ray: &Ray) -> View {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (x, y) = (direction / direction.length()).any_orthonormal_pair();
        View { origin, axes: [x, y], magnitude: origin.abs().element_sum() }
    }
}

/// Error of the f32 computation, relative to the coordinates. With p = (p₁, p₂) for the bundle's corner and all numbers of 16 bits below E, an end
/// is a sum of four terms, each component of which has an error of at most u (2 |pᵢ| + 12 E), for u = 2⁻²⁴; the difference e adds
/// u (2 |pᵢ| + 4 E), the rounding of s moves the point by u (3 |p| + 16 E), and the rest are u (|pᵢ| + 3 E). In all, the distance has an error
/// below u (16 (|p₁| + |p₂|) + 64 E).
const ROUNDED: f32 = 16.0 * 0.5 * f32::EPSILON;

/// Error of positions in f64, relative to the coordinates: here, and where the item itself is tested.
const ROUNDED_F64: f64 = 64.0 * f64::EPSILON;

impl Bundle {
    /// - `capsules`: from 1 to [`SIZE`] of them
    pub fn new(capsules: &[Capsule]) -> Bundle {
        let ends = || capsules.iter().flat_map(|capsule| capsule.ends);
        let corner = ends().fold(DVec3::INFINITY, DVec3::min).as_vec3();
        let extent = (ends().fold(DVec3::NEG_INFINITY, DVec3::max) - corner.as_dvec3()).max_element();
        let greatest = capsules.iter().map(|capsule| capsule.radius).fold(extent, f64::max);
        let per_unit = power_of_two_below(GREATEST / greatest).clamp(1.0 / MOST_UNITS, MOST_UNITS);
        let mut rows = [[0; SIZE]; 7];
        for (lane, Capsule { ends, radius }) in capsules.iter().enumerate().take(SIZE) {
            let mut aside = 0f64;
            for (k, end) in ends.iter().enumerate() {
                let exact = (*end - corner.as_dvec3()) * per_unit;
                let rounded = exact.round().clamp(DVec3::ZERO, DVec3::splat(GREATEST));
                aside = aside.max((exact - rounded).length());
                for axis in 0..3 {
                    rows[3 * k + axis][lane] = rounded[axis] as u16;
                }
            }
            rows[6][lane] = (radius * per_unit + aside).ceil().max(1.0) as u16;
        }
        Bundle { corner: corner.to_array(), per_unit: per_unit as f32, rows }
    }

    /// Bit mask of the lanes whose capsules the line of a ray may meet. It contains all that it meets.
    ///
    /// Tests: capsules_that_a_ray_meets_are_kept.
    #[inline(always)]
    pub fn may_hit<L: Lanes>(&self, view: &View) -> u32 {
        let ([a, b, c], per_unit) = (self.corner, f64::from(self.per_unit));
        let corner = DVec3::new(a.into(), b.into(), c.into());
        let from = corner - view.origin;
        let rounding = ROUNDED_F64 * (from.abs().element_sum() + view.magnitude) * per_unit;
        let [x, y] = view.axes;
        let (px, py) = ((from.dot(x) * per_unit) as f32, (from.dot(y) * per_unit) as f32);
        let slack = ROUNDED * (px.abs() + py.abs() + 4.0 * REACH) + rounding as f32;
        let [[x0, x1, x2], [y0, y1, y2]] = [x.as_vec3().to_array(), y.as_vec3().to_array()];
        let [ax, ay] = [self.seen::<L>(0, [x0, x1, x2], px), self.seen::<L>(0, [y0, y1, y2], py)];
        let [bx, by] = [self.seen::<L>(3, [x0, x1, x2], px), self.seen::<L>(3, [y0, y1, y2], py)];
        let (ex, ey) = (bx.minus(ax), by.minus(ay));
        let along = L::splat(0.0).minus(ax.times(ex).plus(ay.times(ey)));
        // Where the ray runs along the axis and e is 0, so is the bound: s = 0.
        let s = along.over(ex.times(ex).plus(ey.times(ey))).larger(L::splat(0.0)).smaller(L::splat(1.0));
        let (qx, qy) = (ax.plus(s.times(ex)), ay.plus(s.times(ey)));
        let radius = L::load_u16(&self.rows[6]);
        let bound = radius.plus(L::splat(slack));
        let is_beyond = bound.times(bound).below(qx.times(qx).plus(qy.times(qy)));
        !is_beyond & L::splat(0.0).below(radius)
    }

    /// Coordinates along an axis of the ends that begin with some row.
    #[inline(always)]
    fn seen<L: Lanes>(&self, row: usize, axis: [f32; 3], corner: f32) -> L {
        let [x, y, z] = [L::load_u16(&self.rows[row]), L::load_u16(&self.rows[row + 1]), L::load_u16(&self.rows[row + 2])];
        dot([x, y, z], splat(axis)).plus(L::splat(corner))
    }
}

/// Bound of [`Bundle::per_unit`], so that it and its inverse are normal numbers of f32.
const MOST_UNITS: f64 = (1u128 << 126) as f64;

/// The greatest power of two up to a positive number.
fn power_of_two_below(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
    f64::from_bits(x.to_bits() & !MANTISSA)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::math::simd::Halves;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0).prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// A capsule is kept whose radius is the distance at which a ray passes its axis, and left out if the radius is less by a thousandth of
        /// the bundle's extent of about 1: axes of all lengths, rays from near and from far, also along the axis, at all scales.
        #[test]
        fn capsules_that_a_ray_meets_are_kept(
            start in vector(),
            along in vector(),
            length in prop_oneof![Just(1.0), Just(1e-2), Just(1e-4), Just(0.0)],
            others in prop::collection::vec(vector(), 1..SIZE),
            aim in vector(),
            aside in prop_oneof![Just(0.0), Just(1e-3), Just(0.1), Just(3.0)],
            distance in prop_oneof![Just(0.0), Just(1.0), Just(1e2), Just(1e5)],
            is_along in prop::bool::weighted(0.1),
            exponent in prop_oneof![Just(0), -60i32..60],
        ) {
            let scale = 2f64.powi(exponent);
            let ends = [start * scale, (start + along * length) * scale];
            let mut capsules: Vec<Capsule> = others.iter().map(|p| Capsule { ends: [*p * scale; 2], radius: 1e-3 * scale }).collect();
            let lane = capsules.len() / 2;
            let direction = if is_along { along + 1e-3 * aim } else { aim }.normalize_or(DVec3::X);
            let target = ends[0].midpoint(ends[1]) + aim.cross(along).normalize_or(DVec3::Y) * (aside * scale);
            let ray = Ray::new((target - direction * (distance * scale)).as_vec3(), direction.as_vec3());
            // What follows is about the ray as it is rounded.
            let d = ray.direction.as_dvec3().normalize();
            let [a, b] = ends.map(|end| { let v = end - ray.origin.as_dvec3(); v - d * v.dot(d) });
            let e = b - a;
            let s = if e == DVec3::ZERO { 0.0 } else { (-a.dot(e) / e.length_squared()).clamp(0.0, 1.0) };
            let passes = (a + e * s).length();
            let mut is_kept = |radius: f64| {
                capsules.truncate(others.len());
                capsules.insert(lane, Capsule { ends, radius });
                capsules.truncate(SIZE);
                let kept = Bundle::new(&capsules).may_hit::<Halves>(&View::new(&ray));
                assert!(kept < 1 << capsules.len(), "lanes without an item are kept");
                kept >> lane & 1 == 1
            };
            prop_assert!(is_kept(passes), "a capsule that the ray touches is left out");
            let less = passes - 1e-3 * scale * (1.0 + aside);
            prop_assert!(less < 0.0 || !is_kept(less), "a capsule that the ray passes is kept");
        }
    }
}
