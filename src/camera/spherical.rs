//! Panoramas of all directions.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{CameraConnection, Pose};
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

    /// We = 1 / (2π² sin θ), because equal parts of the film are equal angles.
    pub(super) fn connect(&self, p: Vec3) -> Option<CameraConnection> {
        let line = self.pose.eye() - p;
        let (d2, w) = (line.length_squared(), self.pose.components(-line).try_normalize()?);
        let sin = (w.x * w.x + w.z * w.z).sqrt();
        let film = Vec2::new(float::atan2(w.x, -w.z) / TAU + 0.5, float::atan2(sin, w.y) / PI);
        let weight = 1.0 / (2.0 * PI * PI * sin * d2);
        let connection = CameraConnection { wi: line / d2.sqrt(), film, weight, end: self.pose.eye() };
        weight.is_finite().then_some(connection)
    }
}
