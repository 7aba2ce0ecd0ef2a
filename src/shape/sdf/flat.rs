//! Flat primitives: boxes and half-spaces.

use glam::DVec3;

use super::dual::Scalar;
use super::space::{dot, length, offset};

/// Box with rounded edges: |max(q, 0)| + min(max q, 0) − r,  q = |p − c| − h + r, where h is half the size.
#[derive(Clone, Debug, PartialEq)]
pub struct Cuboid {
    /// Lower corner (m).
    pub low: DVec3,
    /// Upper corner (m).
    pub high: DVec3,
    /// Radius r of the rounded edges, which lie within the box (m).
    pub rounding: f64,
}

impl Cuboid {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let half = (self.high - self.low) * 0.5;
        let beyond = |x: S, h: f64| x.abs().plus(self.rounding - h);
        let [x, y, z] = offset(p, self.low + half);
        let [x, y, z] = [beyond(x, half.x), beyond(y, half.y), beyond(z, half.z)];
        let zero = S::constant(0.0);
        let outside = length([x.max(zero), y.max(zero), z.max(zero)]);
        (outside + x.max(y).max(z).min(zero)).plus(-self.rounding)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        [self.low - grow, self.high + grow]
    }
}

/// Box by the greatest of six plane distances: max over axes of max(low − p, p − high).
///
/// Outside, near an edge or a corner, this Chebyshev distance is less than the Euclidean distance, so that marching is slower. Inside
/// the box they are equal.
#[derive(Clone, Debug, PartialEq)]
pub struct ChebyshevBox {
    /// Lower corner (m).
    pub low: DVec3,
    /// Upper corner (m).
    pub high: DVec3,
}

impl ChebyshevBox {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let below = offset(p, self.low).map(|x| -x);
        let above = offset(p, self.high);
        below[0].max(above[0]).max(below[1].max(above[1])).max(below[2].max(above[2]))
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        [self.low - grow, self.high + grow]
    }
}

/// Half-space behind a plane: (p − a)·n
#[derive(Clone, Debug, PartialEq)]
pub struct HalfSpace {
    /// Point a of the plane (m).
    pub point: DVec3,
    /// Unit normal n, pointing out of the half-space.
    pub normal: DVec3,
}

impl HalfSpace {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        dot(offset(p, self.point), self.normal)
    }

    /// Bounds, which are finite on one side if the plane is perpendicular to an axis.
    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let (mut low, mut high) = (DVec3::NEG_INFINITY, DVec3::INFINITY);
        for axis in 0..3 {
            if self.normal[axis] == 1.0 {
                high[axis] = self.point[axis] + grow;
            } else if self.normal[axis] == -1.0 {
                low[axis] = self.point[axis] - grow;
            }
        }
        [low, high]
    }
}
