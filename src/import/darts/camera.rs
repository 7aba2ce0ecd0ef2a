//! Camera and film.

use glam::DVec3;

use super::transform;
use super::value::several;
use crate::import::json_cursor::JsonCursor;
use crate::reader::Node;

const FOV: &[&str] = &["vfov", "vertical fov"];
const FOCUS: &[&str] = &["fdist", "focus distance"];
/// Older dialects state the radius, the newest one the diameter.
const RADIUS: &str = "aperture";
const DIAMETER: &str = "aperture diameter";

const KEYS: &[&str] =
    &["type", "transform", "resolution", "medium", "vfov", "vertical fov", "fdist", "focus distance", "aperture", "aperture diameter"];

/// Converts a camera to pt's camera and film.
pub fn camera_and_film(camera: &JsonCursor) -> Option<[Node; 2]> {
    camera.leave_out_others(KEYS);
    Some([of_camera(camera)?, film(camera)?])
}

fn film(camera: &JsonCursor) -> Option<Node> {
    let Some(resolution) = camera.get(&["resolution"]) else { return Some(camera.make_object::<&str>([])) };
    let sides = several(&resolution, 2)?;
    Some(resolution.make_object([("width", sides[0].same()), ("height", sides[1].same())]))
}

fn of_camera(camera: &JsonCursor) -> Option<Node> {
    let transform = camera.get(&["transform"]);
    let scale = transform.as_ref().map_or(1.0, |transform| uniform_scale(transform, camera));
    let scaled = |cursor: JsonCursor, factor: f64| match factor {
        1.0 => Some(cursor.same()),
        factor => Some(cursor.make_number(cursor.number()? * factor)),
    };
    let mut members = vec![("fov", camera.get(FOV).map_or(camera.make_number(90.0), |fov| fov.same()))];
    match camera.get(FOCUS) {
        Some(focus) => members.push(("focus_distance", scaled(focus, scale)?)),
        None => members.push(("focus_distance", camera.make_number(scale))),
    }
    match (camera.get(&[RADIUS]), camera.get(&[DIAMETER])) {
        (Some(radius), _) => members.push(("lens_radius", scaled(radius, scale)?)),
        (None, Some(diameter)) => members.push(("lens_radius", scaled(diameter, 0.5 * scale)?)),
        (None, None) => {}
    }
    if let Some(transform) = &transform {
        members.push(("transform", transform::steps(transform)?));
    }
    Some(camera.make_object(members))
}

/// Factor by which the camera's transform scales its lens and its focus distance. pt's cameras only move and rotate.
fn uniform_scale(transform: &JsonCursor, camera: &JsonCursor) -> f64 {
    let Some(map) = transform::composed(transform) else { return 1.0 };
    let sides = DVec3::AXES.map(|axis| map.vector(axis).length());
    let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * b;
    if !sides.iter().all(|&side| near(side, sides[0])) {
        transform.note("the camera's transform scales its axes differently: approximated by a camera that keeps its field of view");
    }
    let lens = [RADIUS, DIAMETER].iter().any(|key| camera.has(key));
    if near(sides[2], 1.0) || !lens { 1.0 } else { sides[2] }
}

/// Relative error that a chain of rotations leaves in a length.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
