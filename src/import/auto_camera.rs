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
//! - The light is that of a clear sky by day. Its sun stands to the left of the camera and behind it. A matte ground lies under
//!   everything; its albedo is that of the ground of the sky, so that the two meet without a visible edge.
//! - The light of a studio, on request, is a sky of radiance 0.25 in all directions and three lamps, disks placed relative to the
//!   camera. The key light, to the left, above and behind the camera, is never in the picture; its radius is 1/4 of its distance from
//!   the middle of the bounding box, and its irradiance on a surface there that faces it is 2.5 W·m⁻². A fill light on the right is
//!   twice as large and weaker; a rim light behind and above the model lights its edges.
//!
//! All of it is placed relative to the camera that renders, even if that camera comes from elsewhere.

use std::f64::consts::PI;

use glam::DVec3;

use super::context::ImportContext;
use super::json_cursor::JsonCursor;
use super::view::{AutoCamera, Axes, Bounds, FOV, MissingParts, tangents};
use crate::reader::{Location, Member, Node, Value};

/// Width of the picture if the file has none (pixels).
pub const WIDTH: u32 = 640;

/// A lamp of the studio.
struct Lamp {
    name: &'static str,
    /// Direction from the middle to the lamp: to the right of the camera, up, and backwards.
    direction: DVec3,
    /// Irradiance on a surface in the middle that faces the lamp (W·m⁻²).
    irradiance: f64,
    /// Distance from the middle in radii of the lamp.
    distance: f64,
}

/// Direction from the middle to the key light, and above the horizon to the sun.
const KEY: DVec3 = DVec3::new(-0.8, 0.9, 0.7);

const STUDIO: [Lamp; 3] = [
    Lamp { name: "key light", direction: KEY, irradiance: 2.5, distance: 4.0 },
    Lamp { name: "fill light", direction: DVec3::new(1.1, 0.4, 0.6), irradiance: 0.6, distance: 2.0 },
    Lamp { name: "rim light", direction: DVec3::new(0.4, 1.6, -0.5), irradiance: 1.5, distance: 5.0 },
];

/// Distance of the lamps from the middle in radii of the bounding sphere, unless the camera is farther away.
const LAMP_DISTANCE: f64 = 4.0;

/// Radiance around the studio, the same from all directions (W·m⁻²·sr⁻¹).
const STUDIO_SKY: f64 = 0.25;

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
        None => at.note("--view, --up, --ground, --no-ground and --studio are for models (glTF, OBJ, PLY, STL): they change nothing here"),
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
        let is_dark = self.light && !has("background") && !has("lights");
        let auto_camera = &self.bounds.auto_camera;
        let eye = look_at.as_ref().and_then(|l| Some((point(l.child("from"))?, point(l.child("to"))?, point(l.child("up")))));
        let is_under_sky = self.light && !has("lights") && root.get("/background/sky").is_some();
        let mut shapes = vec![];
        if auto_camera.ground.unwrap_or((is_dark || is_under_sky) && !auto_camera.is_below()) {
            shapes.push(self.ground(at));
        }
        match (is_dark, auto_camera.studio) {
            (true, true) => {
                shapes.extend(STUDIO.iter().map(|lamp| self.lamp(at, lamp, eye)));
                add(root, "background", at.make_object([("radiance", at.make_number(STUDIO_SKY))]));
                at.note(format!("no light: that of a studio was added, a sky of radiance {STUDIO_SKY} and three lamps"));
            }
            (true, false) => {
                add(root, "background", at.make_object([("sky", at.make_object::<&str>([]))]));
                at.note("no light: a clear sky was added; --studio and --environment FILE are other lights");
            }
            (false, true) => at.note("--studio: the scene has light, and no other was added"),
            (false, false) => {}
        }
        shapes.into_iter().for_each(|shape| add(root, "shapes", shape));
        if let Some(background) = member(root, "background") {
            self.place_sun(at, background, eye);
            if auto_camera.up() == DVec3::Z {
                raise(at, background);
            }
        }
    }

    /// Axes of the camera that renders.
    ///
    /// - `eye`: its `from`, `to` and `up`, if it has a `look_at`
    fn axes(&self, eye: Option<Eye>) -> Axes {
        eye.map_or(self.bounds.axes, |(from, to, up)| Axes::looking(from - to, up.unwrap_or(DVec3::Y)))
    }

    /// Puts the sun of a sky to the left of the camera and behind it, unless its azimuth or place is stated or the sky is turned.
    fn place_sun(&self, at: &JsonCursor, background: &mut Node, eye: Option<Eye>) {
        if background.child("transform").is_some() {
            return;
        }
        let Some(sky) = member(background, "sky").filter(|sky| sky.child("azimuth").is_none() && sky.child("place").is_none()) else {
            return;
        };
        let Axes { right, up, back } = self.axes(eye);
        let towards = self.bounds.auto_camera.up.unwrap_or_default().upright(KEY.x * right + KEY.y * up + KEY.z * back);
        // 0 is −z and 90 is +x.
        let azimuth = towards.x.atan2(-towards.z).to_degrees().round();
        add(sky, "azimuth", at.make_number(azimuth));
    }

    /// A lamp of the studio as a shape that emits towards the middle.
    fn lamp(&self, at: &JsonCursor, lamp: &Lamp, eye: Option<Eye>) -> Node {
        let (middle, radius) = (self.bounds.middle(), self.bounds.radius());
        let Axes { right, up, back } = self.axes(eye);
        let towards = (lamp.direction.x * right + lamp.direction.y * up + lamp.direction.z * back).normalize();
        // The disk is tilted, so the nearest point of one behind the camera is less far behind the middle than its centre, by its radius
        // times the sine.
        let slope = towards.dot(back) - (1.0 - towards.dot(back).powi(2)).sqrt() / lamp.distance;
        let behind = eye.filter(|_| slope > 0.0).map_or(0.0, |(from, ..)| (from - middle).dot(back) / slope);
        let distance = (LAMP_DISTANCE * radius).max(1.05 * behind);
        // The disk fills a cone of half angle θ with tan θ = r/d: E = π L sin² θ.
        let radiance = lamp.irradiance / PI * (1.0 + lamp.distance * lamp.distance);
        disk(
            at,
            lamp.name,
            [middle + towards * distance, middle],
            distance / lamp.distance,
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

/// `from`, `to` and `up` of a camera.
type Eye = (DVec3, DVec3, Option<DVec3>);

/// Turns a sky or a picture of the surroundings, which has +y up, so that +z is up; unless it is turned already.
fn raise(at: &JsonCursor, background: &mut Node) {
    let turn = at.make_object([("axis", at.make_numbers([1.0, 0.0, 0.0])), ("degrees", at.make_number(90.0))]);
    let steps = at.make_array([at.make_object([("rotate", turn)])]);
    if ["image", "sky"].iter().any(|key| background.child(key).is_some()) && background.child("transform").is_none() {
        add(background, "transform", steps);
    }
}

/// Member of an object.
fn member<'a>(node: &'a mut Node, key: &str) -> Option<&'a mut Node> {
    let Value::Object(members) = &mut node.value else { return None };
    members.iter_mut().find(|member| member.key == key).map(|member| &mut member.node)
}

/// Adds to a list of the scene, or adds a key that it lacks.
fn add(root: &mut Node, key: &str, node: Node) {
    if let Some(present) = member(root, key) {
        if let Value::Array(list) = &mut present.value {
            list.push(node);
        }
    } else if let Value::Object(members) = &mut root.value {
        members.push(Member { key: key.to_owned(), key_location: node.location.clone(), node });
    }
}

/// Radius of the ground in radii of the bounding sphere. A larger ground would add noise: the choice among lights weights a sky by
/// the size of the scene.
const GROUND_RADIUS: f64 = 10.0;
const GROUND_GAP: f64 = 1e-3;

/// Albedo of the ground under a sky, unless the scene says otherwise, and of the ground under a model.
const GROUND_ALBEDO: f64 = 0.3;

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
