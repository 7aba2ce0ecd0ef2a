//! Cameras: which ray belongs to a point of the image.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{FieldOfView, LookAt, NonNegative, Positive, Transform};
use crate::reader::{by_type, first_needs_no_type};

/// The camera. It stands at the origin, looks down −z, and +y is up; `look_at` or `transform` (not both) moves it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = first_needs_no_type)]
pub enum Camera {
    Perspective(Perspective),
    Orthographic(Orthographic),
    Spherical(Spherical),
}

by_type!(Camera { Perspective(Perspective), Orthographic(Orthographic), Spherical(Spherical) } or Perspective(Perspective));

/// A pinhole, or a thin lens. The type of a camera that names none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Perspective {
    /// Vertical full angle of the view, in degrees.
    pub fov: FieldOfView,
    /// Horizontal full angle of the view, in degrees: with it pixels need not be square. Default: what makes them square.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_fov: Option<FieldOfView>,
    /// Radius (not diameter) of the lens, in metres. 0 is a pinhole: everything is sharp.
    pub lens_radius: NonNegative,
    /// Distance of the plane that is sharp, along the view direction, in metres.
    pub focus_distance: Positive,
    /// Where it stands and what it looks at. This or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Moves it from the origin. This or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// Parallel rays: no perspective.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Orthographic {
    /// Height of the view, in metres.
    pub height: Positive,
    /// Where it stands and what it looks at. This or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Moves it from the origin. This or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

/// A full panorama: longitude across the image (its centre looks down −z), latitude from +y at the top to −y at the bottom.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Spherical {
    /// Where it stands and what it looks at. This or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Moves it from the origin. This or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
}

impl Default for Perspective {
    fn default() -> Perspective {
        let (fov, focus_distance) = (FieldOfView::known(40.0), Positive::known(1.0));
        Perspective { fov, horizontal_fov: None, lens_radius: NonNegative::known(0.0), focus_distance, look_at: None, transform: None }
    }
}

impl Default for Orthographic {
    fn default() -> Orthographic {
        Orthographic { height: Positive::known(2.0), look_at: None, transform: None }
    }
}

impl Camera {
    /// How it is placed: `look_at` and `transform`, of which a checked scene has at most one.
    pub fn placement(&self) -> (Option<&LookAt>, Option<&Transform>) {
        match self {
            Camera::Perspective(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Orthographic(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Spherical(c) => (c.look_at.as_ref(), c.transform.as_ref()),
        }
    }
}
