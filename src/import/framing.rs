//! A first picture of a file that brings no camera or no light: everything is seen, and everything is lit.
//!
//! - The camera looks from the front, a little from the right and from above, and stands as near as it can with everything within
//!   the picture's middle 9/10. With x to its right, y up and z backwards, a point p is within the sides where
//!
//!   ±pₓ/t + p_z ≤ c_z ± cₓ/t,   t = 9/10 · a · tan(fov/2),   a = width / height
//!
//!   so that the largest of each left-hand side, R and L, say where it stands: c_z = (R + L)/2, cₓ = t (R − L)/2; the same for top and
//!   bottom, with a = 1; the larger c_z of both is taken.
//! - A sky of radiance 0.25 from everywhere, and a key light: a disk as large as the sphere around the bounding box (radius r), 4 r away
//!   from its middle, to the left of the camera and above it, whose light on a surface there that faces it is 2.5 W·m⁻².
//!
//! A white matte surface (albedo 0.8) that faces the key light and sees all of the sky is then about 0.8 bright.

use std::f64::consts::PI;

use glam::DVec3;

use super::view::View;
use crate::reader::Node;

/// Pixels: a file without a picture's size gets so many.
pub const WIDTH: u32 = 640;

/// Width over height, where the file says none.
pub const ASPECT: f64 = 4.0 / 3.0;

/// Vertical, of a camera that is placed here (degrees).
const FOV: f64 = 40.0;

/// To the camera; y is up.
const VIEW: DVec3 = DVec3::new(0.5, 0.35, 1.0);

/// From the middle to the key light.
const KEY: DVec3 = DVec3::new(-0.7, 1.0, 0.6);

/// Of the key light from the middle, in radii of the bounding sphere.
const KEY_DISTANCE: f64 = 4.0;

/// What the key light gives to a surface in the middle that faces it (W·m⁻²).
const KEY_IRRADIANCE: f64 = 2.5;

const SKY: f64 = 0.25;

/// Of the picture's width and height.
const FILLED: f64 = 0.9;

/// How far the points of a scene reach: along the axes, and towards the sides of a picture of 4 : 3.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    low: DVec3,
    high: DVec3,
    /// The largest pₓ/t + p_z, −pₓ/t + p_z, p_y/t + p_z and −p_y/t + p_z.
    sides: [f64; 4],
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, sides: [f64::NEG_INFINITY; 4] };

    pub fn add(&mut self, p: DVec3) {
        (self.low, self.high) = (self.low.min(p), self.high.max(p));
        let Axes { right, up, back } = axes();
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

/// Of the camera.
struct Axes {
    right: DVec3,
    up: DVec3,
    back: DVec3,
}

fn axes() -> Axes {
    let back = VIEW.normalize();
    let right = DVec3::Y.cross(back).normalize();
    Axes { right, up: back.cross(right), back }
}

/// From the middle of the picture to where its filled part ends, along x and y, at distance 1.
fn tangents() -> [f64; 2] {
    let up = FILLED * (FOV.to_radians() / 2.0).tan();
    [up * ASPECT, up]
}

/// A camera that sees everything; said in a note.
pub fn camera(at: &View, bounds: &Bounds) -> Node {
    let Axes { right, up, back } = axes();
    let [right_side, left, top, bottom] = bounds.sides;
    let [x, y] = [tangents()[0] * (right_side - left) / 2.0, tangents()[1] * (top - bottom) / 2.0];
    let z = ((right_side + left) / 2.0).max((top + bottom) / 2.0);
    let from = x * right + y * up + z * back;
    // On the line of sight, at the depth of the middle.
    let to = from - back * (z - bounds.middle().dot(back));
    at.note(format!("no camera: placed at {}, looking at {}, so that everything is seen", told(from), told(to)));
    let look_at = [("from", at.make_numbers(from.to_array())), ("to", at.make_numbers(to.to_array()))];
    at.make_object([("fov", at.make_number(FOV)), ("look_at", at.make_object(look_at))])
}

/// The image that [`camera`] is for, or one of another shape.
pub fn film(at: &View, aspect: f64) -> Node {
    let height = (f64::from(WIDTH) / aspect).round().clamp(1.0, 65536.0);
    at.make_object([("width", at.make_number(WIDTH.into())), ("height", at.make_number(height))])
}

/// The sky, and the key light as a shape; said in a note.
pub fn light(at: &View, bounds: &Bounds) -> [Node; 2] {
    let (middle, radius) = (bounds.middle(), bounds.radius());
    let from = middle + KEY.normalize() * KEY_DISTANCE * radius;
    at.note(format!("no light: a sky of radiance {SKY} and a key light (a disk of radius {} at {}) were added", brief(radius), told(from)));
    // The disk fills a cone of half angle θ with tan θ = r/d: E = π L sin² θ.
    let radiance = KEY_IRRADIANCE / PI * (1.0 + KEY_DISTANCE * KEY_DISTANCE);
    let look_at = at.make_object([("from", at.make_numbers(from.to_array())), ("to", at.make_numbers(middle.to_array()))]);
    // A disk shines along +z, and −z is what looks at the target.
    let turn = at.make_object([("axis", at.make_numbers([0.0, 1.0, 0.0])), ("degrees", at.make_number(180.0))]);
    let steps = [at.make_object([("rotate", turn)]), at.make_object([("look_at", look_at)])];
    let key = at.make_object([
        ("type", at.make_text("disk")),
        ("name", at.make_text("key light")),
        ("radius", at.make_number(radius)),
        ("emission", at.make_number(radiance)),
        ("material", at.make_object([("type", at.make_text("diffuse")), ("albedo", at.make_number(0.0))])),
        ("transform", at.make_array(steps)),
    ]);
    [at.make_object([("radiance", at.make_number(SKY))]), key]
}

/// Three digits are enough to find a place again.
fn told(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(brief);
    format!("({x}, {y}, {z})")
}

fn brief(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}
