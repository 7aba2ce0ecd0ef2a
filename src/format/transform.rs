//! Transforms as scene files write them: steps that are applied in listed order.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::{Direction, Point, Real, Vector};
use crate::reader::by_kind;

/// Steps applied in listed order: the first acts in the object's own space, the last in world space.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct Transform(pub Vec<Step>);

impl Transform {
    /// Whether there are no steps.
    pub fn is_identity(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether there are keyframes among the steps.
    pub fn has_keyframes(&self) -> bool {
        self.0.iter().any(|step| matches!(step, Step::Keyframes(_)))
    }
}

/// One step of a transform: an object with exactly one key. Vectors are columns; the coordinates are right-handed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", try_from = "StepKeys")]
#[schemars(!try_from)]
pub enum Step {
    /// Moves by `[x, y, z]` metres.
    Translate(Vector),
    /// Scales about the origin by one factor, or by `[x, y, z]`; negative factors mirror.
    Scale(Scale),
    /// Rotates about an axis through the origin, counter-clockwise as seen with the axis pointing at the viewer.
    Rotate(Rotate),
    /// Places and rotates the object as `look_at` does for a camera: its −z axis points at `to`.
    LookAt(LookAt),
    /// Multiplies by a 4 × 4 matrix, given as 16 numbers row by row; the last row is `0, 0, 0, 1`.
    Matrix([Real; 16]),
    /// Moves: transforms at several times, see `shutter`. Shapes, groups, instances, lights and the camera can move.
    Keyframes(Vec<Keyframe>),
}

/// A transform at a time. Between two of them positions and sizes change evenly, and orientations turn evenly by the shorter way: a wheel
/// that turns by half a turn or more needs keyframes in between. Before the first and after the last nothing moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// The time, in seconds; later than that of the keyframe before it.
    pub time: Real,
    /// The transform at that time, without keyframes in it.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// When the shutter is open: what moves meanwhile is blurred.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Shutter {
    /// The time at which the shutter opens, in seconds.
    pub open: Real,
    /// The time at which it closes, in seconds. If it closes when it opens, the picture shows that moment.
    pub close: Real,
}

impl Default for Shutter {
    fn default() -> Shutter {
        Shutter { open: Real::known(0.0), close: Real::known(1.0) }
    }
}

impl Shutter {
    /// Whether these are the defaults.
    pub fn is_default(&self) -> bool {
        *self == Shutter::default()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StepKeys {
    translate: Option<Vector>,
    scale: Option<Scale>,
    rotate: Option<Rotate>,
    look_at: Option<LookAt>,
    matrix: Option<[Real; 16]>,
    keyframes: Option<Vec<Keyframe>>,
}

impl TryFrom<StepKeys> for Step {
    type Error = &'static str;

    fn try_from(keys: StepKeys) -> Result<Step, &'static str> {
        let StepKeys { translate, scale, rotate, look_at, matrix, keyframes } = keys;
        let mut steps = [
            translate.map(Step::Translate),
            scale.map(Step::Scale),
            rotate.map(Step::Rotate),
            look_at.map(Step::LookAt),
            matrix.map(Step::Matrix),
            keyframes.map(Step::Keyframes),
        ]
        .into_iter()
        .flatten();
        match (steps.next(), steps.next()) {
            (Some(step), None) => Ok(step),
            _ => Err("expected exactly one of translate, scale, rotate, look_at, matrix, keyframes in each step"),
        }
    }
}

/// A scaling: one factor, or one for each axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Scale {
    /// One factor for all axes.
    Uniform(f64),
    /// The factors along x, y and z.
    PerAxis([f64; 3]),
}

by_kind!(Scale { Number => Uniform(f64), Array => PerAxis([f64; 3]) });

/// A rotation about an axis through the origin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotate {
    /// The axis, of any length except 0.
    pub axis: Direction,
    /// The angle, in degrees.
    pub degrees: Real,
}

/// A position and a view direction. The local −z axis points from `from` to `to`, and the local +y axis is as close to `up` as possible.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LookAt {
    /// The position of the local origin, in metres.
    pub from: Point,
    /// The point that the local −z axis points at, in metres.
    pub to: Point,
    /// The direction that is up; it must not be parallel to the view direction.
    #[serde(default = "y_axis")]
    pub up: Direction,
}

fn y_axis() -> Direction {
    Direction([0.0, 1.0, 0.0])
}

impl Step {
    /// The key of this step in a scene file.
    pub fn key(&self) -> &'static str {
        match self {
            Step::Translate(_) => "translate",
            Step::Scale(_) => "scale",
            Step::Rotate(_) => "rotate",
            Step::LookAt(_) => "look_at",
            Step::Matrix(_) => "matrix",
            Step::Keyframes(_) => "keyframes",
        }
    }

    /// Checks that the step is an affine transform with an inverse.
    ///
    /// # Errors
    /// A message about a step without an inverse, or a matrix that is not affine, or keyframes.
    pub(crate) fn check(&self) -> Result<(), String> {
        match self {
            Step::Keyframes(_) => Err("only shapes, groups, instances, lights and the camera can move".into()),
            Step::Translate(_) | Step::Rotate(_) => Ok(()),
            Step::LookAt(look_at) => look_at.check(),
            Step::Scale(Scale::Uniform(s)) => invertible([[*s, 0.0, 0.0], [0.0, *s, 0.0], [0.0, 0.0, *s]]),
            Step::Scale(Scale::PerAxis([x, y, z])) => invertible([[*x, 0.0, 0.0], [0.0, *y, 0.0], [0.0, 0.0, *z]]),
            Step::Matrix(m) => check_matrix(&m.map(Real::get)),
        }
    }
}

impl LookAt {
    /// Checks that the view direction and `up` define an orientation.
    ///
    /// # Errors
    /// A message about `from` and `to` at the same point, or an `up` parallel to the view direction.
    pub(crate) fn check(&self) -> Result<(), String> {
        let [from, to] = [self.from.0, self.to.0];
        let direction = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        if length(direction) == 0.0 {
            return Err("from and to are the same point".into());
        }
        if length(cross(unit(direction), unit(self.up.0))) <= PARALLEL {
            return Err("up is parallel to the view direction".into());
        }
        Ok(())
    }
}

/// A bound of the sine that rounding leaves of the angle between two parallel vectors.
const PARALLEL: f64 = 4.0 * f64::EPSILON;

fn check_matrix(m: &[f64; 16]) -> Result<(), String> {
    let last_row = [m[12], m[13], m[14], m[15]];
    if last_row != [0.0, 0.0, 0.0, 1.0] {
        let [a, b, c, d] = last_row;
        return Err(format!("the last row is {a}, {b}, {c}, {d}, expected 0, 0, 0, 1 (no projection)"));
    }
    invertible([[m[0], m[1], m[2]], [m[4], m[5], m[6]], [m[8], m[9], m[10]]])
}

/// Checks that a 3 × 3 matrix (rows) has an inverse and that volumes stay within the range of 32-bit floats.
///
/// The matrix counts as singular where |det| is at most 8 ε times the product of the rows' lengths, Hadamard's bound of |det|:
/// rounding can leave that much of a determinant of 0.
fn invertible(rows: [[f64; 3]; 3]) -> Result<(), String> {
    let det = dot(rows[0], cross(rows[1], rows[2]));
    let largest: f64 = rows.into_iter().map(length).product();
    if det.abs() <= 8.0 * f64::EPSILON * largest {
        return Err("the transform has no inverse, because its determinant is 0: use no scale of 0 and no flat matrix".into());
    }
    check_volume(det)
}

/// Checks that a determinant, the factor by which volumes grow, lies within the range of 32-bit floats.
///
/// # Errors
/// A message about a determinant outside that range.
pub(crate) fn check_volume(det: f64) -> Result<(), String> {
    let holdable = f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX);
    if !holdable.contains(&det.abs()) {
        return Err(format!("the transform scales volumes by {det:.1e}, outside the range of 32-bit floats: use scales nearer to 1"));
    }
    Ok(())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    v.map(|x| x / length(v))
}
