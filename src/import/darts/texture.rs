//! Colours and textures.

use super::Reader;
use super::spelling::{DartsVersion, word};
use super::transform;
use super::value::{color, numbers, scalar};
use crate::import::json_cursor::JsonCursor;
use crate::math::Transform;
use crate::reader::{Node, unknown};

const TYPES: &[&str] = &["constant", "checker", "marble", "image"];

impl Reader<'_> {
    /// Converts a colour or a texture.
    pub fn textured(&self, cursor: &JsonCursor) -> Option<Node> {
        if !cursor.is_object() {
            return color(cursor);
        }
        let kind = cursor.need(&["type"])?;
        match word(kind.text()?).as_str() {
            "constant" => {
                cursor.leave_out_others(&["type", "name", "color"]);
                color(&cursor.need(&["color"])?)
            }
            "checker" => self.checker(cursor),
            "marble" => self.marble(cursor),
            "image" => image(cursor),
            _ => {
                kind.fault(unknown("texture", kind.text()?, TYPES));
                None
            }
        }
    }

    /// Converts a checkerboard. `color1` and `color2` are the spelling of the newest dialect, `even` and `odd` that of the others.
    fn checker(&self, cursor: &JsonCursor) -> Option<Node> {
        const KEYS: &[&str] = &["type", "name", "even", "odd", "color1", "color2", "scale", "transform", "vector"];
        cursor.leave_out_others(KEYS);
        let is_newest = cursor.has("color1") || cursor.has("color2");
        let [even, odd] = if is_newest { ["color2", "color1"] } else { ["even", "odd"] };
        let [even, odd] = [self.textured(&cursor.need(&[even])?)?, self.textured(&cursor.need(&[odd])?)?];
        let scale = match cursor.get(&["scale"]) {
            Some(scale) if is_newest => scalar(&scale)?,
            Some(scale) => self.waves(&scale)?,
            None if is_newest => cursor.make_number(1.0),
            None => radians(cursor, cursor.make_number(1.0)),
        };
        let mut members = vec![("type", cursor.make_text("checker")), ("even", even), ("odd", odd), ("scale", scale)];
        members.extend(space(cursor)?);
        Some(cursor.make_object(members))
    }

    /// Frequency of a checkerboard by the sign of three sines: of scale · p in dirt, of p / scale in darts.
    fn waves(&self, scale: &JsonCursor) -> Option<Node> {
        let (multiplies, is_sure) = self.spellings.says(|version| version == DartsVersion::Dirt);
        let number = numbers::<1>(scale)?[0];
        if !is_sure && number != 1.0 {
            scale.note("it is not clear whether this is a scene of dirt, sin(scale · p), or of darts, sin(p / scale): read as dirt's");
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

    /// Converts a marble texture, with the turbulence of *Ray Tracing: The Next Week*, the book that the courses use.
    fn marble(&self, cursor: &JsonCursor) -> Option<Node> {
        cursor.leave_out_others(&["type", "name", "base", "veins", "scale", "transform", "vector"]);
        let (base, veins) = (self.textured(&cursor.need(&["base"])?)?, self.textured(&cursor.need(&["veins"])?)?);
        cursor.note("a marble's veins are approximated by veins that are alike and lie elsewhere: its noise is drawn at random there");
        let turbulence = ("turbulence", cursor.make_text("absolute_of_sum"));
        let mut members = vec![("type", cursor.make_text("marble")), ("base", base), ("veins", veins), turbulence];
        if let Some(scale) = cursor.get(&["scale"]) {
            members.push(("scale", scalar(&scale)?));
        }
        members.extend(space(cursor)?);
        Some(cursor.make_object(members))
    }
}

fn radians(cursor: &JsonCursor, number: Node) -> Node {
    cursor.make_object([("radians", number)])
}

/// Coordinates that a pattern varies over.
struct PatternSpace {
    on: &'static str,
    /// Map from the coordinates into the pattern.
    into: Option<Transform>,
}

impl PatternSpace {
    const POSITION: PatternSpace = PatternSpace { on: "position", into: None };

    /// Coordinates to which another map is applied as well.
    fn then(self, map: Transform) -> PatternSpace {
        PatternSpace { into: Some(self.into.map_or(map, |before| before.then(&map))), ..self }
    }
}

/// Coordinates that a pattern varies over, as members of pt's texture.
fn space<'k>(cursor: &JsonCursor) -> Option<Vec<(&'k str, Node)>> {
    let mut over = cursor.get(&["vector"]).map_or(Some(PatternSpace::POSITION), |vector| coordinates(&vector))?;
    if let Some(placed) = cursor.get(&["transform"]) {
        over = over.then(invertible(&placed)?);
    }
    let mut members = vec![("on", cursor.make_text(over.on))];
    // Their map leads from the world into the pattern, pt's from the pattern into the world.
    match over.into {
        Some(_) if over.on == "uv" => cursor.note("left out: a transform of texture coordinates"),
        Some(into) => members.push(("transform", cursor.make_array([matrix(cursor, &into.inverse())]))),
        None => {}
    }
    Some(members)
}

/// Map of a list of commands.
fn invertible(placed: &JsonCursor) -> Option<Transform> {
    transform::steps(placed)?;
    let map = transform::composed(placed);
    if map.is_none() {
        placed.fault("the transform is singular");
    }
    map
}

fn matrix(cursor: &JsonCursor, map: &Transform) -> Node {
    let rows = glam::DMat4::from(map.matrix()).transpose().to_cols_array();
    cursor.make_object([("matrix", cursor.make_numbers(rows))])
}

fn coordinates(vector: &JsonCursor) -> Option<PatternSpace> {
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

fn named(kind: &JsonCursor) -> Option<PatternSpace> {
    match kind.text()? {
        "uv" => Some(PatternSpace { on: "uv", into: None }),
        "point" | "position" | "world" => Some(PatternSpace::POSITION),
        other => {
            kind.note(format!("the coordinates {other:?} are approximated by positions in the world"));
            Some(PatternSpace::POSITION)
        }
    }
}

/// Coordinates with a map: the vector type `point` applies it, `texture` its inverse.
fn mapping(vector: &JsonCursor) -> Option<PatternSpace> {
    vector.leave_out_others(&["type", "name", "vector type", "transform", "vector"]);
    let over = vector.get(&["vector"]).map_or(Some(PatternSpace::POSITION), |inner| coordinates(&inner))?;
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

fn image(cursor: &JsonCursor) -> Option<Node> {
    cursor.leave_out_others(&["type", "name", "filename"]);
    let file = cursor.need(&["filename"])?;
    file.text()?;
    Some(cursor.make_object([("type", cursor.make_text("image")), ("file", file.same())]))
}
