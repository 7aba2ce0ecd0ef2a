//! Pieces of curves: cubic Bézier curves with a radius, and their change along the curve.

use glam::{DVec3, DVec4, Vec4Swizzles as _};

use crate::math::Aabb;
use crate::shape::Capsule;

/// Cubic Bézier curve Σ C(3, k) sᵏ (1 − s)³⁻ᵏ bₖ for 0 ≤ s ≤ 1, whose control points bₖ have a position (m) and, as the fourth coordinate,
/// the radius (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cubic(pub [DVec4; 4]);

/// A curve at one of its points: position and radius, and their first and second derivative by the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Local {
    pub value: DVec4,
    pub first: DVec4,
    pub second: DVec4,
}

impl Cubic {
    /// The part from s = a to s = b, by blossoms: its control points are f(a, a, a), f(a, a, b), f(a, b, b) and f(b, b, b), where f takes a step
    /// of de Casteljau's algorithm at each of three parameters.
    pub fn part(&self, [a, b]: [f64; 2]) -> Cubic {
        let between = |p: DVec4, q: DVec4, s: f64| p * (1.0 - s) + q * s;
        let [p, q, r, t] = self.0;
        let once = |s: f64| [between(p, q, s), between(q, r, s), between(r, t, s)];
        let twice = |[p, q, r]: [DVec4; 3], s: f64| [between(p, q, s), between(q, r, s)];
        let (at_a, at_b) = (once(a), once(b));
        let [aa, ab, bb] = [twice(at_a, a), twice(at_a, b), twice(at_b, b)];
        let last = |[p, q]: [DVec4; 2], s: f64| between(p, q, s);
        Cubic([last(aa, a), last(aa, b), last(ab, b), last(bb, b)])
    }

    /// The parts before and after s = ½.
    pub fn halves(&self) -> [Cubic; 2] {
        let [b0, b1, b2, b3] = self.0;
        let (c0, c1, c2) = (0.5 * (b0 + b1), 0.5 * (b1 + b2), 0.5 * (b2 + b3));
        let (d0, d1) = (0.5 * (c0 + c1), 0.5 * (c1 + c2));
        let e = 0.5 * (d0 + d1);
        [Cubic([b0, c0, d0, e]), Cubic([e, d1, c2, b3])]
    }

    /// The curve at `s`.
    pub fn at(&self, s: f64) -> Local {
        let [b0, b1, b2, b3] = self.0;
        let between = |a: DVec4, b: DVec4| a * (1.0 - s) + b * s;
        let (c0, c1, c2) = (between(b0, b1), between(b1, b2), between(b2, b3));
        let (d0, d1) = (between(c0, c1), between(c1, c2));
        let second = between(b2 - b1 - (b1 - b0), b3 - b2 - (b2 - b1));
        Local { value: between(d0, d1), first: 3.0 * (d1 - d0), second: 6.0 * second }
    }

    /// Whether this curve and the next, which begins at its end, differ there in their direction, or in how fast they widen.
    pub fn has_kink(&self, next: &Cubic) -> bool {
        let slope = |cubic: &Cubic, s: f64| {
            let first = cubic.at(s).first;
            (cubic.tangent(s), if first.xyz() == DVec3::ZERO { 0.0 } else { first.w / first.xyz().length() })
        };
        let ((a, widens), (b, widens_next)) = (slope(self, 1.0), slope(next, 0.0));
        (a - b).length() > KINK || (widens - widens_next).abs() > KINK
    }

    /// Greatest radius of the control points, which no radius of the curve exceeds (m).
    pub fn greatest_radius(&self) -> f64 {
        self.0.into_iter().map(|b| b.w).fold(0.0, f64::max)
    }

    /// A capsule that contains all points that are no further from the curve than its radius there.
    ///
    /// The points of the curve are as far from those of its chord as the curve of the differences says, which lies in the hull of the control
    /// points of its four parts. The capsule's axis is the chord, moved by half of the mean difference of the inner control points.
    pub fn capsule(&self) -> Capsule {
        let [start, .., end] = self.0.map(|b| b.xyz());
        let difference = |k: usize| self.0[k].xyz() - start.lerp(end, k as f64 / 3.0);
        let shift = 0.25 * (difference(1) + difference(2));
        let differences = Cubic([0, 1, 2, 3].map(|k| (difference(k) - shift).extend(self.0[k].w)));
        let parts = differences.halves().into_iter().flat_map(|half| half.halves());
        let radius = parts.flat_map(|part| part.0).map(|b| b.xyz().length() + b.w).fold(0.0, f64::max);
        Capsule { ends: [start + shift, end + shift], radius }
    }

    /// A box that contains all points that are no further from the curve than its radius there.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let low = self.0.into_iter().map(|b| b.xyz() - b.w).fold(DVec3::INFINITY, DVec3::min);
        let high = self.0.into_iter().map(|b| b.xyz() + b.w).fold(DVec3::NEG_INFINITY, DVec3::max);
        (low, high)
    }

    /// [`Cubic::bounds`] in f32.
    pub fn aabb(&self) -> Aabb {
        let (min, max) = self.bounds();
        Aabb { min: min.as_vec3(), max: max.as_vec3() }
    }

    /// The unit tangent at `s`. Where control points coincide at an end, it is the limit there.
    pub fn tangent(&self, s: f64) -> DVec3 {
        let [b0, b1, b2, b3] = self.0.map(|b| b.xyz());
        let limits = if s < 0.5 { [b1 - b0, b2 - b0, b3 - b0] } else { [b3 - b2, b3 - b1, b3 - b0] };
        let candidates = [self.at(s).first.xyz()].into_iter().chain(limits);
        candidates.into_iter().find_map(DVec3::try_normalize).unwrap_or(DVec3::Z)
    }
}

/// Least difference of directions at which two curves meet in a kink. Smaller ones come from the rounding of control points.
const KINK: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    fn bend() -> Cubic {
        let points = [[0.0, 0.0, 0.0, 0.2], [1.0, 0.3, -0.4, 0.1], [1.2, 1.5, 0.2, 0.15], [0.3, 2.0, 1.0, 0.05]];
        Cubic(points.map(DVec4::from_array))
    }

    /// A part has the points of the whole, and its derivatives are those of the whole times its length.
    #[test]
    fn parts_are_parts() {
        let (whole, part) = (bend(), bend().part([0.25, 0.75]));
        for k in 0..=8 {
            let s = f64::from(k) / 8.0;
            let (a, b) = (whole.at(0.25 + 0.5 * s), part.at(s));
            assert!((a.value - b.value).abs().max_element() < 1e-15, "{k}");
            assert!((0.5 * a.first - b.first).abs().max_element() < 1e-14 && (0.25 * a.second - b.second).abs().max_element() < 1e-14);
        }
    }

    /// All balls of a curve lie in its capsule, and one of them nearly touches it from within.
    #[test]
    fn capsules_contain_their_curves() {
        let Capsule { ends: [a, b], radius } = bend().capsule();
        let reaches = (0..=1000).map(|k| {
            let v = bend().at(f64::from(k) / 1000.0).value;
            let s = ((v.xyz() - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            (v.xyz() - a.lerp(b, s)).length() + v.w
        });
        let most = reaches.fold(0.0, f64::max);
        assert!(most <= radius && radius < 1.2 * most, "{radius}, of which {most} is needed");
    }

    /// Derivatives are the limits of differences: with steps of 10⁻⁵ they differ by 10⁻¹⁰ of a third derivative, and rounding by 10⁻⁵.
    #[test]
    fn derivatives_are_limits_of_differences() {
        let (cubic, step) = (bend(), 1e-5);
        for s in [0.0, 0.3, 0.9] {
            let [before, here, after] = [s - step, s, s + step].map(|s| cubic.at(s));
            assert!(((after.value - before.value) / (2.0 * step) - here.first).abs().max_element() < 1e-8, "{s}");
            assert!(((after.first - before.first) / (2.0 * step) - here.second).abs().max_element() < 1e-8, "{s}");
        }
    }

    /// Where two control points coincide, the derivative is 0, and the tangent is its limit.
    #[test]
    fn coincident_control_points_have_a_tangent() {
        let mut cubic = bend();
        cubic.0[1] = cubic.0[0];
        let expected = (cubic.0[2] - cubic.0[0]).xyz().normalize();
        assert!((cubic.tangent(0.0) - expected).length() < 1e-15);
        assert!((cubic.tangent(1e-9) - expected).length() < 1e-8);
        assert_eq!(Cubic([cubic.0[0]; 4]).tangent(0.5), DVec3::Z);
    }
}
