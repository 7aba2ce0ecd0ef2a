//! Four triangles side by side, and a quick test that rejects most of them.

use glam::{Vec3, Vec4};

use crate::math::Ray;
use crate::math::float::ROUNDING;
use crate::shape::ShapeHit;
use crate::shape::triangle;

pub const LANES: usize = 4;

/// Up to four triangles; unused lanes reject every ray.
#[repr(align(16))]
#[derive(Clone)]
pub struct Packet {
    /// Corner, axis, lane.
    corner: [[[f32; LANES]; 3]; 3],
    /// The largest |coordinate| of the edges from corner 0; NaN in unused lanes, which fails every comparison.
    edge: Vec4,
    pub item: [u32; LANES],
}

impl Packet {
    /// At most [`LANES`] triangles.
    pub fn new(triangles: &[(u32, [Vec3; 3])]) -> Packet {
        let mut packet = Packet { corner: [[[0.0; LANES]; 3]; 3], edge: Vec4::NAN, item: [u32::MAX; LANES] };
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

    /// A bit for each lane that the exact test might accept: all that it would, and few others.
    ///
    /// Möller and Trumbore's products in f32, each compared with a slack that bounds its rounding:
    /// with edges ≤ e, |origin − corner| ≤ s per axis and |d| ≤ 1, a triple product is a sum of six terms
    /// ≤ s·e (or e²), each rounded at most seven times: its error is below 2⁻²⁴·6·7·s·e. Taken: 2⁻²⁴·128·(s + e)·e.
    /// Where the determinant itself is within that slack, the lane is kept. The numerator of t has one edge more.
    ///
    /// Source of the products: Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection* (1997).
    /// Tests: watertight, hierarchy_is_the_list.
    #[inline(always)]
    pub fn candidates(&self, ray: &Ray, t_max: f32) -> u32 {
        let o = ray.origin.to_array().map(Vec4::splat);
        let d = ray.direction.to_array().map(Vec4::splat);
        let [a, b, c] = self.corner.map(|corner| corner.map(Vec4::from_array));
        let (e1, e2, s) = (minus(b, a), minus(c, a), minus(o, a));
        let (p, q) = (cross(d, e2), cross(s, e1));
        let (det, u, v, t) = (dot(e1, p), dot(s, p), dot(d, q), dot(e2, q));
        let sign = Vec4::ONE.copysign(det);
        let (det, u, v, t) = (det * sign, u * sign, v * sign, t * sign);
        let far = s[0].abs().max(s[1].abs()).max(s[2].abs());
        let slack = 128.0 * ROUNDING * (far + self.edge) * self.edge;
        let inside = u.cmpge(-slack) & v.cmpge(-slack) & (u + v).cmple(det + slack);
        // t may overflow where the others do not: what is NaN is neither behind nor beyond.
        let elsewhere = t.cmplt(-slack * self.edge) | t.cmpgt((det + slack) * t_max + slack * self.edge);
        ((inside & !elsewhere) | det.cmplt(slack)).bitmask()
    }

    /// The exact test of one lane.
    #[inline(always)]
    pub fn intersect(&self, lane: usize, ray: &Ray, t_max: f32) -> Option<ShapeHit> {
        let corner = |k: usize| Vec3::new(self.corner[k][0][lane], self.corner[k][1][lane], self.corner[k][2][lane]);
        triangle::intersect(ray, t_max, [corner(0), corner(1), corner(2)])
    }
}

#[inline(always)]
fn minus(a: [Vec4; 3], b: [Vec4; 3]) -> [Vec4; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross(a: [Vec4; 3], b: [Vec4; 3]) -> [Vec4; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot(a: [Vec4; 3], b: [Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
