//! A first picture of a file that brings no camera or no light: everything is seen, and everything is lit.
//!
//! - The camera looks from the front, a little from the right and from above, or from where it is told to, and stands as near as it can
//!   with everything within the picture's middle 9/10. With x to its right, y up and z backwards, a point p is within the sides where
//!
//!   ±pₓ/t + p_z ≤ c_z ± cₓ/t,   t = 9/10 · a · tan(fov/2),   a = width / height
//!
//!   so that the largest of each left-hand side, R and L, say where it stands: c_z = (R + L)/2, cₓ = t (R − L)/2; the same for top and
//!   bottom, with a = 1; the larger c_z of both is taken.
//! - A sky of radiance 0.25 from everywhere, and a key light: a disk to the left of the camera, above it and behind it, so that no
//!   picture shows it. Its radius is 1/4 of its distance from the middle of the bounding box, and its light on a surface there that
//!   faces it is 2.5 W·m⁻². It is placed for the camera that renders, whoever has placed that one.
//!
//! A white matte surface (albedo 0.8) that faces the key light and sees all of the sky is then about 0.8 bright.

use std::f64::consts::PI;

use glam::DVec3;

use super::view::View;
use crate::reader::{Member, Node, Value};

/// Pixels: a file without a picture's size gets so many.
pub const WIDTH: u32 = 640;

/// Width over height, where the file says none.
pub const ASPECT: f64 = 4.0 / 3.0;

/// Vertical, of a camera that is placed here (degrees).
const FOV: f64 = 40.0;

/// From the middle to the key light: to the right of the camera, up, and backwards.
const KEY: DVec3 = DVec3::new(-0.8, 0.9, 0.7);

/// Of the key light from the middle, in radii of the light; and at least, in radii of the bounding sphere.
const KEY_DISTANCE: f64 = 4.0;

/// What the key light gives to a surface in the middle that faces it (W·m⁻²).
const KEY_IRRADIANCE: f64 = 2.5;

const SKY: f64 = 0.25;

/// Of the picture's width and height.
const FILLED: f64 = 0.9;

/// Where the camera of a first picture stands, and whether there is a ground: what the command line says about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Framing {
    /// The axis that points up; the file's own where nothing is said.
    pub up: Option<Up>,
    /// The side from which the camera looks; three-quarter where nothing is said.
    pub view: Option<Viewpoint>,
    /// Whether a ground lies under everything.
    pub ground: bool,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// z points to the front.
    #[default]
    Y,
    /// y points to the back.
    Z,
}

/// A side from which a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    pub name: &'static str,
    /// To the camera, and up in its picture; x is right, y is up, z is front.
    back: DVec3,
    up: DVec3,
}

impl Viewpoint {
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
    /// From x right, y up, z front to the file's axes.
    fn turned(self, v: DVec3) -> DVec3 {
        match self {
            Up::Y => v,
            Up::Z => DVec3::new(v.x, -v.z, v.y),
        }
    }
}

impl Framing {
    fn up(&self) -> DVec3 {
        self.up.unwrap_or_default().turned(DVec3::Y)
    }

    /// Of the camera's picture, as `look_at` takes it.
    fn camera_up(&self) -> DVec3 {
        self.up.unwrap_or_default().turned(self.view.unwrap_or(Viewpoint::ALL[0]).up)
    }

    fn axes(&self) -> Axes {
        let back = self.up.unwrap_or_default().turned(self.view.unwrap_or(Viewpoint::ALL[0]).back);
        Axes::looking(back, self.camera_up())
    }
}

/// How far the points of a scene reach: along the axes, and towards the sides of a picture of 4 : 3.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    framing: Framing,
    axes: Axes,
    low: DVec3,
    high: DVec3,
    /// The largest pₓ/t + p_z, −pₓ/t + p_z, p_y/t + p_z and −p_y/t + p_z.
    sides: [f64; 4],
}

impl Bounds {
    /// The bounds of nothing.
    pub fn empty(framing: &Framing) -> Bounds {
        let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        Bounds { framing: *framing, axes: framing.axes(), low, high, sides: [f64::NEG_INFINITY; 4] }
    }

    pub fn add(&mut self, p: DVec3) {
        (self.low, self.high) = (self.low.min(p), self.high.max(p));
        let Axes { right, up, back } = self.axes;
        let ([x, y], z) = ([p.dot(right) / tangents()[0], p.dot(up) / tangents()[1]], p.dot(back));
        for (side, reach) in self.sides.iter_mut().zip([x + z, -x + z, y + z, -y + z]) {
            *side = side.max(reach);
        }
    }

    /// Itself, or around nothing a box about the origin.
    pub fn or_unit(mut self) -> Bounds {
        if !self.low.cmple(self.high).all() {
            [-0.5, 0.5].into_iter().for_each(|x| self.add(DVec3::splat(x)));
        }
        self
    }

    fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Of the sphere through the box's corners.
    fn radius(&self) -> f64 {
        0.5 * (self.high - self.low).length()
    }
}

/// Of a camera.
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

/// From the middle of the picture to where its filled part ends, along x and y, at distance 1.
fn tangents() -> [f64; 2] {
    let up = FILLED * (FOV.to_radians() / 2.0).tan();
    [up * ASPECT, up]
}

/// A camera that sees everything.
pub fn camera(at: &View, bounds: &Bounds) -> Node {
    let Axes { right, up, back } = bounds.axes;
    let [right_side, left, top, bottom] = bounds.sides;
    let [x, y] = [tangents()[0] * (right_side - left) / 2.0, tangents()[1] * (top - bottom) / 2.0];
    let z = ((right_side + left) / 2.0).max((top + bottom) / 2.0);
    let from = x * right + y * up + z * back;
    // On the line of sight, at the depth of the middle.
    let to = from - back * (z - bounds.middle().dot(back));
    let mut look_at = vec![("from", at.make_numbers(from.to_array())), ("to", at.make_numbers(to.to_array()))];
    if bounds.framing.camera_up() != DVec3::Y {
        look_at.push(("up", at.make_numbers(bounds.framing.camera_up().to_array())));
    }
    at.make_object([("fov", at.make_number(FOV)), ("look_at", at.make_object(look_at))])
}

/// The image that [`camera`] is for, or one of another shape.
pub fn film(at: &View, aspect: f64) -> Node {
    let height = (f64::from(WIDTH) / aspect).round().clamp(1.0, 65536.0);
    at.make_object([("width", at.make_number(WIDTH.into())), ("height", at.make_number(height))])
}

/// What a file lacks of a first picture, to be added when it is known which camera renders.
pub struct Lacking {
    pub bounds: Bounds,
    /// The `look_at` of the camera that was placed here, where the file has none; where the scene has another by now, somebody else
    /// has placed it.
    pub placed: Option<Node>,
    pub light: bool,
}

impl Lacking {
    /// Adds light and ground to a scene that has a camera, and says what was added.
    pub fn complete(&self, at: &View, root: &mut Node) {
        let look_at = root.get("/camera/look_at").cloned();
        if look_at.is_some() && look_at == self.placed {
            let [from, to] = ["from", "to"].map(|key| look_at.as_ref().and_then(|l| point(l.child(key))).unwrap_or_default());
            at.note(format!("no camera: placed at {}, looking at {}; --view and --up turn it", told(from), told(to)));
        }
        let has = |key: &str| root.child(key).is_some_and(|node| !matches!(&node.value, Value::Array(list) if list.is_empty()));
        let mut shapes = vec![];
        if self.bounds.framing.ground {
            shapes.push(self.ground(at));
        }
        if self.light && !has("background") && !has("lights") {
            let eye = look_at.as_ref().and_then(|l| Some((point(l.child("from"))?, point(l.child("to"))?, point(l.child("up")))));
            shapes.push(self.key_light(at, eye));
            add(root, "background", at.make_object([("radiance", at.make_number(SKY))]));
        }
        shapes.into_iter().for_each(|shape| add(root, "shapes", shape));
    }

    /// The key light as a shape, which shines from behind the camera.
    fn key_light(&self, at: &View, eye: Option<(DVec3, DVec3, Option<DVec3>)>) -> Node {
        let (middle, radius) = (self.bounds.middle(), self.bounds.radius());
        let axes = eye.map_or(self.bounds.axes, |(from, to, up)| Axes::looking(from - to, up.unwrap_or(DVec3::Y)));
        let Axes { right, up, back } = axes;
        let towards = (KEY.x * right + KEY.y * up + KEY.z * back).normalize();
        // The disk is tilted: its nearest point is as far behind the middle as its own middle but for its radius times the sine.
        let slope = towards.dot(back) - (1.0 - towards.dot(back).powi(2)).sqrt() / KEY_DISTANCE;
        let behind = eye.map_or(0.0, |(from, ..)| (from - middle).dot(back) / slope);
        let distance = (KEY_DISTANCE * radius).max(1.05 * behind);
        let from = middle + towards * distance;
        at.note(format!("no light: a sky of radiance {SKY} and a key light at {} were added", told(from)));
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

    /// A large matte disk under everything, lower by so little that nothing lies within it.
    fn ground(&self, at: &View) -> Node {
        let (up, radius) = (self.bounds.framing.up(), self.bounds.radius());
        let low = (self.bounds.low * up).element_sum() - radius * GROUND_GAP;
        let middle = self.bounds.middle();
        let from = middle + up * (low - middle.dot(up));
        disk(at, "ground", [from, from + up * radius], radius * GROUND_RADIUS, [("material", matte(at, GROUND_ALBEDO))])
    }
}

/// Adds to a list of the scene, or a key that it has not.
fn add(root: &mut Node, key: &str, node: Node) {
    let Value::Object(members) = &mut root.value else { return };
    match members.iter_mut().find(|member| member.key == key).map(|member| &mut member.node.value) {
        Some(Value::Array(list)) => list.push(node),
        Some(_) => {}
        None => members.push(Member { key: key.to_owned(), key_place: node.place.clone(), node }),
    }
}

/// Of the ground, and its distance below everything, in radii of the bounding sphere. A larger ground would add noise: a sky counts as
/// the brighter the larger the scene is, when lights are chosen.
const GROUND_RADIUS: f64 = 10.0;
const GROUND_GAP: f64 = 1e-3;

const GROUND_ALBEDO: f64 = 0.5;

fn matte(at: &View, albedo: f64) -> Node {
    at.make_object([("type", at.make_text("diffuse")), ("albedo", at.make_number(albedo))])
}

/// A disk that faces from the first point to the second.
fn disk<const N: usize>(at: &View, name: &str, [from, to]: [DVec3; 2], radius: f64, more: [(&'static str, Node); N]) -> Node {
    let axis = (to - from).normalize_or(DVec3::Y);
    // `look_at` refuses an up that lies along the line of sight.
    let up = if axis.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    let look_at = [("from", from), ("to", to), ("up", up)].map(|(key, v)| (key, at.make_numbers(v.to_array())));
    // A disk's front is +z, and −z is what looks at the target.
    let turn = at.make_object([("axis", at.make_numbers([0.0, 1.0, 0.0])), ("degrees", at.make_number(180.0))]);
    let steps = [at.make_object([("rotate", turn)]), at.make_object([("look_at", at.make_object(look_at))])];
    let plain = [("type", at.make_text("disk")), ("name", at.make_text(name)), ("radius", at.make_number(radius))];
    at.make_object(plain.into_iter().chain(more).chain([("transform", at.make_array(steps))]))
}

/// Three numbers of a scene; `None` where they are none.
fn point(node: Option<&Node>) -> Option<DVec3> {
    let Value::Array(items) = &node?.value else { return None };
    let number = |item: &Node| match &item.value {
        Value::Number(text) => text.parse().ok(),
        _ => None,
    };
    let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
    Some(DVec3::from_array(numbers?.try_into().ok()?))
}

/// Three digits are enough to find a place again.
fn told(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(brief);
    format!("({x}, {y}, {z})")
}

fn brief(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}
