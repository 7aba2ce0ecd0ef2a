//! A camera and light for files that have none, so that the first picture shows and lights everything.
//!
//! - The camera looks from the front, a little from the right and from above, or from the side that is requested. It stands as near
//!   as possible with everything within the middle 9/10 of the picture. With x to its right, y up and z backwards, a point p is
//!   within the sides where
//!
//!   ±pₓ/t + p_z ≤ c_z ± cₓ/t,   t = 9/10 · a · tan(fov/2),   a = width / height
//!
//!   The largest values of the left-hand sides, R and L, give its place: c_z = (R + L)/2, cₓ = t (R − L)/2. Top and bottom give a
//!   second c_z, with a = 1, and the larger c_z is taken.
//! - A sky has radiance 0.25 in all directions. A key light, a disk to the left of the camera, above it and behind it, is never in
//!   the picture. Its radius is 1/4 of its distance from the middle of the bounding box, and its irradiance on a surface there that
//!   faces it is 2.5 W·m⁻². It is placed relative to the camera that renders, even if that camera comes from elsewhere.
//!
//! A white matte surface (albedo 0.8) that faces the key light and sees all of the sky then has a radiance of about 0.8.

use std::f64::consts::PI;

use glam::DVec3;

use super::context::ImportContext;
use super::json_cursor::JsonCursor;
use super::view::{AutoCamera, Axes, Bounds, FOV, MissingParts, tangents};
use crate::reader::{Location, Member, Node, Value};

/// Width of the picture if the file has none (pixels).
pub const WIDTH: u32 = 640;

/// Direction from the middle to the key light: to the right of the camera, up, and backwards.
const KEY: DVec3 = DVec3::new(-0.8, 0.9, 0.7);

/// Distance of the key light from the middle, in radii of the light; and at least as many radii of the bounding sphere.
const KEY_DISTANCE: f64 = 4.0;

/// Irradiance of the key light on a surface in the middle that faces it (W·m⁻²).
const KEY_IRRADIANCE: f64 = 2.5;

const SKY: f64 = 0.25;

/// Camera that sees everything.
pub fn camera(at: &JsonCursor, bounds: &Bounds) -> Node {
    let Axes { right, up, back } = bounds.axes;
    let [right_side, left, top, bottom] = bounds.sides;
    let [x, y] = [tangents()[0] * (right_side - left) / 2.0, tangents()[1] * (top - bottom) / 2.0];
    let z = ((right_side + left) / 2.0).max((top + bottom) / 2.0);
    let from = x * right + y * up + z * back;
    // Point on the line of sight, at the depth of the middle.
    let to = from - back * (z - bounds.middle().dot(back));
    let mut look_at = vec![("from", at.make_numbers(from.to_array())), ("to", at.make_numbers(to.to_array()))];
    if bounds.auto_camera.camera_up() != DVec3::Y {
        look_at.push(("up", at.make_numbers(bounds.auto_camera.camera_up().to_array())));
    }
    at.make_object([("fov", at.make_number(FOV)), ("look_at", at.make_object(look_at))])
}

/// Film for [`camera`], or one with another ratio of width to height.
pub fn film(at: &JsonCursor, aspect: f64) -> Node {
    let height = (f64::from(WIDTH) / aspect).round().clamp(1.0, 65536.0);
    at.make_object([("width", at.make_number(WIDTH.into())), ("height", at.make_number(height))])
}

/// Adds the parts that the scene lacks for a first picture, now that its camera is known.
pub fn complete(context: &ImportContext, root: &mut Node) {
    let whole = Node { value: Value::Object(vec![]), location: Location::Whole("".into()) };
    let at = JsonCursor::root(&whole, context);
    match context.take_missing() {
        Some(missing) => missing.complete(&at, root),
        None if context.auto_camera == AutoCamera::default() => {}
        None => at.note("--view, --up and --ground are for models (glTF, OBJ, PLY, STL): they change nothing here"),
    }
}

impl MissingParts {
    /// Adds light and ground to a scene that has a camera, and notes what was added.
    fn complete(&self, at: &JsonCursor, root: &mut Node) {
        let look_at = root.get("/camera/look_at").cloned();
        if look_at.is_some() && look_at == self.placed {
            let [from, to] = ["from", "to"].map(|key| look_at.as_ref().and_then(|l| point(l.child(key))).unwrap_or_default());
            at.note(format!("no camera: placed at {}, looking at {}; --view and --up turn it", rounded_point(from), rounded_point(to)));
        }
        let has = |key: &str| root.child(key).is_some_and(|node| !matches!(&node.value, Value::Array(list) if list.is_empty()));
        let mut shapes = vec![];
        if self.bounds.auto_camera.ground {
            shapes.push(self.ground(at));
        }
        if self.light && !has("background") && !has("lights") {
            let eye = look_at.as_ref().and_then(|l| Some((point(l.child("from"))?, point(l.child("to"))?, point(l.child("up")))));
            shapes.push(self.key_light(at, eye));
            add(root, "background", at.make_object([("radiance", at.make_number(SKY))]));
        }
        shapes.into_iter().for_each(|shape| add(root, "shapes", shape));
        if self.bounds.auto_camera.up() == DVec3::Z {
            raise_background(at, root);
        }
    }

    /// Key light as a shape that emits from behind the camera.
    fn key_light(&self, at: &JsonCursor, eye: Option<(DVec3, DVec3, Option<DVec3>)>) -> Node {
        let (middle, radius) = (self.bounds.middle(), self.bounds.radius());
        let axes = eye.map_or(self.bounds.axes, |(from, to, up)| Axes::looking(from - to, up.unwrap_or(DVec3::Y)));
        let Axes { right, up, back } = axes;
        let towards = (KEY.x * right + KEY.y * up + KEY.z * back).normalize();
        // The disk is tilted, so its nearest point is less far behind the middle than its centre, by its radius times the sine.
        let slope = towards.dot(back) - (1.0 - towards.dot(back).powi(2)).sqrt() / KEY_DISTANCE;
        let behind = eye.map_or(0.0, |(from, ..)| (from - middle).dot(back) / slope);
        let distance = (KEY_DISTANCE * radius).max(1.05 * behind);
        let from = middle + towards * distance;
        at.note(format!("no light: a sky of radiance {SKY} and a key light at {} were added", rounded_point(from)));
        // The disk fills a cone of half angle θ with tan θ = r/d: E = π L sin² θ.
        let radiance = KEY_IRRADIANCE / PI * (1.0 + KEY_DISTANCE * KEY_DISTANCE);
        disk(
            at,
            "key light",
            [from, middle],
            distance / KEY_DISTANCE,
            [("emission", at.make_number(radiance)), ("material", matte(at, 0.0))],
        )
    }

    /// Large matte disk under everything, with a small gap so that nothing intersects it.
    fn ground(&self, at: &JsonCursor) -> Node {
        let (up, radius) = (self.bounds.auto_camera.up(), self.bounds.radius());
        let low = (self.bounds.low * up).element_sum() - radius * GROUND_GAP;
        let middle = self.bounds.middle();
        let from = middle + up * (low - middle.dot(up));
        disk(at, "ground", [from, from + up * radius], radius * GROUND_RADIUS, [("material", matte(at, GROUND_ALBEDO))])
    }
}

/// Turns a sky or a picture of the surroundings, which has +y up, so that +z is up; unless it is turned already.
fn raise_background(at: &JsonCursor, root: &mut Node) {
    let turn = at.make_object([("axis", at.make_numbers([1.0, 0.0, 0.0])), ("degrees", at.make_number(90.0))]);
    let steps = at.make_array([at.make_object([("rotate", turn)])]);
    let Value::Object(members) = &mut root.value else { return };
    let Some(background) = members.iter_mut().find(|member| member.key == "background").map(|member| &mut member.node) else { return };
    if ["image", "sky"].iter().any(|key| background.child(key).is_some()) && background.child("transform").is_none() {
        add(background, "transform", steps);
    }
}

/// Adds to a list of the scene, or adds a key that it lacks.
fn add(root: &mut Node, key: &str, node: Node) {
    let Value::Object(members) = &mut root.value else { return };
    match members.iter_mut().find(|member| member.key == key).map(|member| &mut member.node.value) {
        Some(Value::Array(list)) => list.push(node),
        Some(_) => {}
        None => members.push(Member { key: key.to_owned(), key_location: node.location.clone(), node }),
    }
}

/// Radius of the ground in radii of the bounding sphere. A larger ground would add noise: the choice among lights weights a sky by
/// the size of the scene.
const GROUND_RADIUS: f64 = 10.0;
const GROUND_GAP: f64 = 1e-3;

const GROUND_ALBEDO: f64 = 0.5;

fn matte(at: &JsonCursor, albedo: f64) -> Node {
    at.make_object([("type", at.make_text("diffuse")), ("albedo", at.make_number(albedo))])
}

/// Disk that faces from the first point to the second.
fn disk<const N: usize>(at: &JsonCursor, name: &str, [from, to]: [DVec3; 2], radius: f64, more: [(&'static str, Node); N]) -> Node {
    let axis = (to - from).normalize_or(DVec3::Y);
    // `look_at` refuses an up direction along the line of sight.
    let up = if axis.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    let look_at = [("from", from), ("to", to), ("up", up)].map(|(key, v)| (key, at.make_numbers(v.to_array())));
    // The front of a disk is +z, but −z looks at the target.
    let turn = at.make_object([("axis", at.make_numbers([0.0, 1.0, 0.0])), ("degrees", at.make_number(180.0))]);
    let steps = [at.make_object([("rotate", turn)]), at.make_object([("look_at", at.make_object(look_at))])];
    let plain = [("type", at.make_text("disk")), ("name", at.make_text(name)), ("radius", at.make_number(radius))];
    at.make_object(plain.into_iter().chain(more).chain([("transform", at.make_array(steps))]))
}

/// Three numbers of a scene; `None` if they are not numbers.
fn point(node: Option<&Node>) -> Option<DVec3> {
    let Value::Array(items) = &node?.value else { return None };
    let number = |item: &Node| match &item.value {
        Value::Number(text) => text.parse().ok(),
        _ => None,
    };
    let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
    Some(DVec3::from_array(numbers?.try_into().ok()?))
}

/// Point with three digits per coordinate, for messages.
fn rounded_point(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(rounded);
    format!("({x}, {y}, {z})")
}

fn rounded(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}
