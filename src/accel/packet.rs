//! Four triangles side by side, and a quick test that rejects most of them.

use glam::Vec3;

use crate::math::Ray;
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
    edge: [f32; LANES],
    pub item: [u32; LANES],
}

impl Packet {
    /// At most [`LANES`] triangles.
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

    /// A bit for each lane that the exact test might accept: all that it would, and few others.
    ///
    /// Möller and Trumbore's products in f32, each compared with a slack that bounds its rounding:
    /// with edges ≤ e, |origin − corner| ≤ s per axis and |d| ≤ 1, a triple product is a sum of six terms
    /// ≤ s·e (or e²), each rounded at most seven times: its error is below 2⁻²⁴·6·7·s·e. Taken: 2⁻²⁴·128·(s + e)·e.
    /// Where the determinant itself is within that slack, the lane is kept.
    ///
    /// Source of the products: Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection* (1997).
    /// Tests: watertight, hierarchy_equals_list.
    #[inline(always)]
    pub fn candidates(&self, ray: &Ray) -> u32 {
        let o = ray.origin.to_array();
        let d = ray.direction.to_array();
        let [a, b, c] = &self.corner;
        let mut keep = [false; LANES];
        for i in 0..LANES {
            let e1 = [b[0][i] - a[0][i], b[1][i] - a[1][i], b[2][i] - a[2][i]];
            let e2 = [c[0][i] - a[0][i], c[1][i] - a[1][i], c[2][i] - a[2][i]];
            let s = [o[0] - a[0][i], o[1] - a[1][i], o[2] - a[2][i]];
            let p = cross(d, e2);
            let det = dot(e1, p);
            let u = dot(s, p);
            let q = cross(s, e1);
            let v = dot(d, q);
            let sign = det.to_bits() & 0x8000_0000;
            let flip = |x: f32| f32::from_bits(x.to_bits() ^ sign);
            let (det, u, v) = (flip(det), flip(u), flip(v));
            let far = max(max(s[0].abs(), s[1].abs()), s[2].abs());
            let e = self.edge[i];
            let slack = 128.0 * 0.5 * f32::EPSILON * (far + e) * e;
            let inside = (u >= -slack) & (v >= -slack) & (u + v <= det + slack);
            keep[i] = inside | (det < slack);
        }
        (0..LANES).fold(0, |mask, i| mask | (keep[i] as u32) << i)
    }

    /// The exact test of one lane.
    #[inline]
    pub fn intersect(&self, lane: usize, ray: &Ray) -> Option<ShapeHit> {
        let corner = |k: usize| Vec3::new(self.corner[k][0][lane], self.corner[k][1][lane], self.corner[k][2][lane]);
        triangle::intersect(ray, [corner(0), corner(1), corner(2)])
    }
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
