//! Descriptions of cameras: which ray belongs to a point of the image.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{FieldOfView, LookAt, NonNegative, Positive, Transform};
use crate::reader::{by_type, first_needs_no_type};

/// The camera. It is at the origin, looks down −z, and +y is up; `look_at` or `transform` (not both) places it elsewhere.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = first_needs_no_type)]
pub enum Camera {
    Perspective(Perspective),
    Orthographic(Orthographic),
    Spherical(Spherical),
}

by_type!(Camera { Perspective(Perspective), Orthographic(Orthographic), Spherical(Spherical) } or Perspective(Perspective));

/// A perspective view through a pinhole or a thin lens. It is the default type.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Perspective {
    /// Vertical full angle of the view, in degrees.
    pub fov: FieldOfView,
    /// Horizontal full angle of the view, in degrees. With it pixels need not be square. Default: the angle for square pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_fov: Option<FieldOfView>,
    /// Radius (not diameter) of the lens, in metres. 0 is a pinhole: everything is sharp.
    pub lens_radius: NonNegative,
    /// Distance of the plane in focus, along the view direction, in metres.
    pub focus_distance: Positive,
    /// The position of the camera and the point that it looks at. Give this or `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<LookAt>,
    /// Places the camera in the world. Give this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Transform>,
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
    /// Returns `look_at` and `transform`; a checked scene has at most one of them.
    pub fn placement(&self) -> (Option<&LookAt>, Option<&Transform>) {
        match self {
            Camera::Perspective(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Orthographic(c) => (c.look_at.as_ref(), c.transform.as_ref()),
            Camera::Spherical(c) => (c.look_at.as_ref(), c.transform.as_ref()),
        }
    }
}
