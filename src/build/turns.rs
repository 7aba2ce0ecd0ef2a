//! Warnings about keyframes that are half a turn or more apart.

use glam::DVec3;

use crate::reader::{Node, Value, escaped};

/// Between keyframes a body rotates the shorter way: if its angle changes by 270° it rotates by −90° instead, and if by 360° not at all.
///
/// Returns a message for each keyframe whose angle differs from that of the keyframe before by 180° or more. Angles are compared where each of the
/// two keyframes has one axis of rotation, and the axes are the same or opposite.
pub(super) fn warnings(root: &Node) -> Vec<String> {
    let mut found = vec![];
    visit(root, "", &mut found);
    found
}

fn visit(node: &Node, pointer: &str, found: &mut Vec<String>) {
    match &node.value {
        Value::Array(items) => items.iter().enumerate().for_each(|(k, item)| visit(item, &format!("{pointer}/{k}"), found)),
        Value::Object(members) => {
            for member in members {
                let pointer = pointer.to_owned() + &escaped(&member.key);
                match (&member.node.value, member.key.as_str()) {
                    (Value::Array(keyframes), "keyframes") => of_keyframes(keyframes, &pointer, found),
                    _ => visit(&member.node, &pointer, found),
                }
            }
        }
        _ => {}
    }
}

fn of_keyframes(keyframes: &[Node], pointer: &str, found: &mut Vec<String>) {
    let rotations: Vec<Option<Rotation>> = keyframes.iter().map(rotation).collect();
    for (k, pair) in (1..).zip(rotations.windows(2)) {
        let [Some(before), Some(after)] = [pair[0], pair[1]] else { continue };
        let Some(turn) = before.until(after).filter(|turn| turn.abs() >= 180.0) else { continue };
        // Without the rounding of the difference.
        let turn = (turn * 1e6).round() / 1e6;
        found.push(format!(
            "{pointer}/{k}: its angle differs by {turn}° from that of the keyframe before, but bodies rotate the shorter way between keyframes: \
             add keyframes less than 180° apart"
        ));
    }
}

/// A rotation about an axis.
#[derive(Clone, Copy)]
struct Rotation {
    /// The axis, of length 1.
    axis: DVec3,
    degrees: f64,
}

impl Rotation {
    /// The change of the angle to another rotation; `None` about another axis.
    fn until(self, other: Rotation) -> Option<f64> {
        let along = self.axis.dot(other.axis);
        (along.abs() > 1.0 - 1e-9).then(|| other.degrees * along.signum() - self.degrees)
    }
}

/// The rotation of a keyframe; `None` if it has none, or several about different axes.
fn rotation(keyframe: &Node) -> Option<Rotation> {
    let Value::Array(steps) = &keyframe.child("transform")?.value else { return None };
    let mut rotations = steps.iter().filter_map(|step| step.child("rotate")).map(|rotate| {
        let Value::Array(axis) = &rotate.child("axis")?.value else { return None };
        let axis: Vec<f64> = axis.iter().filter_map(number).collect();
        let axis = (axis.len() == 3).then(|| DVec3::from_slice(&axis))?.try_normalize()?;
        Some(Rotation { axis, degrees: number(rotate.child("degrees")?)? })
    });
    let first = rotations.next()??;
    // Rotations about the same axis add up.
    rotations.try_fold(first, |sum, next| {
        let change = sum.until(next?)?;
        Some(Rotation { degrees: 2.0 * sum.degrees + change, ..sum })
    })
}

fn number(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Number(text) => text.parse().ok(),
        _ => None,
    }
}
