//! Bounding boxes of what moves.

use glam::{BVec3, DMat3, DVec3};

use super::keyframes::{Keyframes, Segment};
use crate::math::Transform;
use crate::math::float::sin_cos_f64;

/// Bounding box of a box over all times.
///
/// The image of a box at any time is the convex hull of its corners, so that the box around the ways of the eight corners contains it.
///
/// - `before`, `after`: fixed transforms before and after the keyframes
///
/// Tests: rows T6 and T7 of `pt torture`, turns_about_an_axis_are_bounded_in_little_time.
pub fn moved([low, high]: [DVec3; 2], before: &Transform, keyframes: &Keyframes, after: &Transform) -> [DVec3; 2] {
    let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    if !low.cmple(high).all() {
        return nothing;
    }
    let corners = (0..8).map(|k| DVec3::select(BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low)).map(|p| before.point(p));
    let keys: Vec<(&Transform, Transform)> = keyframes.transforms().iter().map(|key| (key, key.then(after))).collect();
    let ways = corners.flat_map(|p| {
        let segments = keyframes.segments().iter().map(move |segment| way(segment, after, p));
        segments.chain(keys.iter().map(move |(key, both)| {
            let rounding = ROUNDINGS * (size(after, size(key, p.abs())));
            // The end of a way differs from this place by the rounding of the decomposition.
            let place = both.point(p);
            [place - rounding, place + rounding]
        }))
    });
    ways.fold(nothing, |[low, high], [from, to]| [low.min(from), high.max(to)])
}

/// Sum of the absolute terms of each coordinate of a transformed point, whose own coordinates have the absolute terms `p`. Rounding is relative to
/// it, also where the terms cancel.
fn size(transform: &Transform, p: DVec3) -> DVec3 {
    absolute(transform.matrix().matrix3) * p + transform.matrix().translation.abs()
}

fn absolute(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// Bounding box of the way of a point.
fn way(segment: &Segment, after: &Transform, p: DVec3) -> [DVec3; 2] {
    let fixed = after.matrix();
    let start = fixed.matrix3 * segment.translation[0] + fixed.translation;
    let change = fixed.matrix3 * segment.translation[1];
    let terms = match &segment.turn {
        None => absolute(segment.linear[0]) * p.abs(),
        Some(turn) => {
            let stretched = (absolute(turn.stretch[0]) + absolute(turn.stretch[1])) * p.abs();
            turn.parts.iter().map(|part| absolute(*part) * stretched).sum()
        }
    };
    let size = size(after, terms + segment.translation[0].abs() + segment.translation[1].abs());
    let bounds = |axis: usize| {
        let rounding = ROUNDINGS * size[axis];
        let mut curve = Curve { c: [start[axis], change[axis]], d: [0.0; 2], e: [0.0; 2], angle: 0.0, rounding };
        let linear = |m: DMat3, v: DVec3| (fixed.matrix3 * (m * v))[axis];
        match &segment.turn {
            None => curve.c[0] += linear(segment.linear[0], p),
            Some(turn) => {
                for (k, stretch) in turn.stretch.iter().enumerate() {
                    let v = *stretch * p;
                    curve.c[k] += linear(turn.parts[0], v);
                    curve.d[k] = linear(turn.parts[1], v);
                    curve.e[k] = linear(turn.parts[2], v);
                }
                curve.angle = turn.angle;
            }
        }
        curve.range()
    };
    let [x, y, z] = [bounds(0), bounds(1), bounds(2)];
    [DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1])]
}

/// Coordinate of a moving point:
///
/// x(w) = c₀ + c₁ w + (d₀ + d₁ w) cos θw + (e₀ + e₁ w) sin θw,    0 ≤ w ≤ 1
struct Curve {
    c: [f64; 2],
    d: [f64; 2],
    e: [f64; 2],
    /// Angle θ, from 0 to π.
    angle: f64,
    /// Bound of the rounding of a coordinate.
    rounding: f64,
}

/// Interval of numbers.
type Interval = [f64; 2];

/// Number of halvings after which a stretch of the way counts as short. What the bounds exceed the way by is quadratic in its length, and
/// so 2⁻³³ of the size of the way.
const HALVINGS: u32 = 16;

/// Roundings in a coordinate, relative to the sum of its terms.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

impl Curve {
    /// Least and greatest coordinate on the whole way, or a little beyond.
    fn range(&self) -> Interval {
        let rounding = self.rounding;
        let mut range = hull([self.at(0.0); 2], [self.at(1.0); 2]);
        if self.angle > 0.0 {
            self.extend(&mut range, [0.0, 1.0], (HALVINGS, rounding));
        }
        [range[0] - rounding, range[1] + rounding]
    }

    /// Extends a range, in which the ends of a stretch are, by what is between them.
    ///
    /// A stretch on which the bounds of the derivative exclude 0 is monotonic, and has no more than its ends. Others are halved, unless they are
    /// short or what they can add is no more than rounding, as for a coordinate along the axis of the turn.
    fn extend(&self, range: &mut Interval, [from, to]: Interval, (halvings, rounding): (u32, f64)) {
        let slope = self.slope([from, to]);
        if slope[0] > 0.0 || slope[1] < 0.0 {
            return;
        }
        let middle = 0.5 * (from + to);
        let x = self.at(middle);
        let most = slope[1].max(-slope[0]) * 0.5 * (to - from);
        if halvings == 0 || most <= rounding {
            *range = hull(*range, [x - most, x + most]);
            return;
        }
        *range = hull(*range, [x; 2]);
        self.extend(range, [from, middle], (halvings - 1, rounding));
        self.extend(range, [middle, to], (halvings - 1, rounding));
    }

    fn at(&self, w: f64) -> f64 {
        let (sin, cos) = sin_cos_f64(self.angle * w);
        self.c[0] + self.c[1] * w + (self.d[0] + self.d[1] * w) * cos + (self.e[0] + self.e[1] * w) * sin
    }

    /// Bounds of the derivative on a stretch:
    ///
    /// x′(w) = c₁ + (d₁ + θ (e₀ + e₁ w)) cos θw + (e₁ − θ (d₀ + d₁ w)) sin θw
    fn slope(&self, [from, to]: Interval) -> Interval {
        let ends = [from, to].map(|w| sin_cos_f64(self.angle * w));
        // Within half a turn the cosine falls, and the sine has its maximum at a quarter turn.
        let cos = [ends[1].1, ends[0].1];
        let has_top = cos[0] <= 0.0 && cos[1] >= 0.0;
        let sin = [ends[0].0.min(ends[1].0), if has_top { 1.0 } else { ends[0].0.max(ends[1].0) }];
        let linear = |a: f64, b: f64| hull([a + b * from; 2], [a + b * to; 2]);
        let of_cos = linear(self.d[1] + self.angle * self.e[0], self.angle * self.e[1]);
        let of_sin = linear(self.e[1] - self.angle * self.d[0], -self.angle * self.d[1]);
        let (a, b) = (product(of_cos, cos), product(of_sin, sin));
        [self.c[1] + a[0] + b[0], self.c[1] + a[1] + b[1]]
    }
}

/// Smallest interval around two.
fn hull(a: Interval, b: Interval) -> Interval {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Products of the numbers of two intervals.
fn product(a: Interval, b: Interval) -> Interval {
    let products = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
    [products.into_iter().fold(f64::INFINITY, f64::min), products.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::math::AnimatedTransform;

    /// A coordinate along the axis of a turn does not change. It must not be halved to the end: 2¹⁷ evaluations for each corner would take
    /// tens of milliseconds, and a lamp of ten thousand triangles minutes. These thousand bounds take some milliseconds.
    #[test]
    fn turns_about_an_axis_are_bounded_in_little_time() {
        let start = Instant::now();
        for axis in DVec3::AXES {
            let end = Transform::rotate(axis, 120.0).expect("an axis");
            let motion = AnimatedTransform::from(Keyframes::new(&[(0.0, Transform::IDENTITY), (1.0, end)]).expect("sound"));
            for k in 0..333 {
                let corner = DVec3::new(1.0, 2.0, f64::from(k));
                let [low, high] = motion.bounds([corner, corner + 1.0]);
                let along = |v: DVec3| v.dot(axis);
                assert!((along(low) - along(corner)).abs() < 1e-9 && (along(high) - along(corner + 1.0)).abs() < 1e-9);
            }
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    }
}
