//! Options of the camera for a file that has none, and the bounds of a scene as that camera sees them.
//!
//! How the camera is placed by these bounds: see [`auto_camera`](super::auto_camera).

use glam::DVec3;

use crate::reader::Node;

/// Width over height of the picture if the file has none.
pub const ASPECT: f64 = 4.0 / 3.0;

/// Vertical field of view of the camera (degrees).
pub const FOV: f64 = 40.0;

/// Share of the picture's width and height that the scene fills.
const FILLED: f64 = 0.9;

/// Options of the command line for the camera, the light and a ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AutoCamera {
    /// Axis that points up; `None` for the file's own.
    pub up: Option<Up>,
    /// Side from which the camera looks; `None` for three-quarter.
    pub view: Option<Viewpoint>,
    /// Whether a ground is added below everything; `None` for one where the light is added too, and the camera looks from above.
    pub ground: Option<bool>,
    /// Whether light that is added is that of a studio, and not that of the sky.
    pub studio: bool,
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
    /// Converts from the file's axes to x right, y up, z front.
    pub(super) fn upright(self, v: DVec3) -> DVec3 {
        match self {
            Up::Y => v,
            Up::Z => DVec3::new(v.x, v.z, -v.y),
        }
    }

    /// Converts from x right, y up, z front to the file's axes.
    fn turned(self, v: DVec3) -> DVec3 {
        match self {
            Up::Y => v,
            Up::Z => DVec3::new(v.x, -v.z, v.y),
        }
    }
}

impl AutoCamera {
    /// Whether the camera looks upwards from below, where a ground would hide everything.
    pub(super) fn is_below(&self) -> bool {
        self.view.is_some_and(|view| view.back.y < 0.0)
    }

    /// Up direction of the scene.
    pub(super) fn up(&self) -> DVec3 {
        self.up.unwrap_or_default().turned(DVec3::Y)
    }

    /// Up direction of the camera's picture, as `look_at` takes it.
    pub(super) fn camera_up(&self) -> DVec3 {
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
    /// Options of the camera.
    pub(super) auto_camera: AutoCamera,
    /// Axes of the camera.
    pub(super) axes: Axes,
    /// Smallest coordinates along the axes of the scene.
    pub(super) low: DVec3,
    high: DVec3,
    /// Largest pₓ/t + p_z, −pₓ/t + p_z, p_y/t + p_z and −p_y/t + p_z.
    pub(super) sides: [f64; 4],
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

    /// Middle of the box.
    pub(super) fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Radius of the sphere through the corners of the box.
    pub(super) fn radius(&self) -> f64 {
        0.5 * (self.high - self.low).length()
    }
}

/// Axes of a camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    /// To the right of the picture.
    pub right: DVec3,
    /// Up in the picture.
    pub up: DVec3,
    /// Backwards, away from what the camera looks at.
    pub back: DVec3,
}

impl Axes {
    /// Axes of a camera that looks against `back`, with `up` as near to up in its picture as possible.
    pub fn looking(back: DVec3, up: DVec3) -> Axes {
        let back = back.normalize_or(DVec3::Z);
        let right = up.cross(back).normalize_or(back.any_orthonormal_vector());
        Axes { right, up: back.cross(right), back }
    }
}

/// Tangents of the angles between the view direction and the edge of the part of the picture that the model fills, along x and y.
pub(super) fn tangents() -> [f64; 2] {
    let up = FILLED * (FOV.to_radians() / 2.0).tan();
    [up * ASPECT, up]
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
