//! A full panorama.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::Pose;
use crate::math::{Ray, float};

/// Latitude and longitude: the middle of the film looks down −z, its left and right edge meet at +z,
/// its top edge is +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    pub pose: Pose,
}

impl Spherical {
    pub(super) fn ray(&self, film: Vec2) -> Ray {
        let (sin_phi, cos_phi) = float::sin_cos((film.x - 0.5) * TAU);
        let (sin_theta, cos_theta) = float::sin_cos(film.y * PI);
        let w = Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi);
        Ray::new(self.pose.eye(), self.pose.vector(w).normalize())
    }
}
