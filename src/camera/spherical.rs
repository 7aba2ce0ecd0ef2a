//! Panoramas of all directions.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::Pose;
use crate::math::{Ray, float};

/// Latitude-longitude panorama. The centre of the film looks along −z, the left and right edges meet at +z, and the top edge is +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    /// Position and orientation.
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
