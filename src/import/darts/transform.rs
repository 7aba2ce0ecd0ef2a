//! Transforms of dirt and darts: commands, which are converted to the steps of pt's format in their order.

use glam::{DMat4, DVec3, DVec4};

use super::value::{numbers, several, vector};
use crate::import::json_cursor::JsonCursor;
use crate::math::Transform;
use crate::reader::Node;

/// A kind of command: the keys that it is recognised by, in the order in which they are tried, and its conversion.
struct Command {
    keys: &'static [&'static str],
    step: fn(&JsonCursor) -> Option<Node>,
    /// Map of the command, computed from the result of [`Command::step`] so that faults are reported once.
    map: fn(&JsonCursor) -> Option<Transform>,
}

const COMMANDS: &[Command] = &[
    Command { keys: &["from", "at", "to", "up"], step: look_at, map: |cursor| of_look_at(frame(cursor)?) },
    Command { keys: &["o", "x", "y", "z"], step: columns, map: |cursor| Transform::from_matrix(axes(cursor)?).ok() },
    Command {
        keys: &["translate"],
        step: |cursor| step(cursor, "translate"),
        map: |cursor| Transform::translate(triple(cursor, "translate")?).ok(),
    },
    Command { keys: &["scale"], step: |cursor| step(cursor, "scale"), map: |cursor| Transform::scale(triple(cursor, "scale")?).ok() },
    Command { keys: &["axis", "angle"], step: axis_angle, map: |cursor| turned(axis_and_angle(cursor)?) },
    Command { keys: &["rotate"], step: rotate, map: |cursor| turned(angle_and_axis(cursor)?) },
    Command { keys: &["matrix"], step: matrix, map: |cursor| Transform::from_matrix(rows(cursor)?).ok() },
];

/// Converts commands to a list of steps.
pub fn steps(cursor: &JsonCursor) -> Option<Node> {
    steps_after(None, cursor)
}

/// Converts commands to a list of steps, after a first step that is not in the file.
pub fn steps_after(first: Option<Node>, cursor: &JsonCursor) -> Option<Node> {
    let steps: Option<Vec<Node>> = listed(cursor)?.iter().map(|cursor| (command(cursor)?.step)(cursor)).collect();
    Some(cursor.make_array(first.into_iter().chain(steps?)))
}

/// Map of all commands; `None` if it is not invertible.
pub fn composed(cursor: &JsonCursor) -> Option<Transform> {
    let of_one = |cursor: &JsonCursor| COMMANDS.iter().find(|known| known.is(cursor)).and_then(|command| (command.map)(cursor));
    listed(cursor)?.iter().try_fold(Transform::IDENTITY, |all, cursor| Some(all.then(&of_one(cursor)?)))
}

fn listed<'a>(cursor: &JsonCursor<'a>) -> Option<Vec<JsonCursor<'a>>> {
    if cursor.is_array() { cursor.items() } else { Some(vec![cursor.clone()]) }
}

impl Command {
    fn is(&self, cursor: &JsonCursor) -> bool {
        self.keys.iter().any(|key| cursor.has(key))
    }
}

fn command(cursor: &JsonCursor) -> Option<&'static Command> {
    let found = COMMANDS.iter().find(|command| command.is(cursor));
    match found {
        Some(command) => cursor.leave_out_others(command.keys),
        None => cursor.expected("a command: from, o, translate, scale, axis, rotate or matrix"),
    }
    found
}

/// Step of a command that pt has too.
fn step(cursor: &JsonCursor, key: &str) -> Option<Node> {
    let value = cursor.need(&[key])?;
    let value = if key == "scale" && value.is_number() { value.same() } else { vector(&value, 3)? };
    Some(cursor.make_object([(key, value)]))
}

fn triple(cursor: &JsonCursor, key: &str) -> Option<DVec3> {
    numbers::<3>(&cursor.need(&[key])?).map(DVec3::from)
}

/// Frame from position, target and up: z = from − at, x = up × z.
fn frame(cursor: &JsonCursor) -> Option<[[f64; 3]; 3]> {
    let or = |keys: &[&str], default: [f64; 3]| cursor.get(keys).map_or(Some(default), |cursor| numbers(&cursor));
    Some([or(&["from"], [0.0, 0.0, 1.0])?, or(&["at", "to"], [0.0; 3])?, or(&["up"], [0.0, 1.0, 0.0])?])
}

fn of_look_at([from, to, up]: [[f64; 3]; 3]) -> Option<Transform> {
    Transform::look_at(from.into(), to.into(), up.into()).ok()
}

fn look_at(cursor: &JsonCursor) -> Option<Node> {
    let [from, to, up] = frame(cursor)?.map(|numbers| cursor.make_numbers(numbers));
    Some(cursor.make_object([("look_at", cursor.make_object([("from", from), ("to", to), ("up", up)]))]))
}

/// Matrix of a transform that is given by the images of the axes and of the origin: `x`, `y`, `z` and `o`.
fn axes(cursor: &JsonCursor) -> Option<DMat4> {
    let or = |key: &str, default: DVec3| cursor.get(&[key]).map_or(Some(default), |cursor| numbers::<3>(&cursor).map(DVec3::from));
    let [x, y, z] = [or("x", DVec3::X)?, or("y", DVec3::Y)?, or("z", DVec3::Z)?].map(|axis| axis.extend(0.0));
    Some(DMat4::from_cols(x, y, z, or("o", DVec3::ZERO)?.extend(1.0)))
}

fn columns(cursor: &JsonCursor) -> Option<Node> {
    let rows = axes(cursor)?.transpose().to_cols_array();
    Some(cursor.make_object([("matrix", cursor.make_numbers(rows))]))
}

type Turn = ([f64; 3], f64);

fn axis_and_angle(cursor: &JsonCursor) -> Option<Turn> {
    let axis = cursor.get(&["axis"]).map_or(Some([1.0, 0.0, 0.0]), |cursor| numbers(&cursor))?;
    Some((axis, cursor.get(&["angle"]).map_or(Some(0.0), |cursor| cursor.number())?))
}

/// Angle and axis in one array: the angle first.
fn angle_and_axis(cursor: &JsonCursor) -> Option<Turn> {
    let [angle, x, y, z] = numbers(&cursor.need(&["rotate"])?)?;
    Some(([x, y, z], angle))
}

fn turned((axis, degrees): Turn) -> Option<Transform> {
    Transform::rotate(axis.into(), degrees).ok()
}

fn axis_angle(cursor: &JsonCursor) -> Option<Node> {
    turn(cursor, axis_and_angle(cursor)?)
}

fn rotate(cursor: &JsonCursor) -> Option<Node> {
    turn(cursor, angle_and_axis(cursor)?)
}

fn turn(cursor: &JsonCursor, (axis, degrees): Turn) -> Option<Node> {
    let turn = [("axis", cursor.make_numbers(axis)), ("degrees", cursor.make_number(degrees))];
    Some(cursor.make_object([("rotate", cursor.make_object(turn))]))
}

/// Matrix row by row; one number is a scale.
fn rows(cursor: &JsonCursor) -> Option<DMat4> {
    let matrix = cursor.need(&["matrix"])?;
    match one(&matrix) {
        Some(scale) => Some(DMat4::from_diagonal(DVec4::new(scale, scale, scale, 1.0))),
        None => numbers::<16>(&matrix).map(|rows| DMat4::from_cols_array(&rows).transpose()),
    }
}

fn one(matrix: &JsonCursor) -> Option<f64> {
    let single = matrix.is_number() || matrix.is_array() && matrix.items()?.len() == 1;
    if single { several(matrix, 1)?[0].number() } else { None }
}

fn matrix(cursor: &JsonCursor) -> Option<Node> {
    let value = cursor.need(&["matrix"])?;
    let step = match one(&value) {
        Some(scale) => ("scale", value.make_number(scale)),
        None => ("matrix", vector(&value, 16)?),
    };
    Some(cursor.make_object([step]))
}
