//! Colours that may be textures.

use super::spelling::word;
use super::transform;
use super::value::{color, scalar};
use crate::import::view::View;
use crate::math::Transform;
use crate::reader::{Node, unknown};

const TYPES: &[&str] = &["constant", "checker", "marble", "image"];

/// A colour, or pt's texture for it.
pub fn textured(view: &View) -> Option<Node> {
    if !view.is_object() {
        return color(view);
    }
    let kind = view.need(&["type"])?;
    match word(kind.text()?).as_str() {
        "constant" => {
            view.leave_out_others(&["type", "name", "color"]);
            color(&view.need(&["color"])?)
        }
        "checker" => checker(view),
        "marble" => marble(view),
        "image" => image(view),
        _ => {
            kind.fault(unknown("texture", kind.text()?, TYPES));
            None
        }
    }
}

/// The sign of sin·sin·sin of scale·p.
fn checker(view: &View) -> Option<Node> {
    const KEYS: &[&str] = &["type", "name", "even", "odd", "color1", "color2", "scale", "transform", "vector"];
    view.leave_out_others(KEYS);
    let (even, odd) = (textured(&view.need(&["even", "color1"])?)?, textured(&view.need(&["odd", "color2"])?)?);
    let waves = match view.get(&["scale"]) {
        Some(scale) => scale.make_object([("radians", scalar(&scale)?)]),
        None => view.make_object([("radians", view.make_number(1.0))]),
    };
    let mut members = vec![("type", view.make_text("checker")), ("even", even), ("odd", odd), ("scale", waves)];
    members.extend(space(view)?);
    Some(view.make_object(members))
}

fn marble(view: &View) -> Option<Node> {
    view.leave_out_others(&["type", "name", "base", "veins", "scale", "transform", "vector"]);
    let (base, veins) = (textured(&view.need(&["base"])?)?, textured(&view.need(&["veins"])?)?);
    let mut members = vec![("type", view.make_text("marble")), ("base", base), ("veins", veins)];
    if let Some(scale) = view.get(&["scale"]) {
        members.push(("scale", scalar(&scale)?));
    }
    members.extend(space(view)?);
    Some(view.make_object(members))
}

/// The coordinates that a pattern varies over.
fn space<'k>(view: &View) -> Option<Vec<(&'k str, Node)>> {
    let on = match view.get(&["vector"]) {
        Some(vector) => coordinates(&vector)?,
        None => "position",
    };
    let mut members = vec![("on", view.make_text(on))];
    if let Some(placed) = view.get(&["transform"]) {
        // Theirs leads from the world into the pattern, pt's places the pattern in the world.
        transform::steps(&placed)?;
        match transform::composed(&placed).map(|into| into.inverse()) {
            Some(inverse) => members.push(("transform", placed.make_array([matrix(&placed, &inverse)]))),
            None => placed.fault("the transform is singular"),
        }
    }
    Some(members)
}

fn matrix(view: &View, map: &Transform) -> Node {
    let rows = glam::DMat4::from(map.matrix()).transpose().to_cols_array();
    view.make_object([("matrix", view.make_numbers(rows))])
}

fn coordinates<'k>(vector: &View) -> Option<&'k str> {
    let kind = if vector.is_object() { vector.need(&["type"])? } else { vector.clone() };
    match kind.text()? {
        "uv" => Some("uv"),
        "point" | "position" => Some("position"),
        other => {
            kind.note(format!("the coordinates {other:?} are approximated by positions in the world"));
            Some("position")
        }
    }
}

fn image(view: &View) -> Option<Node> {
    view.leave_out_others(&["type", "name", "filename"]);
    let file = view.need(&["filename"])?;
    file.text()?;
    Some(view.make_object([("type", view.make_text("image")), ("file", file.same())]))
}
