//! Parallel projection.

use glam::{Vec2, Vec3};

use super::Pose;
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
}
