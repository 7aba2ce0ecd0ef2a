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

use super::json_cursor::JsonCursor;
use crate::reader::{Member, Node, Value};

/// Width of the picture if the file has none (pixels).
pub const WIDTH: u32 = 640;

/// Width over height of the picture if the file has none.
pub const ASPECT: f64 = 4.0 / 3.0;

/// Vertical field of view of the camera (degrees).
const FOV: f64 = 40.0;

/// Direction from the middle to the key light: to the right of the camera, up, and backwards.
const KEY: DVec3 = DVec3::new(-0.8, 0.9, 0.7);

/// Distance of the key light from the middle, in radii of the light; and at least as many radii of the bounding sphere.
const KEY_DISTANCE: f64 = 4.0;

/// Irradiance of the key light on a surface in the middle that faces it (W·m⁻²).
const KEY_IRRADIANCE: f64 = 2.5;

const SKY: f64 = 0.25;

/// Share of the picture's width and height that the scene fills.
const FILLED: f64 = 0.9;

/// Options of the command line for the camera, and for a ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AutoCamera {
    /// Axis that points up; `None` for the file's own.
    pub up: Option<Up>,
    /// Side from which the camera looks; `None` for three-quarter.
    pub view: Option<Viewpoint>,
    /// Whether a ground is added below everything.
    pub ground: bool,
}

/// Axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// y points up, z to the front.
    #[default]
    Y,
    /// z points up, y to the back.
    Z,
}

/// Side from which a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Name on the command line.
    pub name: &'static str,
    /// Directions towards the camera, and up in its picture; x is right, y is up, z is front.
    back: DVec3,
    up: DVec3,
}

impl Viewpoint {
    /// All viewpoints; the first is the default.
    pub const ALL: [Viewpoint; 7] = [
        Viewpoint { name: "three-quarter", back: DVec3::new(0.5, 0.35, 1.0), up: DVec3::Y },
        Viewpoint { name: "front", back: DVec3::Z, up: DVec3::Y },
        Viewpoint { name: "back", back: DVec3::NEG_Z, up: DVec3::Y },
        Viewpoint { name: "left", back: DVec3::NEG_X, up: DVec3::Y },
        Viewpoint { name: "right", back: DVec3::X, up: DVec3::Y },
        Viewpoint { name: "top", back: DVec3::Y, up: DVec3::NEG_Z },
        Viewpoint { name: "bottom", back: DVec3::NEG_Y, up: DVec3::Z },
    ];
}

impl Up {
    /// Converts from x right, y up, z front to the file's axes.
    fn turned(self, v: DVec3) -> DVec3 {
        match self {
            Up::Y => v,
            Up::Z => DVec3::new(v.x, -v.z, v.y),
        }
    }
}

impl AutoCamera {
    fn up(&self) -> DVec3 {
        self.up.unwrap_or_default().turned(DVec3::Y)
    }

    /// Up direction of the camera's picture, as `look_at` takes it.
    fn camera_up(&self) -> DVec3 {
        self.up.unwrap_or_default().turned(self.view.unwrap_or(Viewpoint::ALL[0]).up)
    }

    fn axes(&self) -> Axes {
        let back = self.up.unwrap_or_default().turned(self.view.unwrap_or(Viewpoint::ALL[0]).back);
        Axes::looking(back, self.camera_up())
    }
}

/// Bounds of a scene: along the axes, and towards the sides of a picture of 4 : 3.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    auto_camera: AutoCamera,
    axes: Axes,
    low: DVec3,
    high: DVec3,
    /// Largest pₓ/t + p_z, −pₓ/t + p_z, p_y/t + p_z and −p_y/t + p_z.
    sides: [f64; 4],
}

impl Bounds {
    /// Bounds of no points.
    pub fn empty(auto_camera: &AutoCamera) -> Bounds {
        let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        Bounds { auto_camera: *auto_camera, axes: auto_camera.axes(), low, high, sides: [f64::NEG_INFINITY; 4] }
    }

    /// Extends the bounds by a point.
    pub fn add(&mut self, p: DVec3) {
        (self.low, self.high) = (self.low.min(p), self.high.max(p));
        let Axes { right, up, back } = self.axes;
        let ([x, y], z) = ([p.dot(right) / tangents()[0], p.dot(up) / tangents()[1]], p.dot(back));
        for (side, reach) in self.sides.iter_mut().zip([x + z, -x + z, y + z, -y + z]) {
            *side = side.max(reach);
        }
    }

    /// Returns the bounds, or those of the unit cube about the origin if no point was added.
    pub fn or_unit(mut self) -> Bounds {
        if !self.low.cmple(self.high).all() {
            [-0.5, 0.5].into_iter().for_each(|x| self.add(DVec3::splat(x)));
        }
        self
    }

    fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Radius of the sphere through the corners of the box.
    fn radius(&self) -> f64 {
        0.5 * (self.high - self.low).length()
    }
}

/// Axes of a camera.
#[derive(Clone, Copy, Debug)]
struct Axes {
    right: DVec3,
    up: DVec3,
    back: DVec3,
}

impl Axes {
    fn looking(back: DVec3, up: DVec3) -> Axes {
        let back = back.normalize_or(DVec3::Z);
        let right = up.cross(back).normalize_or(back.any_orthonormal_vector());
        Axes { right, up: back.cross(right), back }
    }
}

/// Tangents of the angles between the view direction and the edge of the part of the picture that the model fills, along x and y.
fn tangents() -> [f64; 2] {
    let up = FILLED * (FOV.to_radians() / 2.0).tan();
    [up * ASPECT, up]
}

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

/// Parts that a file lacks for a first picture, added when the camera that renders is known.
pub struct MissingParts {
    /// Bounds of the scene.
    pub bounds: Bounds,
    /// `look_at` of the camera that was placed here, if the file has no camera. If the scene has another one by then, the user has
    /// placed it.
    pub placed: Option<Node>,
    /// Whether the file has no light.
    pub light: bool,
}

impl MissingParts {
    /// Adds light and ground to a scene that has a camera, and notes what was added.
    pub fn complete(&self, at: &JsonCursor, root: &mut Node) {
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
