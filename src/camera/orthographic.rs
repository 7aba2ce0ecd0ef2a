//! Parallel projection.

use glam::{Vec2, Vec3};

use super::{CameraConnection, CameraImportance, Pose};
use crate::math::{AreaPdf, Density, Ray};

/// Parallel projection along −z. The film shows `height` metres of the plane z = 0 from top to bottom.
#[derive(Clone, Debug, PartialEq)]
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
        let (film, weight) = (self.film(at, aspect), self.we(aspect));
        let end = self.pose.eye() + self.pose.vector(at.with_z(0.0));
        (at.z < 0.0).then(|| CameraConnection { wi: self.pose.vector(Vec3::Z).normalize(), film, weight, end })
    }

    /// The density of the start is We, because the direction is that of the axis.
    pub(super) fn importance(&self, ray: &Ray, aspect: f32) -> Option<CameraImportance> {
        let (film, we) = (self.film(self.pose.components(ray.origin - self.pose.eye()), aspect), self.we(aspect));
        Some(CameraImportance { film, we, position: Density::Smooth(AreaPdf::new(we)), direction: Density::Delta })
    }

    /// 1/A.
    fn we(&self, aspect: f32) -> f32 {
        1.0 / (self.height * self.height * aspect)
    }

    /// Position on the film of a point in the frame of the camera.
    fn film(&self, at: Vec3, aspect: f32) -> Vec2 {
        Vec2::new(at.x / (self.height * aspect) + 0.5, 0.5 - at.y / self.height)
    }
}
