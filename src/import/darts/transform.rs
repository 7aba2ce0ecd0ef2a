//! Transforms: commands in listed order, as pt's own steps.

use glam::{DMat4, DVec3, DVec4};

use super::value::{numbers, several, vector};
use crate::import::view::View;
use crate::math::Transform;
use crate::reader::Node;

/// What a command is recognised by, in the order in which that is tried; and what it becomes.
struct Command {
    keys: &'static [&'static str],
    step: fn(&View) -> Option<Node>,
    /// The same, to reckon with. (Of what [`Command::step`] makes, so that faults are told once.)
    map: fn(&View) -> Option<Transform>,
}

const COMMANDS: &[Command] = &[
    Command { keys: &["from", "at", "to", "up"], step: look_at, map: |view| of_look_at(frame(view)?) },
    Command { keys: &["o", "x", "y", "z"], step: columns, map: |view| Transform::from_matrix(axes(view)?).ok() },
    Command {
        keys: &["translate"],
        step: |view| step(view, "translate"),
        map: |view| Transform::translate(triple(view, "translate")?).ok(),
    },
    Command { keys: &["scale"], step: |view| step(view, "scale"), map: |view| Transform::scale(triple(view, "scale")?).ok() },
    Command { keys: &["axis", "angle"], step: axis_angle, map: |view| turned(axis_and_angle(view)?) },
    Command { keys: &["rotate"], step: rotate, map: |view| turned(angle_and_axis(view)?) },
    Command { keys: &["matrix"], step: matrix, map: |view| Transform::from_matrix(rows(view)?).ok() },
];

/// A list of pt's steps.
pub fn steps(view: &View) -> Option<Node> {
    steps_after(None, view)
}

/// A list of pt's steps, after one that is not in the file.
pub fn steps_after(first: Option<Node>, view: &View) -> Option<Node> {
    let steps: Option<Vec<Node>> = listed(view)?.iter().map(|view| (command(view)?.step)(view)).collect();
    Some(view.make_array(first.into_iter().chain(steps?)))
}

/// All of them together; `None` where that is no invertible map.
pub fn composed(view: &View) -> Option<Transform> {
    let of_one = |view: &View| COMMANDS.iter().find(|known| known.is(view)).and_then(|command| (command.map)(view));
    listed(view)?.iter().try_fold(Transform::IDENTITY, |all, view| Some(all.then(&of_one(view)?)))
}

fn listed<'a>(view: &View<'a>) -> Option<Vec<View<'a>>> {
    if view.is_array() { view.items() } else { Some(vec![view.clone()]) }
}

impl Command {
    fn is(&self, view: &View) -> bool {
        self.keys.iter().any(|key| view.has(key))
    }
}

fn command(view: &View) -> Option<&'static Command> {
    let found = COMMANDS.iter().find(|command| command.is(view));
    match found {
        Some(command) => view.leave_out_others(command.keys),
        None => view.expected("a command: from, o, translate, scale, axis, rotate or matrix"),
    }
    found
}

/// A command that pt has too.
fn step(view: &View, key: &str) -> Option<Node> {
    let value = view.need(&[key])?;
    let value = if key == "scale" && value.is_number() { value.same() } else { vector(&value, 3)? };
    Some(view.make_object([(key, value)]))
}

fn triple(view: &View, key: &str) -> Option<DVec3> {
    numbers::<3>(&view.need(&[key])?).map(DVec3::from)
}

/// Where it stands, what it looks at, and up: z = from − at, x = up × z.
fn frame(view: &View) -> Option<[[f64; 3]; 3]> {
    let or = |keys: &[&str], default: [f64; 3]| view.get(keys).map_or(Some(default), |view| numbers(&view));
    Some([or(&["from"], [0.0, 0.0, 1.0])?, or(&["at", "to"], [0.0; 3])?, or(&["up"], [0.0, 1.0, 0.0])?])
}

fn of_look_at([from, to, up]: [[f64; 3]; 3]) -> Option<Transform> {
    Transform::look_at(from.into(), to.into(), up.into()).ok()
}

fn look_at(view: &View) -> Option<Node> {
    let [from, to, up] = frame(view)?.map(|numbers| view.make_numbers(numbers));
    Some(view.make_object([("look_at", view.make_object([("from", from), ("to", to), ("up", up)]))]))
}

/// The images of the axes, and of the origin.
fn axes(view: &View) -> Option<DMat4> {
    let or = |key: &str, default: DVec3| view.get(&[key]).map_or(Some(default), |view| numbers::<3>(&view).map(DVec3::from));
    let [x, y, z] = [or("x", DVec3::X)?, or("y", DVec3::Y)?, or("z", DVec3::Z)?].map(|axis| axis.extend(0.0));
    Some(DMat4::from_cols(x, y, z, or("o", DVec3::ZERO)?.extend(1.0)))
}

fn columns(view: &View) -> Option<Node> {
    let rows = axes(view)?.transpose().to_cols_array();
    Some(view.make_object([("matrix", view.make_numbers(rows))]))
}

type Turn = ([f64; 3], f64);

fn axis_and_angle(view: &View) -> Option<Turn> {
    let axis = view.get(&["axis"]).map_or(Some([1.0, 0.0, 0.0]), |view| numbers(&view))?;
    Some((axis, view.get(&["angle"]).map_or(Some(0.0), |view| view.number())?))
}

/// In one array: the angle first.
fn angle_and_axis(view: &View) -> Option<Turn> {
    let [angle, x, y, z] = numbers(&view.need(&["rotate"])?)?;
    Some(([x, y, z], angle))
}

fn turned((axis, degrees): Turn) -> Option<Transform> {
    Transform::rotate(axis.into(), degrees).ok()
}

fn axis_angle(view: &View) -> Option<Node> {
    turn(view, axis_and_angle(view)?)
}

fn rotate(view: &View) -> Option<Node> {
    turn(view, angle_and_axis(view)?)
}

fn turn(view: &View, (axis, degrees): Turn) -> Option<Node> {
    let turn = [("axis", view.make_numbers(axis)), ("degrees", view.make_number(degrees))];
    Some(view.make_object([("rotate", view.make_object(turn))]))
}

/// Row by row; one number for a scale.
fn rows(view: &View) -> Option<DMat4> {
    let matrix = view.need(&["matrix"])?;
    match one(&matrix) {
        Some(scale) => Some(DMat4::from_diagonal(DVec4::new(scale, scale, scale, 1.0))),
        None => numbers::<16>(&matrix).map(|rows| DMat4::from_cols_array(&rows).transpose()),
    }
}

fn one(matrix: &View) -> Option<f64> {
    let single = matrix.is_number() || matrix.is_array() && matrix.items()?.len() == 1;
    if single { several(matrix, 1)?[0].number() } else { None }
}

fn matrix(view: &View) -> Option<Node> {
    let value = view.need(&["matrix"])?;
    let step = match one(&value) {
        Some(scale) => ("scale", value.make_number(scale)),
        None => ("matrix", vector(&value, 16)?),
    };
    Some(view.make_object([step]))
}
