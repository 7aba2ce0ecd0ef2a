//! Unit vectors in six bytes.

use glam::{DVec2, DVec3, Vec3Swizzles as _};

/// A unit vector v as a point of the octahedron |x| + |y| + |z| = 1, seen along z.
///
/// (x, y) = v_xy/(|vₓ| + |v_y| + |v_z|),    z = ±(1 − |x| − |y|)
///
/// Points with z ≥ 0 fill the diamond |x| + |y| ≤ 1 within a square. A point with z < 0 is reflected across the nearest edge of the diamond, to
/// (1 − |y|, 1 − |x|) with the signs of x and y, so that the lower half fills the corners of the square. Each of the two numbers is an integer of
/// 24 bits, so that the vector changes by less than 2.6·10⁻⁷. A zero vector stays zero.
///
/// Source: Meyer, Süßmuth, Sußner, Stamminger and Greiner, *On Floating-Point Normal Vectors* (2010).
/// Tests: packed_normals_keep_their_direction.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct PackedNormal([u8; 6]);

/// The integer of 1.
const ONE: f64 = 8_388_607.0;
/// The value of zero vectors: a number below −1.
const ZERO: PackedNormal = PackedNormal([0, 0, 0x80, 0, 0, 0x80]);

impl PackedNormal {
    pub fn new(v: DVec3) -> PackedNormal {
        let sum = v.abs().element_sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return ZERO;
        }
        let p = v.xy() / sum;
        let [x, y] = if v.z < 0.0 { mirrored(p) } else { p }.to_array().map(|x| ((x * ONE).round() as i32).to_le_bytes());
        PackedNormal([x[0], x[1], x[2], y[0], y[1], y[2]])
    }

    pub fn unit(self) -> DVec3 {
        if self == ZERO {
            return DVec3::ZERO;
        }
        let PackedNormal([a, b, c, d, e, f]) = self;
        // The sign is that of the highest byte.
        let [x, y] = [[0, a, b, c], [0, d, e, f]].map(|bytes| f64::from(i32::from_le_bytes(bytes) >> 8));
        let p = DVec2::new(x, y) / ONE;
        let z = 1.0 - p.abs().element_sum();
        if z < 0.0 { mirrored(p) } else { p }.extend(z).normalize()
    }
}

/// Reflects a point across the nearest edge of the diamond |x| + |y| = 1.
fn mirrored(p: DVec2) -> DVec2 {
    let far = 1.0 - p.abs();
    DVec2::new(far.y.copysign(p.x), far.x.copysign(p.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions on a grid in a cube, along its axes and diagonals, and close to them.
    #[test]
    fn packed_normals_keep_their_direction() {
        let steps: Vec<f64> = (-12..=12).map(|k| f64::from(k) / 12.0).chain([-1e-9, 1e-9, -1e-30, 1e-30, 0.7 - 1e-8, 0.7 + 3e-7]).collect();
        for (x, y) in steps.iter().flat_map(|x| steps.iter().map(move |y| (*x, *y))) {
            for z in &steps {
                let v = DVec3::new(x, y, *z);
                let wanted = v.try_normalize().unwrap_or(DVec3::ZERO);
                let found = PackedNormal::new(v).unit();
                assert!((found - wanted).length() < 2.6e-7, "{found}, not {wanted}");
            }
        }
        assert_eq!(PackedNormal::new(DVec3::NAN).unit(), DVec3::ZERO);
        assert_eq!(size_of::<PackedNormal>(), 6);
    }
}
