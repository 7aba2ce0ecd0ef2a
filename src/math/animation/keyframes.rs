//! Keyframes: transforms at some times, and what is between them.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::polar;
use crate::error::{Error, Fault, Result};
use crate::math::Transform;
use crate::math::float::{atan2_f64, sin_cos_f64};

/// Transforms at two or more times. Before the first and after the last the transform stays as it is there.
///
/// Each transform is divided into a translation, a rotation, and a scale along perpendicular axes (which, together with the rotation, may
/// be a shear), M = T R S. Between two keyframes T and S change evenly, and R turns at an even speed by the shorter way:
///
/// M(w) = T(w) R(w) S(w),    T(w) = T₀ + w (T₁ − T₀),    S(w) = S₀ + w (S₁ − S₀),    R(w) = R₀ (a aᵀ + (1 − a aᵀ) cos wθ + (a×) sin wθ)
///
/// where a and θ are the axis and the angle of R₀⁻¹ R₁. Because both S are positive definite, or both negative definite, so is each S(w),
/// and the transform has an inverse at any time.
///
/// Source: Shoemake and Duff, *Matrix Animation and Polar Decomposition* (1992).
/// Tests: rotations_turn_evenly, keyframes_are_met, inverses_undo.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    times: Vec<f64>,
    transforms: Vec<Transform>,
    /// What is between each keyframe and the next.
    segments: Vec<Segment>,
}

/// Transforms between two keyframes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segment {
    /// Translation at the start, and its change.
    pub translation: [DVec3; 2],
    /// Rotation and scale; `None` if they do not change.
    pub turn: Option<Turn>,
    /// Linear part at the start, and its inverse.
    pub linear: [DMat3; 2],
    flips: bool,
}

/// Rotation and scale that change.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Turn {
    /// Angle θ, from 0 to π (rad).
    pub angle: f64,
    /// R₀ a aᵀ, R₀ (1 − a aᵀ) and R₀ (a×).
    pub parts: [DMat3; 3],
    /// Scale at the start, and its change.
    pub stretch: [DMat3; 2],
}

impl Keyframes {
    /// Transforms at times. One keyframe is a transform that does not change.
    ///
    /// # Errors
    /// `Invalid` without keyframes, for times that are not finite or do not increase, for keyframes of which only some mirror, and for
    /// transforms that are singular within rounding.
    pub fn new(keys: &[(f64, Transform)]) -> Result<Keyframes> {
        if keys.is_empty() {
            return Err(refused("no keyframes".into()));
        }
        for (i, (time, _)) in keys.iter().enumerate() {
            let is_later = i == 0 || *time > keys[i - 1].0;
            if !(time.is_finite() && is_later) {
                return Err(refused(format!("keyframe {i} is at {time} s, expected a time after that of the keyframe before it")));
            }
        }
        let mirrors = |(_, transform): &(f64, Transform)| transform.flips_handedness();
        if let Some(i) = keys.iter().position(|key| mirrors(key) != mirrors(&keys[0])) {
            let [mirrored, other] = if mirrors(&keys[i]) { [i, 0] } else { [0, i] };
            let message =
                format!("keyframe {mirrored} mirrors and keyframe {other} does not: between the two, what moves would be flattened");
            return Err(refused(message));
        }
        let parts: Option<Vec<(DMat3, DMat3)>> = keys.iter().map(|(_, transform)| polar::decomposed(transform.matrix().matrix3)).collect();
        let parts = parts.ok_or_else(|| refused("a keyframe flattens what it transforms".into()))?;
        let segment = |i: usize| Segment::new([&keys[i].1, &keys[i + 1].1], [parts[i], parts[i + 1]]);
        let segments = (0..keys.len() - 1).map(segment).collect();
        Ok(Keyframes { times: keys.iter().map(|key| key.0).collect(), transforms: keys.iter().map(|key| key.1).collect(), segments })
    }

    /// The transform at a time.
    pub fn at(&self, time: f64) -> Transform {
        let next = self.times.partition_point(|key| *key <= time);
        let Some(before) = next.checked_sub(1) else { return self.transforms[0] };
        match self.segments.get(before) {
            Some(segment) if time > self.times[before] => segment.at((time - self.times[before]) / (self.times[next] - self.times[before])),
            _ => self.transforms[before],
        }
    }

    /// The part of the keyframes from the time `open` to `close`, with times as fractions of that interval. If both are the same, the
    /// transform of that time.
    ///
    /// # Errors
    /// Those of [`Keyframes::new`].
    pub fn during(&self, open: f64, close: f64) -> Result<Keyframes> {
        let within = self.times.iter().copied().filter(|time| open < *time && *time < close);
        let mut times: Vec<f64> = std::iter::once(open).chain(within).chain([close]).collect();
        times.dedup();
        let length = if close > open { close - open } else { 1.0 };
        let key = |time: f64| ((time - open) / length, self.at(time));
        Keyframes::new(&times.into_iter().map(key).collect::<Vec<_>>())
    }

    /// The transform, if it does not change.
    pub fn constant(&self) -> Option<Transform> {
        self.transforms.iter().all(|transform| *transform == self.transforms[0]).then_some(self.transforms[0])
    }

    /// Times of the keyframes.
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// The transforms of the keyframes themselves.
    pub(super) fn transforms(&self) -> &[Transform] {
        &self.transforms
    }

    /// What is between the keyframes; empty for a single one.
    pub(super) fn segments(&self) -> &[Segment] {
        &self.segments
    }
}

impl Segment {
    /// Transforms between two, each with its rotation and scale.
    fn new(ends: [&Transform; 2], [(start, stretch), (end, end_stretch)]: [(DMat3, DMat3); 2]) -> Segment {
        let [matrix, last] = ends.map(Transform::matrix);
        let turn = (matrix.matrix3 != last.matrix3).then(|| Turn::new([start, end], [stretch, end_stretch]));
        let translation = [matrix.translation, last.translation - matrix.translation];
        Segment { translation, turn, linear: [matrix.matrix3, ends[0].inverse_matrix().matrix3], flips: ends[0].flips_handedness() }
    }

    /// The transform at the fraction `w` of the way.
    fn at(&self, w: f64) -> Transform {
        let translation = self.translation[0] + self.translation[1] * w;
        let [linear, inverse] = self.turn.as_ref().map_or(self.linear, |turn| turn.at(w));
        Transform::of_parts([linear, inverse], translation, self.flips)
    }
}

/// Angle below which rotations are the same within rounding (rad).
const SAME: f64 = 8.0 * f64::EPSILON;

impl Turn {
    fn new([start, end]: [DMat3; 2], [stretch, end_stretch]: [DMat3; 2]) -> Turn {
        let (axis, angle) = axis_angle(start.transpose() * end);
        let along = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        let cross = DMat3::from_cols(DVec3::new(0.0, axis.z, -axis.y), DVec3::new(-axis.z, 0.0, axis.x), DVec3::new(axis.y, -axis.x, 0.0));
        let parts = [start * along, start * (DMat3::IDENTITY - along), start * cross];
        Turn { angle, parts, stretch: [stretch, end_stretch - stretch] }
    }

    /// Linear part and its inverse at the fraction `w` of the way.
    fn at(&self, w: f64) -> [DMat3; 2] {
        let (sin, cos) = sin_cos_f64(self.angle * w);
        let rotation = self.parts[0] + self.parts[1] * cos + self.parts[2] * sin;
        let stretch = self.stretch[0] + self.stretch[1] * w;
        [rotation * stretch, stretch.inverse() * rotation.transpose()]
    }
}

/// Unit axis and angle, from 0 to π, of a rotation. For half a turn either axis.
///
/// sin θ a = ½ (R₃₂ − R₂₃, R₁₃ − R₃₁, R₂₁ − R₁₂),    cos θ = ½ (tr R − 1),    (1 − cos θ) a aᵀ = ½ (R + Rᵀ) − cos θ
fn axis_angle(r: DMat3) -> (DVec3, f64) {
    let (x, y, z) = (r.x_axis, r.y_axis, r.z_axis);
    let sine = 0.5 * DVec3::new(y.z - z.y, z.x - x.z, x.y - y.x);
    let cos = 0.5 * (x.x + y.y + z.z - 1.0);
    let angle = atan2_f64(sine.length(), cos).min(PI);
    if angle <= SAME {
        return (DVec3::Z, 0.0);
    }
    if cos >= 0.0 {
        return (sine.normalize(), angle);
    }
    // Beyond a quarter turn the sine gets small, and the symmetric part is the more precise.
    let symmetric = (r + r.transpose()) * 0.5 - DMat3::IDENTITY * cos;
    let columns = [symmetric.x_axis, symmetric.y_axis, symmetric.z_axis];
    let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::Z).normalize();
    (if longest.dot(sine) < 0.0 { -longest } else { longest }, angle)
}

fn refused(why: String) -> Error {
    Error::invalid(Fault::new(why))
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;

    fn turned(axis: DVec3, degrees: f64) -> Transform {
        Transform::rotate(axis, degrees).expect("an axis")
    }

    fn greatest(m: DMat3) -> f64 {
        m.to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    fn between(a: Transform, b: Transform) -> Keyframes {
        Keyframes::new(&[(0.0, a), (1.0, b)]).expect("sound keyframes")
    }

    /// A turn by up to half a turn passes each angle at its share of the time, also for the smallest angles and for half a turn.
    #[test]
    fn rotations_turn_evenly() {
        for (k, degrees) in [1e-9, 1e-3, 1.0, 60.0, 90.0, 120.0, 179.0, 179.999_999, 180.0].into_iter().enumerate() {
            let axis = DVec3::new(0.3, -0.5 + k as f64, 0.8);
            let start = turned(DVec3::new(-0.2, 0.7, 0.1), 77.0);
            let keyframes = between(start, start.then(&turned(axis, degrees)));
            for w in [0.125, 0.5, 0.75] {
                let (found, expected) = (keyframes.at(w).matrix().matrix3, start.then(&turned(axis, degrees * w)).matrix().matrix3);
                let reversed = start.then(&turned(axis, -degrees * w)).matrix().matrix3;
                let off = greatest(found - expected);
                let is_half_turn = degrees == 180.0 && greatest(found - reversed) < 1e-14;
                assert!(off < 4e-15 + 1e-9 * (degrees > 179.0 && degrees < 180.0) as u8 as f64 || is_half_turn, "{degrees}° {w}: {off:e}");
                assert!(greatest(found.transpose() * found - DMat3::IDENTITY) < 4e-15, "{degrees}°");
            }
        }
    }

    /// T5: the way from an orientation to itself is that orientation, however it is written. For a million pairs the rotation at a
    /// random time keeps all lengths to 10⁻¹⁴.
    #[test]
    fn rotations_keep_lengths() {
        let once = turned(DVec3::new(1.0, 2.0, 3.0), 400.0);
        let again = turned(DVec3::new(-1.0, -2.0, -3.0), 320.0);
        let found = between(once, again).at(0.5).matrix().matrix3;
        assert!(greatest(found - once.matrix().matrix3) < 1e-15);
        let count = 1_000_000;
        let mut worst = 0.0f64;
        for k in 0..count {
            let k = f64::from(k);
            let axis = |a: f64| DVec3::new((a * k).sin(), (1.7 * a * k).cos(), (0.3 * a * k + a).sin());
            let (a, b) = (DMat3::from_axis_angle(axis(1.1).normalize(), 0.7 * k), DMat3::from_axis_angle(axis(0.9).normalize(), 1.3 * k));
            let [r, inverse] = Turn::new([a, b], [DMat3::IDENTITY; 2]).at((0.618 * k).fract());
            worst = worst.max(greatest(r * r.transpose() - DMat3::IDENTITY)).max(greatest(r * inverse - DMat3::IDENTITY));
        }
        assert!(worst < 1e-14, "{worst:e}");
    }

    /// At its time each keyframe is met to the bit, and before the first and after the last nothing changes.
    #[test]
    fn keyframes_are_met() {
        let keys: Vec<(f64, Transform)> = (0..4)
            .map(|k| {
                let k = f64::from(k);
                let scale = Transform::scale(DVec3::new(1.0 + k, 2.0, 0.5)).expect("not zero");
                (
                    0.25 * k * k,
                    scale.then(&turned(DVec3::new(k, 1.0, 0.3), 70.0 * k)).then(&Transform::translate(DVec3::splat(k)).expect("finite")),
                )
            })
            .collect();
        let keyframes = Keyframes::new(&keys).expect("sound");
        for (time, transform) in &keys {
            assert_eq!(keyframes.at(*time), *transform);
        }
        assert_eq!((keyframes.at(-1.0), keyframes.at(9.0)), (keys[0].1, keys[3].1));
        for pair in keys.windows(2) {
            // Near to each keyframe the transform is near to it.
            let (early, late) = (keyframes.at(pair[0].0 + 1e-12), keyframes.at(pair[1].0 - 1e-12));
            let near = |a: Transform, b: Transform| a.matrix().abs_diff_eq(b.matrix(), 1e-10);
            assert!(near(early, pair[0].1) && near(late, pair[1].1));
        }
        let part = keyframes.during(0.1, 1.1).expect("sound");
        for k in 0..=20 {
            let w = f64::from(k) / 20.0;
            assert!(part.at(w).matrix().abs_diff_eq(keyframes.at(0.1 + w).matrix(), 1e-12), "{w}");
        }
        assert_eq!(keyframes.during(0.25, 0.25).expect("sound").constant(), Some(keys[1].1));
        assert_eq!(keyframes.during(5.0, 6.0).expect("sound").constant(), Some(keys[3].1));
    }

    /// The inverse undoes the transform at any time, also where a mirrored, sheared shape changes its size.
    #[test]
    fn inverses_undo() {
        let shear = Transform::from_matrix(glam::DMat4::from_cols_array(&[
            1.0, 0.0, 0.0, 0.0, 0.7, 1.0, 0.2, 0.0, 0.0, 0.0, -2.0, 0.0, 3.0, 4.0, 5.0, 1.0,
        ]))
        .expect("regular");
        let end =
            shear.then(&turned(DVec3::new(1.0, 1.0, 0.2), 100.0)).then(&Transform::scale(DVec3::new(0.2, 3.0, 1.0)).expect("not zero"));
        let keyframes = between(shear, end);
        for k in 0..=100 {
            let transform = keyframes.at(f64::from(k) / 100.0);
            let product = transform.matrix() * transform.inverse_matrix();
            assert!(product.abs_diff_eq(DAffine3::IDENTITY, 1e-13), "{product}");
            assert!(transform.flips_handedness() && transform.determinant() < 0.0);
        }
    }

    /// What cannot be interpolated is refused.
    #[test]
    fn impossible_keyframes_are_refused() {
        let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).expect("not zero");
        let still = Transform::IDENTITY;
        let refused = [
            vec![],
            vec![(0.0, still), (0.0, still)],
            vec![(1.0, still), (0.5, still)],
            vec![(f64::NAN, still)],
            vec![(0.0, still), (f64::INFINITY, still)],
            vec![(0.0, still), (1.0, mirror)],
        ];
        for keys in refused {
            assert!(Keyframes::new(&keys).is_err(), "{keys:?}");
        }
    }
}
