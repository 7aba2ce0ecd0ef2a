//! Parallel projection.

use glam::{Vec2, Vec3};

use super::{CameraConnection, Pose};
use crate::math::Ray;

/// Parallel projection along −z. The film shows `height` metres of the plane z = 0 from top to bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    /// Position and orientation.
    pub pose: Pose,
    /// Height of the visible part of the plane z = 0 (m).
    pub height: f32,
}

impl Orthographic {
    pub(super) fn ray(&self, film: Vec2, aspect: f32) -> Ray {
        let on_film = Vec3::new((film.x - 0.5) * aspect, 0.5 - film.y, 0.0) * self.height;
        Ray::new(self.pose.eye() + self.pose.vector(on_film), self.pose.vector(-Vec3::Z).normalize())
    }

    /// We = 1/A for a film that shows the area A.
    pub(super) fn connect(&self, p: Vec3, aspect: f32) -> Option<CameraConnection> {
        let at = self.pose.components(p - self.pose.eye());
        let film = Vec2::new(at.x / (self.height * aspect) + 0.5, 0.5 - at.y / self.height);
        let end = self.pose.eye() + self.pose.vector(at.with_z(0.0));
        let weight = 1.0 / (self.height * self.height * aspect);
        (at.z < 0.0).then(|| CameraConnection { wi: self.pose.vector(Vec3::Z).normalize(), film, weight, end })
    }
}
