//! Descriptions of cameras: which ray belongs to a point of the image.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{BladeCount, FNumber, FieldOfView, LookAt, NonNegative, Positive, Real, TiltAngle, Transform, WideAngle};
use crate::reader::{by_kind, by_type, first_needs_no_type};

/// The camera. It is at the origin, looks down −z, and +y is up; `look_at` or `transform` (not both) places it elsewhere.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = first_needs_no_type)]
pub enum Camera {
    Perspective(Perspective),
    Orthographic(Orthographic),
    Spherical(Spherical),
    Fisheye(Fisheye),
    Realistic(Realistic),
}

by_type!(Camera { Perspective(Perspective), Orthographic(Orthographic), Spherical(Spherical), Fisheye(Fisheye), Realistic(Realistic) } or Perspective(Perspective));

/// A perspective view through a pinhole or a thin lens. It is the default type.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Perspective {
    /// Vertical full angle of the view, in degrees. Default: 40. Give this or `focal_length`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fov: Option<FieldOfView>,
    /// Horizontal full angle of the view, in degrees. With it pixels need not be square. Default: the angle for square pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_fov: Option<FieldOfView>,
    /// Focal length f of the lens, in millimetres. The view is that of a sensor of the height h at this distance, 2 atan(h/2f): that of a
    /// lens focused at infinity, as makers of lenses and other programs state it. Focusing does not change it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub focal_length: Option<Positive>,
    /// Size of the sensor, in millimetres, for `focal_length` and `f_number`: the height, or `[width, height]`. With a width pixels need
    /// not be square. Default: the height 24, of a film for 36 × 24 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<Sensor>,
    /// Focal length divided by the diameter of the lens. Without `focal_length` it is the one that gives `fov` with the sensor. Give this
    /// or `lens_radius`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub f_number: Option<FNumber>,
    /// Radius (not diameter) of the lens, in metres. 0 is a pinhole: everything is sharp.
    pub lens_radius: NonNegative,
    /// Shape of the opening of the lens, and so of points of light that are out of focus. Default: a disk.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aperture: Option<Iris>,
    /// Distance of the plane in focus, along the view direction, in metres.
    pub focus_distance: Positive,
    /// Moves the view to the right and up, by fractions of the width and the height of the picture, without turning the camera: the
    /// film is moved across the axis of the lens, and vertical lines stay vertical. `[0, 0.5]` has the horizon at the lower edge. Default: `[0, 0]`.
    #[serde(skip_serializing_if = "is_zero")]
    pub shift: [Real; 2],
    /// Tilts the plane in focus about its point on the axis of the lens, as a tilted lens does (Scheimpflug): first about the x axis of the
    /// camera, then about its y axis, in degrees, counterclockwise as seen from the end of the axis. `[-80, 0]` is a nearly level plane that
    /// passes below a camera that looks ahead, for sharp ground. The view does not change. Default: `[0, 0]`.
    #[serde(skip_serializing_if = "is_upright")]
    pub tilt: [TiltAngle; 2],
    /// The position of the camera and the point that it looks at. Give this or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Places the camera in the world. Give this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// Height of a sensor, or `[width, height]`, in millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Sensor {
    /// The height; the width follows from the shape of the film.
    Height(Positive),
    /// The width and the height.
    Sides([Positive; 2]),
}

by_kind!(Sensor { Number => Height(Positive), Array => Sides([Positive; 2]) });

/// The opening of a lens: a regular polygon whose sides are the blades of an iris.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Iris {
    /// Number of blades: 3 or more, or 0 for a disk. The radius of the lens is that of the circle through the corners.
    pub blades: BladeCount,
    /// Turn of the polygon, in degrees counterclockwise. At 0 a corner is at the top.
    pub rotation: Real,
}

/// A view without perspective: all rays are parallel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Orthographic {
    /// Height of the view, in metres.
    pub height: Positive,
    /// The position of the camera and the point that it looks at. Give this or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Places the camera in the world. Give this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// A full panorama: longitude runs across the image, with −z at the centre; latitude runs from +y at the top to −y at the bottom.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Spherical {
    /// The position of the camera and the point that it looks at. Give this or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Places the camera in the world. Give this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// A fisheye lens: a round picture of a wide angle, as wide as the shorter side of the image. It is black outside of the circle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Fisheye {
    /// Full angle of the view across the circle, in degrees: below 360 for a `stereographic` lens, up to 180 for an `orthographic` one, up
    /// to 360 for the others.
    pub fov: WideAngle,
    /// How the angle to the axis becomes a distance from the centre of the picture.
    pub mapping: FisheyeMapping,
    /// The position of the camera and the point that it looks at. Give this or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Places the camera in the world. Give this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// The distance r from the centre of a fisheye lens's picture for an angle θ to the axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FisheyeMapping {
    /// r grows as θ: equal angles have equal distances.
    #[default]
    Equidistant,
    /// r grows as sin(θ/2): equal solid angles have equal areas. Most photographic lenses are near it.
    Equisolid,
    /// r grows as tan(θ/2): shapes are kept, those at the edge are larger.
    Stereographic,
    /// r grows as sin θ: the edge is pressed together.
    Orthographic,
}

/// A lens of spherical surfaces, given by a table: its sharpness, vignetting and distortion are those of the lens. The film is at the
/// position of the camera, and the lens in front of it. `light` cannot follow paths through it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Realistic {
    /// The surfaces from the front to the rear, or the name of a file with them. Each row is `[radius of curvature, thickness, index of
    /// refraction, diameter]`, lengths in millimetres, as in pbrt's lens files: the radius is positive where the surface bulges to the front and
    /// 0 for a plane; thickness and index are those of what is behind the surface, 0 or 1 for air. The plane between equal media is the
    /// stop. The last thickness does not count: it follows from `focus_distance`.
    pub lens: Lens,
    /// Factor of all lengths of the table, which are often stated for another focal length. Default: 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale: Positive,
    /// Diameter of the stop, in millimetres, if it is smaller than in the table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aperture_diameter: Option<Positive>,
    /// Distance of the plane in focus from the film, along the view direction, in metres.
    #[serde(default = "one")]
    pub focus_distance: Positive,
    /// Size of the sensor, in millimetres: the height, or `[width, height]`. With a width pixels need not be square. Default: the height
    /// 24, of a film for 36 × 24 mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<Sensor>,
    /// The position of the camera and the point that it looks at. Give this or `transform`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Places the camera in the world. Give this or `look_at`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// The table of a lens.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Lens {
    /// The name of a file, relative to the scene file's folder: four numbers per line, and comments after `#`.
    File(String),
    /// The rows.
    Rows(Vec<[Real; 4]>),
}

by_kind!(Lens { String => File(String), Array => Rows(Vec<[Real; 4]>) });

fn one() -> Positive {
    Positive::known(1.0)
}

fn is_one(factor: &Positive) -> bool {
    factor.get() == 1.0
}

impl Realistic {
    /// The sensor, or the one that cameras have without a word about it.
    pub fn sensor(&self) -> Sensor {
        self.sensor.unwrap_or(Sensor::FULL_FRAME)
    }
}

impl Default for Fisheye {
    fn default() -> Fisheye {
        Fisheye { fov: WideAngle::known(180.0), mapping: FisheyeMapping::default(), look_at: None, transform: None }
    }
}

impl Default for Perspective {
    fn default() -> Perspective {
        Perspective {
            fov: None,
            horizontal_fov: None,
            focal_length: None,
            sensor: None,
            f_number: None,
            lens_radius: NonNegative::known(0.0),
            aperture: None,
            focus_distance: Positive::known(1.0),
            shift: [Real::known(0.0); 2],
            tilt: [TiltAngle::known(0.0); 2],
            look_at: None,
            transform: None,
        }
    }
}

fn is_zero(shift: &[Real; 2]) -> bool {
    shift.iter().all(|part| part.get() == 0.0)
}

fn is_upright(tilt: &[TiltAngle; 2]) -> bool {
    tilt.iter().all(|angle| angle.get() == 0.0)
}

impl Sensor {
    /// Height of a film for 36 × 24 mm (mm).
    pub const FULL_FRAME: Sensor = Sensor::Height(Positive::known(24.0));

    /// Height (mm).
    pub fn height(self) -> f64 {
        match self {
            Sensor::Height(height) | Sensor::Sides([_, height]) => height.get(),
        }
    }

    /// Width (mm), if it does not follow from the shape of the film.
    pub fn width(self) -> Option<f64> {
        match self {
            Sensor::Height(_) => None,
            Sensor::Sides([width, _]) => Some(width.get()),
        }
    }
}

impl Perspective {
    /// The angle of a view about which nothing is said.
    const FOV: FieldOfView = FieldOfView::known(40.0);

    /// Vertical full angle of the view where no focal length is given (degrees).
    pub fn fov(&self) -> f64 {
        self.fov.unwrap_or(Self::FOV).get()
    }

    /// The sensor, or the one that cameras have without a word about it.
    pub fn sensor(&self) -> Sensor {
        self.sensor.unwrap_or(Sensor::FULL_FRAME)
    }
}

impl Default for Orthographic {
    fn default() -> Orthographic {
        Orthographic { height: Positive::known(2.0), look_at: None, transform: None }
    }
}

impl Camera {
    /// Adds the defaults that depend on other keys: scenes that say the same in more words are equal.
    pub(super) fn fill_defaults(&mut self) {
        if let Camera::Perspective(camera) = self
            && camera.focal_length.is_none()
        {
            camera.fov = camera.fov.or(Some(Perspective::FOV));
        }
    }

    /// Returns `look_at` and `transform`; a checked scene has at most one of them.
    pub fn placement(&self) -> (Option<&LookAt>, Option<&Transform>) {
        match self {
            Camera::Perspective(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Orthographic(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Fisheye(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Realistic(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Spherical(c) => (c.look_at.as_ref(), c.transform.as_ref()),
        }
    }
}
