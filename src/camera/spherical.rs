//! Panoramas of all directions.

use std::f32::consts::{PI, TAU};

use arrayvec::ArrayVec;
use glam::{Vec2, Vec3};

use super::{CameraConnection, CameraImportance, Pose};
use crate::math::{Density, Ray, SolidAnglePdf, float};

/// Latitude-longitude panorama. The centre of the film looks along −z, the left and right edges meet at +z, and the top edge is +y.
#[derive(Clone, Debug, PartialEq)]
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
        let (film, sin) = film(w);
        let weight = 1.0 / (2.0 * PI * PI * sin * d2);
        let connection = CameraConnection { wi: line / d2.sqrt(), film, weight, end: self.pose.eye() };
        weight.is_finite().then_some(connection)
    }

    /// Density 1 / (2π² sin θ) of the direction, which is We.
    pub(super) fn importance(&self, ray: &Ray) -> Option<CameraImportance> {
        let (film, sin) = film(self.pose.components(ray.direction));
        let we = 1.0 / (2.0 * PI * PI * sin);
        let direction = Density::Smooth(SolidAnglePdf::new(we));
        we.is_finite().then_some(CameraImportance { film, we, position: Density::Delta, direction })
    }
}

/// Position on the film of a direction in the frame of the camera, and the sine of its angle to the vertical.
fn film(w: Vec3) -> (Vec2, f32) {
    let sin = (w.x * w.x + w.z * w.z).sqrt();
    (Vec2::new(float::atan2(w.x, -w.z) / TAU + 0.5, float::atan2(sin, w.y) / PI), sin)
}

/// Positions next to the film that show the same direction: the panorama goes on beyond its left and right edges, and beyond the poles
/// half a turn farther round and upside down.
pub(super) fn other_film_positions(Vec2 { x, y }: Vec2) -> ArrayVec<Vec2, 8> {
    let round = if x < 0.5 { x + 1.0 } else { x - 1.0 };
    let half_round = [x + 0.5, x - 0.5].into_iter().filter(|x| (-0.5..1.5).contains(x));
    let beyond_pole = if y < 0.5 { -y } else { 2.0 - y };
    half_round.map(|x| Vec2::new(x, beyond_pole)).chain([Vec2::new(round, y)]).collect()
}
