//! Packets of eight triangles, with a fast conservative test.

use glam::Vec3;

use crate::math::Ray;
use crate::math::float::ROUNDING;
use crate::math::simd::{Lanes, splat};
use crate::shape::ShapeHit;
use crate::shape::triangle::{self, Tolerance};

/// Number of triangles in a packet.
pub const LANES: usize = 8;

/// Up to eight triangles. Unused lanes reject every ray.
#[repr(align(64))]
#[derive(Clone)]
pub struct Packet {
    /// Coordinates by corner, axis and lane.
    corner: [[[f32; LANES]; 3]; 3],
    /// Greatest |coordinate| of the edges from corner 0; NaN in unused lanes, for which every comparison is false.
    edge: [f32; LANES],
    /// Item numbers.
    pub item: [u32; LANES],
}

impl Packet {
    /// A packet of at most [`LANES`] triangles with their item numbers.
    pub fn new(triangles: &[(u32, [Vec3; 3])]) -> Packet {
        let mut packet = Packet { corner: [[[0.0; LANES]; 3]; 3], edge: [f32::NAN; LANES], item: [u32::MAX; LANES] };
        for (lane, (item, corners)) in triangles.iter().enumerate() {
            for (k, corner) in corners.iter().enumerate() {
                for axis in 0..3 {
                    packet.corner[k][axis][lane] = corner[axis];
                }
            }
            let [a, b, c] = *corners;
            packet.edge[lane] = (b - a).abs().max((c - a).abs()).max_element();
            packet.item[lane] = *item;
        }
        packet
    }

    /// Bit mask of the lanes that the exact test may accept. It contains all lanes that the test accepts, and few others.
    ///
    /// The test computes the products of Möller and Trumbore in f32 and compares each with a bound of its rounding error. With edges ≤ e,
    /// |origin − corner| ≤ s per axis and |d| ≤ 1, a triple product is a sum of six terms ≤ s·e (or e²), each rounded at most seven times,
    /// so that its error is below 2⁻²⁴·6·7·s·e. The bound used is 2⁻²⁴·128·(s + e)·e. A lane whose determinant is within this bound is
    /// kept. The numerator of t has one more factor e. A tolerance τ allows for products that are 2 √3 τ e < 4 τ e less than 0.
    ///
    /// Source: Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection* (1997).
    /// Tests: watertight, the_hierarchy_finds_what_a_linear_search_finds.
    #[inline(always)]
    pub fn candidates<L: Lanes, T: Tolerance>(&self, ray: &Ray, t_max: f32, tolerance: T) -> u32 {
        let (o, d) = (splat(ray.origin.to_array()), splat(ray.direction.to_array()));
        let corner = |k: usize| [L::load(&self.corner[k][0]), L::load(&self.corner[k][1]), L::load(&self.corner[k][2])];
        let (a, edge) = (corner(0), L::load(&self.edge));
        let (e1, e2, s) = (minus(corner(1), a), minus(corner(2), a), minus(o, a));
        let (p, q) = (cross(d, e2), cross(s, e1));
        let det = dot(e1, p);
        let (u, v, t) = (dot(s, p).signed_by(det), dot(d, q).signed_by(det), dot(e2, q).signed_by(det));
        let det = det.signed_by(det);
        let far = s[0].size().larger(s[1].size()).larger(s[2].size());
        let mut slack = L::splat(128.0 * ROUNDING).times(far.plus(edge)).times(edge);
        if !T::IS_EXACT {
            slack = slack.plus(L::splat(4.0 * tolerance.get()).times(edge));
        }
        let below = L::splat(0.0).minus(slack);
        let inside = below.at_most(u) & below.at_most(v) & u.plus(v).at_most(det.plus(slack));
        // t may overflow although the other products do not. NaN counts as neither behind nor beyond.
        let beyond = det.plus(slack).times(L::splat(t_max)).plus(slack.times(edge)).below(t);
        let elsewhere = t.below(below.times(edge)) | beyond;
        (inside & !elsewhere) | det.below(slack)
    }

    /// Exact test of one lane.
    #[inline(always)]
    pub fn intersect<T: Tolerance>(&self, lane: usize, ray: &Ray, t_max: f32, tolerance: T) -> Option<ShapeHit> {
        let corner = |k: usize| Vec3::new(self.corner[k][0][lane], self.corner[k][1][lane], self.corner[k][2][lane]);
        triangle::intersect_with_tolerance(ray, t_max, [corner(0), corner(1), corner(2)], tolerance)
    }
}

#[inline(always)]
fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0].minus(b[0]), a[1].minus(b[1]), a[2].minus(b[2])]
}

#[inline(always)]
fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    let minor = |i: usize, j: usize| a[i].times(b[j]).minus(a[j].times(b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].times(b[0]).plus(a[1].times(b[1])).plus(a[2].times(b[2]))
}
