//! Builds transforms from their steps.

use glam::{DMat4, DVec3};

use crate::describe::{self, LookAt, Scale, Step};
use crate::format::check_volume;
use crate::math::Transform;

/// Composes all steps, the first acting first, and then `outer`, the transform of the groups around.
///
/// # Errors
/// A message about steps that each have an inverse, but not together within the precision of floats.
pub(in crate::build) fn placed(steps: &describe::Transform, outer: &Transform) -> Result<Transform, String> {
    let step = |total: Transform, step| Some(total.then(&step_of(step)?));
    let total = steps.0.iter().try_fold(Transform::IDENTITY, step).map(|total| total.then(outer));
    let total = total.filter(|total| total.matrix().is_finite() && total.inverse().matrix().is_finite());
    let total = total.ok_or("the steps together cannot be undone")?;
    check_volume(total.determinant()).map_err(|message| format!("all steps together: {message}"))?;
    Ok(total)
}

fn step_of(step: &Step) -> Option<Transform> {
    let map = match step {
        Step::Translate(by) => Transform::translate(by.0.into()),
        Step::Scale(Scale::Uniform(by)) => Transform::scale(DVec3::splat(*by)),
        Step::Scale(Scale::PerAxis(by)) => Transform::scale((*by).into()),
        Step::Rotate(rotate) => Transform::rotate(rotate.axis.0.into(), rotate.degrees.get()),
        Step::LookAt(at) => Transform::look_at(at.from.0.into(), at.to.0.into(), at.up.0.into()),
        Step::Matrix(rows) => Transform::from_matrix(DMat4::from_cols_array(&rows.map(|x| x.get())).transpose()),
    };
    map.ok()
}

pub(super) fn look_at(at: &LookAt) -> Option<Transform> {
    Transform::look_at(at.from.0.into(), at.to.0.into(), at.up.0.into()).ok()
}
