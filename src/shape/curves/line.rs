//! Rays as the axis of a coordinate system in which curves are met.

use glam::{DVec2, DVec3, Vec3Swizzles as _, Vec4Swizzles as _};

use super::piece::Cubic;
use crate::math::Ray;
use crate::shape::HIT_ROUNDING;

/// A ray as the z axis of a coordinate system whose origin is the point of the ray nearest to a piece, so that far rays keep their digits.
pub(super) struct Line {
    origin: DVec3,
    axes: [DVec3; 3],
    /// Distance of the origin along the ray, in units of its direction's length.
    start: f64,
    /// Length of the direction.
    length: f64,
    /// Rounding error of positions in the system (m).
    pub rounding: f64,
}

impl Line {
    /// - `middle`: a point near the piece (m)
    pub fn new(ray: &Ray, middle: DVec3) -> Line {
        let (origin, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let length = d.length();
        let z = d / length;
        let (x, y) = z.any_orthonormal_pair();
        let start = (middle - origin).dot(z);
        let rounding = HIT_ROUNDING * ((middle - origin).length() + middle.length());
        Line { origin: origin + z * start, axes: [x, y, z], start: start / length, length, rounding }
    }

    /// A vector in the system.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        let [x, y, z] = self.axes;
        DVec3::new(v.dot(x), v.dot(y), v.dot(z))
    }

    /// A curve in the system.
    pub fn seen(&self, piece: &Cubic) -> Cubic {
        Cubic(piece.0.map(|b| self.vector(b.xyz() - self.origin).extend(b.w)))
    }

    /// The ray parameter at the height `z` (m).
    pub fn t(&self, z: f64) -> f64 {
        self.start + z / self.length
    }

    /// A point of the ray in world space (m).
    pub fn point(&self, z: f64) -> DVec3 {
        self.origin + self.axes[2] * z
    }

    /// The range of the parameter outside of which a curve is further from the ray than its radius, or behind `t_max` or the origin; `None`
    /// if all of it is.
    pub fn near(&self, seen: &Cubic, t_max: f32) -> Option<[f64; 2]> {
        let radius = seen.greatest_radius();
        let (low, high) = extent(seen.0.map(|b| b.z));
        if self.t(high + radius) < 0.0 || self.t(low - radius) > f64::from(t_max) {
            return None;
        }
        let (mut part, mut range) = (*seen, [0.0, 1.0]);
        for _ in 0..MOST_CLIPS {
            let [from, to] = clip(&part)?;
            let length = range[1] - range[0];
            range = [range[0] + from * length, range[1] - (1.0 - to) * length];
            if to - from > WORTHWHILE {
                break;
            }
            part = seen.part(range);
        }
        Some(range)
    }
}

/// Greatest number of times that a curve is clipped.
const MOST_CLIPS: u32 = 4;

/// The share that is left of a curve above which another clip gains little.
const WORTHWHILE: f64 = 0.5;

/// Rounding error of clipped ranges.
const MARGIN: f64 = 1e-12;

/// Least and greatest of four numbers.
fn extent(of: [f64; 4]) -> (f64, f64) {
    of.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// The range of the parameter in which a curve may be as near to the z axis as its radius, by one step of Bézier clipping: the curve lies in the
/// hull of its control points, across its chord, and along the chord as a function of the parameter.
///
/// Source: Nishita, Sederberg, Kakimoto, *Ray Tracing Trimmed Rational Surface Patches* (1990).
fn clip(seen: &Cubic) -> Option<[f64; 2]> {
    let ([b0, .., b3], radius) = (seen.0, seen.greatest_radius());
    let along = (b3 - b0).xyz().xy().try_normalize().unwrap_or(DVec2::X);
    let (low, high) = extent(seen.0.map(|b| b.xyz().xy().dot(along.perp())));
    if low > radius || high < -radius {
        return None;
    }
    let x = seen.0.map(|b| b.xyz().xy().dot(along));
    let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut include = |s: f64| (from, to) = (from.min(s), to.max(s));
    let at = |k: usize| k as f64 / 3.0;
    for i in 0..4 {
        if x[i].abs() <= radius {
            include(at(i));
        }
        for j in i + 1..4 {
            for side in [-radius, radius] {
                if (x[i] < side) != (x[j] < side) {
                    include(at(i) + (at(j) - at(i)) * ((side - x[i]) / (x[j] - x[i])));
                }
            }
        }
    }
    (from <= to).then(|| [(from - MARGIN).max(0.0), (to + MARGIN).min(1.0)])
}
