//! Builds transforms from their steps.

use glam::{DMat4, DVec3};

use crate::describe::{self, Keyframe, LookAt, Scale, Shutter, Step};
use crate::error::Error;
use crate::format::check_volume;
use crate::math::{AnimatedTransform, Keyframes, Transform};

/// Composes all steps, the first acting first, and then `outer`, the transform of the groups around.
///
/// # Errors
/// A message about steps that each have an inverse, but not together within the precision of floats.
pub(crate) fn placed(steps: &describe::Transform, outer: &Transform) -> Result<Transform, String> {
    let step = |total: Transform, step| Some(total.then(&step_of(step)?));
    let total = steps.0.iter().try_fold(Transform::IDENTITY, step).map(|total| total.then(outer));
    let total = total.filter(|total| total.matrix().is_finite() && total.inverse().matrix().is_finite());
    let total = total.ok_or("the steps together have no inverse: their numbers are too large or too small")?;
    check_volume(total.determinant()).map_err(|message| format!("all steps together: {message}"))?;
    Ok(total)
}

/// Composes all steps as [`placed`], with the motion of keyframes while the shutter is open. What does not move meanwhile is still.
///
/// # Errors
/// Those of [`placed`], and a message about keyframes that cannot be interpolated.
pub(in crate::build) fn animated(steps: &describe::Transform, outer: &Transform, shutter: &Shutter) -> Result<AnimatedTransform, String> {
    if !steps.has_keyframes() {
        return placed(steps, outer).map(AnimatedTransform::Still);
    }
    let mut total = AnimatedTransform::Still(Transform::IDENTITY);
    for step in &steps.0 {
        let next = match step {
            Step::Keyframes(keyframes) => motion(keyframes, shutter)?,
            _ => step_of(step).ok_or("a step has no inverse")?.into(),
        };
        total = total.then(&next);
    }
    let total = total.then(&(*outer).into());
    for time in total.keyframe_times() {
        let at = total.at(time as f32);
        if !(at.matrix().is_finite() && at.inverse_matrix().is_finite()) {
            return Err("the steps together have no inverse: their numbers are too large or too small".into());
        }
        check_volume(at.determinant()).map_err(|message| format!("all steps together: {message}"))?;
    }
    Ok(total)
}

/// The motion of keyframes while the shutter is open.
fn motion(keyframes: &[Keyframe], shutter: &Shutter) -> Result<AnimatedTransform, String> {
    let key = |keyframe: &Keyframe| Ok((keyframe.time.get(), placed(&keyframe.transform, &Transform::IDENTITY)?));
    let keys = keyframes.iter().map(key).collect::<Result<Vec<_>, String>>()?;
    let during = Keyframes::new(&keys).and_then(|keyframes| keyframes.during(shutter.open.get(), shutter.close.get()));
    during.map(AnimatedTransform::from).map_err(|error| match error {
        Error::Invalid(faults) => faults.into_iter().map(|fault| fault.message).collect(),
        other => other.to_string(),
    })
}

fn step_of(step: &Step) -> Option<Transform> {
    let map = match step {
        Step::Translate(by) => Transform::translate(by.0.into()),
        Step::Scale(Scale::Uniform(by)) => Transform::scale(DVec3::splat(*by)),
        Step::Scale(Scale::PerAxis(by)) => Transform::scale((*by).into()),
        Step::Rotate(rotate) => Transform::rotate(rotate.axis.0.into(), rotate.degrees.get()),
        Step::LookAt(at) => Transform::look_at(at.from.0.into(), at.to.0.into(), at.up.0.into()),
        // A checked scene has keyframes only where `animated` takes them.
        Step::Keyframes(_) => return None,
        Step::Matrix(rows) => Transform::from_matrix(DMat4::from_cols_array(&rows.map(|x| x.get())).transpose()),
    };
    map.ok()
}

pub(super) fn look_at(at: &LookAt) -> Option<Transform> {
    Transform::look_at(at.from.0.into(), at.to.0.into(), at.up.0.into()).ok()
}
