//! A pinhole, or a thin lens.

use glam::{Vec2, Vec3};

use super::Pose;
use crate::math::{Ray, float, warp};

/// A perspective camera with a thin lens.
///
/// The film point (x, y), from −1 to 1, is focused on (x·a·τ, y·τ, −1)·focus_distance, with τ = tan(fov/2)
/// and the aspect ratio a: that of the film, so that pixels are square, or one of its own; rays to it start on the lens, a disk
/// around the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perspective {
    pub pose: Pose,
    /// τ, half the vertical field of view.
    pub(super) tan_half_fov: f32,
    /// a, where it is not the film's.
    aspect: Option<f32>,
    /// (m); 0 for a pinhole.
    pub(super) lens_radius: f32,
    /// Along the axis (m).
    focus_distance: f32,
}

impl Perspective {
    /// - `fov`: full vertical angle (degrees)
    /// - `lens_radius`, `focus_distance`: (m)
    pub fn new(pose: Pose, fov: f64, lens_radius: f32, focus_distance: f32) -> Perspective {
        Perspective { pose, tan_half_fov: tan_half(fov) as f32, aspect: None, lens_radius, focus_distance }
    }

    /// The same with a full horizontal angle of its own (degrees), whatever the shape of the film.
    pub fn across(self, fov: f64, horizontal_fov: f64) -> Perspective {
        Perspective { aspect: Some((tan_half(horizontal_fov) / tan_half(fov)) as f32), ..self }
    }

    /// a, on a film of this aspect ratio.
    #[inline(always)]
    pub(super) fn aspect(&self, film: f32) -> f32 {
        self.aspect.unwrap_or(film)
    }

    pub fn has_lens(&self) -> bool {
        self.lens_radius > 0.0
    }

    #[inline(always)]
    pub(super) fn ray(&self, film: Vec2, aspect: f32, lens: Vec2) -> Ray {
        let x = (2.0 * film.x - 1.0) * self.tan_half_fov * self.aspect(aspect);
        let y = (1.0 - 2.0 * film.y) * self.tan_half_fov;
        let towards = Vec3::new(x, y, -1.0);
        if !self.has_lens() {
            return Ray::new(self.pose.eye(), self.pose.vector(towards).normalize());
        }
        let on_lens = (warp::disk(lens) * self.lens_radius).extend(0.0);
        let focus = towards * self.focus_distance;
        Ray::new(self.pose.eye() + self.pose.vector(on_lens), self.pose.vector(focus - on_lens).normalize())
    }
}

/// tan(θ/2), with θ in degrees; our own sine and cosine, for the same bits everywhere.
fn tan_half(degrees: f64) -> f64 {
    let (sin, cos) = float::sin_cos_degrees(0.5 * degrees);
    sin / cos
}
