//! Round primitives: points within a distance of a point, a segment or a ring.

use glam::DVec3;

use super::dual::Scalar;
use super::space::{dot, length, offset};

/// Ball: |p − c| − r
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    /// Centre c (m).
    pub center: DVec3,
    /// Radius r (m).
    pub radius: f64,
}

impl Ball {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        length(offset(p, self.center)).plus(-self.radius)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let reach = DVec3::splat(self.radius + grow);
        [self.center - reach, self.center + reach]
    }
}

/// Capsule, a segment with a radius: |p − a − h (b − a)| − r,  h = (p − a)·(b − a) / |b − a|² in [0, 1]
#[derive(Clone, Debug, PartialEq)]
pub struct Capsule {
    from: DVec3,
    line: DVec3,
    /// line / |line|², whose product with p − a is h.
    scaled_line: DVec3,
    radius: f64,
}

impl Capsule {
    /// A capsule around the segment between two different points.
    ///
    /// - `radius`: in metres
    pub fn new(from: DVec3, to: DVec3, radius: f64) -> Capsule {
        let line = to - from;
        Capsule { from, line, scaled_line: line / line.length_squared(), radius }
    }

    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let from = offset(p, self.from);
        let share = dot(from, self.scaled_line).max(S::constant(0.0)).min(S::constant(1.0));
        let apart = |axis: usize| from[axis] - share.times(self.line[axis]);
        length([apart(0), apart(1), apart(2)]).plus(-self.radius)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let reach = DVec3::splat(self.radius + grow);
        let to = self.from + self.line;
        [self.from.min(to) - reach, self.from.max(to) + reach]
    }
}

/// Torus around c in the plane z = c.z: √((√(x² + y²) − R)² + z²) − r, or its half at x > 0 with round ends.
///
/// The distance to the half at x ≤ 0 is that to the nearer end (0, ±R, 0).
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    /// Centre c (m).
    pub center: DVec3,
    /// Radius R of the circle (m).
    pub radius: f64,
    /// Radius r of the tube (m).
    pub tube: f64,
    /// Whether only the half with x > c.x exists.
    pub half: bool,
}

impl Ring {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let [x, y, z] = offset(p, self.center);
        let line = if self.half && x.value() <= 0.0 {
            length([x, y.abs().plus(-self.radius), z])
        } else {
            let outwards = (x * x + y * y).sqrt().plus(-self.radius);
            (outwards * outwards + z * z).sqrt()
        };
        line.plus(-self.tube)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let tube = DVec3::splat(self.tube + grow);
        let west = if self.half { 0.0 } else { -self.radius };
        let (low, high) = (DVec3::new(west, -self.radius, 0.0), DVec3::new(self.radius, self.radius, 0.0));
        [self.center + low - tube, self.center + high + tube]
    }
}
