//! Bins of the sphere of directions, bounded by heights and azimuths.

use std::f64::consts::TAU;

use crate::math::Local;

/// Rectangle of the cylinder z × φ, whose area is the solid angle that it covers (Archimedes).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Lower and upper end of z, within −1 to 1.
    pub z: [f64; 2],
    /// Lower and upper end of φ, within 0 to 2π.
    pub phi: [f64; 2],
}

/// A direction as height z and azimuth φ.
pub type CylinderPoint = [f64; 2];

impl Rect {
    /// Half spheres below and above the surface; a density may jump between them.
    pub const HALVES: [Rect; 2] = [Rect { z: [-1.0, 0.0], phi: [0.0, TAU] }, Rect { z: [0.0, 1.0], phi: [0.0, TAU] }];

    /// Bin `i` of a grid of `rows` × `columns` equal bins, row by row from z = −1.
    pub fn bin(i: usize, rows: usize, columns: usize) -> Rect {
        let (row, column) = (i / columns, i % columns);
        // Multiples of a fraction: 0 is exact if `rows` is even.
        let z = [row, row + 1].map(|k| (2.0 * k as f64 - rows as f64) / rows as f64);
        let phi = [column, column + 1].map(|k| TAU * k as f64 / columns as f64);
        Rect { z, phi }
    }

    /// Index of the bin that holds a point.
    pub fn bin_of([z, phi]: CylinderPoint, rows: usize, columns: usize) -> usize {
        let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        index(0.5 * (z + 1.0), rows) * columns + index(phi / TAU, columns)
    }

    /// Solid angle of the bin.
    pub fn solid_angle(&self) -> f64 {
        (self.z[1] - self.z[0]) * (self.phi[1] - self.phi[0])
    }

    /// Centre of the bin.
    pub fn middle(&self) -> CylinderPoint {
        [self.z, self.phi].map(|[low, high]| 0.5 * (low + high))
    }

    /// The lower and the upper part when it is cut along one axis (0: z, 1: φ).
    pub fn cut(&self, axis: usize, at: f64) -> [Rect; 2] {
        let mut parts = [*self; 2];
        let side = |part: &mut Rect, end: usize| if axis == 0 { part.z[end] = at } else { part.phi[end] = at };
        side(&mut parts[0], 1);
        side(&mut parts[1], 0);
        parts
    }

    /// Distances of opposite edges along z and along φ (rad).
    pub fn extent(&self) -> [f64; 2] {
        let polar = |z: f64| 2.0 * (0.5 * (1.0 - z)).max(0.0).sqrt().min(1.0).asin();
        let widest = self.z[0].abs().min(self.z[1].abs());
        let widest = if self.z[0] * self.z[1] < 0.0 { 0.0 } else { widest };
        [polar(self.z[0]) - polar(self.z[1]), (self.phi[1] - self.phi[0]) * ((1.0 - widest) * (1.0 + widest)).sqrt()]
    }
}

/// Height and azimuth of a unit direction. Near the poles z is computed from the sine, which still separates directions there.
pub fn to_cylinder(w: Local) -> CylinderPoint {
    let [x, y, z] = w.0.to_array().map(f64::from);
    let height = if z.abs() > 0.5 { (1.0 - (x * x + y * y) / (1.0 + z.abs())).copysign(z) } else { z };
    let phi = y.atan2(x);
    [height, if phi < 0.0 { phi + TAU } else { phi }]
}

/// Direction with this height and azimuth.
pub fn direction([z, phi]: CylinderPoint) -> Local {
    super::options::at(z, phi)
}
