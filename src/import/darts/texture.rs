//! Colours that may be textures.

use super::Reader;
use super::spelling::{Course, word};
use super::transform;
use super::value::{color, numbers, scalar};
use crate::import::view::View;
use crate::math::Transform;
use crate::reader::{Node, unknown};

const TYPES: &[&str] = &["constant", "checker", "marble", "image"];

impl Reader<'_> {
    /// A colour, or pt's texture for it.
    pub fn textured(&self, view: &View) -> Option<Node> {
        if !view.is_object() {
            return color(view);
        }
        let kind = view.need(&["type"])?;
        match word(kind.text()?).as_str() {
            "constant" => {
                view.leave_out_others(&["type", "name", "color"]);
                color(&view.need(&["color"])?)
            }
            "checker" => self.checker(view),
            "marble" => self.marble(view),
            "image" => image(view),
            _ => {
                kind.fault(unknown("texture", kind.text()?, TYPES));
                None
            }
        }
    }

    /// A checker: by its own spelling `color1` and `color2` the newest dialect's, by `even` and `odd` one of the others'.
    fn checker(&self, view: &View) -> Option<Node> {
        const KEYS: &[&str] = &["type", "name", "even", "odd", "color1", "color2", "scale", "transform", "vector"];
        view.leave_out_others(KEYS);
        let is_newest = view.has("color1") || view.has("color2");
        let [even, odd] = if is_newest { ["color2", "color1"] } else { ["even", "odd"] };
        let [even, odd] = [self.textured(&view.need(&[even])?)?, self.textured(&view.need(&[odd])?)?];
        let scale = match view.get(&["scale"]) {
            Some(scale) if is_newest => scalar(&scale)?,
            Some(scale) => self.waves(&scale)?,
            None if is_newest => view.make_number(1.0),
            None => radians(view, view.make_number(1.0)),
        };
        let mut members = vec![("type", view.make_text("checker")), ("even", even), ("odd", odd), ("scale", scale)];
        members.extend(space(view)?);
        Some(view.make_object(members))
    }

    /// The waves of a checker by the sign of three sines: of scale · p in dirt, of p / scale in darts.
    fn waves(&self, scale: &View) -> Option<Node> {
        let (multiplies, is_sure) = self.spellings.says(|course| course == Course::Dirt);
        let number = numbers::<1>(scale)?[0];
        if !is_sure && number != 1.0 {
            scale.note("nothing tells which of the dialects of dirt and darts this is: read as dirt's, sin(scale · p)");
        }
        if multiplies {
            return Some(radians(scale, scalar(scale)?));
        }
        if !(number > 0.0 && (1.0 / number).is_finite()) {
            scale.expected("a number above 0");
            return None;
        }
        Some(radians(scale, scale.make_number(1.0 / number)))
    }

    /// A marble, stirred as in the book that the courses follow.
    fn marble(&self, view: &View) -> Option<Node> {
        view.leave_out_others(&["type", "name", "base", "veins", "scale", "transform", "vector"]);
        let (base, veins) = (self.textured(&view.need(&["base"])?)?, self.textured(&view.need(&["veins"])?)?);
        view.note("a marble's veins are approximated by veins that are alike and lie elsewhere: its noise is drawn at random there");
        let turbulence = ("turbulence", view.make_text("absolute_of_sum"));
        let mut members = vec![("type", view.make_text("marble")), ("base", base), ("veins", veins), turbulence];
        if let Some(scale) = view.get(&["scale"]) {
            members.push(("scale", scalar(&scale)?));
        }
        members.extend(space(view)?);
        Some(view.make_object(members))
    }
}

fn radians(view: &View, number: Node) -> Node {
    view.make_object([("radians", number)])
}

/// The coordinates that a pattern varies over.
struct Over {
    on: &'static str,
    /// Leads from them into the pattern.
    into: Option<Transform>,
}

impl Over {
    const POSITION: Over = Over { on: "position", into: None };

    /// After another map has led into the pattern.
    fn then(self, map: Transform) -> Over {
        Over { into: Some(self.into.map_or(map, |before| before.then(&map))), ..self }
    }
}

/// The coordinates that a pattern varies over, as pt's keys.
fn space<'k>(view: &View) -> Option<Vec<(&'k str, Node)>> {
    let mut over = view.get(&["vector"]).map_or(Some(Over::POSITION), |vector| coordinates(&vector))?;
    if let Some(placed) = view.get(&["transform"]) {
        over = over.then(invertible(&placed)?);
    }
    let mut members = vec![("on", view.make_text(over.on))];
    // Theirs leads from the world into the pattern, pt's places the pattern in the world.
    match over.into {
        Some(_) if over.on == "uv" => view.note("left out: a transform of texture coordinates"),
        Some(into) => members.push(("transform", view.make_array([matrix(view, &into.inverse())]))),
        None => {}
    }
    Some(members)
}

/// The map that a list of commands makes.
fn invertible(placed: &View) -> Option<Transform> {
    transform::steps(placed)?;
    let map = transform::composed(placed);
    if map.is_none() {
        placed.fault("the transform is singular");
    }
    map
}

fn matrix(view: &View, map: &Transform) -> Node {
    let rows = glam::DMat4::from(map.matrix()).transpose().to_cols_array();
    view.make_object([("matrix", view.make_numbers(rows))])
}

fn coordinates(vector: &View) -> Option<Over> {
    if !vector.is_object() {
        return named(vector);
    }
    let kind = vector.need(&["type"])?;
    match kind.text()? {
        "coord" => {
            vector.leave_out_others(&["type", "name", "coordinate"]);
            named(&vector.need(&["coordinate"])?)
        }
        "mapping" => mapping(vector),
        _ => named(&kind),
    }
}

fn named(kind: &View) -> Option<Over> {
    match kind.text()? {
        "uv" => Some(Over { on: "uv", into: None }),
        "point" | "position" | "world" => Some(Over::POSITION),
        other => {
            kind.note(format!("the coordinates {other:?} are approximated by positions in the world"));
            Some(Over::POSITION)
        }
    }
}

/// Coordinates through a map: its vector type `point` maps them, `texture` maps them back.
fn mapping(vector: &View) -> Option<Over> {
    vector.leave_out_others(&["type", "name", "vector type", "transform", "vector"]);
    let over = vector.get(&["vector"]).map_or(Some(Over::POSITION), |inner| coordinates(&inner))?;
    let Some(placed) = vector.get(&["transform"]) else { return Some(over) };
    let map = invertible(&placed)?;
    let back = match vector.get(&["vector type"]) {
        Some(kind) => match kind.text()? {
            "point" => false,
            "texture" => true,
            other => {
                kind.note(format!("the vector type {other:?} is approximated by \"point\""));
                false
            }
        },
        None => {
            vector.note("a mapping without a vector type: approximated by the vector type \"point\"");
            false
        }
    };
    Some(over.then(if back { map.inverse() } else { map }))
}

fn image(view: &View) -> Option<Node> {
    view.leave_out_others(&["type", "name", "filename"]);
    let file = view.need(&["filename"])?;
    file.text()?;
    Some(view.make_object([("type", view.make_text("image")), ("file", file.same())]))
}
