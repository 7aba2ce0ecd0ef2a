//! Perspective projection with a pinhole or a thin lens.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{CameraConnection, CameraImportance, Pose};
use crate::math::lanes::{Lanes, Vector};
use crate::math::{AreaPdf, Density, Ray, SolidAnglePdf, float, warp};

/// Perspective camera with a thin lens.
///
/// The film point (x, y), with coordinates from −1 to 1, is focused on (x·a·τ, y·τ, −1)·focus_distance. Here τ = tan(fov/2), and a
/// is the aspect ratio: that of the film, so that pixels are square, or one set by [`Perspective::across`]. The rays of a film point
/// start on the lens, a disk around the eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Perspective {
    /// Position and orientation.
    pub pose: Pose,
    /// τ, the tangent of half the vertical field of view.
    pub(super) tan_half_fov: f32,
    /// Aspect ratio a if it is not that of the film.
    aspect: Option<f32>,
    /// Radius of the lens (m); 0 for a pinhole.
    pub(super) lens_radius: f32,
    /// Distance along the axis to the plane in focus (m).
    focus_distance: f32,
}

impl Perspective {
    /// A perspective camera with the aspect ratio of the film.
    ///
    /// - `fov`: full vertical field of view (degrees)
    /// - `lens_radius`, `focus_distance`: in metres
    pub fn new(pose: Pose, fov: f64, lens_radius: f32, focus_distance: f32) -> Perspective {
        Perspective { pose, tan_half_fov: tan_half(fov) as f32, aspect: None, lens_radius, focus_distance }
    }

    /// The camera with a full horizontal field of view (degrees) that does not depend on the shape of the film.
    pub fn across(self, fov: f64, horizontal_fov: f64) -> Perspective {
        Perspective { aspect: Some((tan_half(horizontal_fov) / tan_half(fov)) as f32), ..self }
    }

    /// Aspect ratio a on a film with the aspect ratio `film`.
    #[inline(always)]
    pub(super) fn aspect(&self, film: f32) -> f32 {
        self.aspect.unwrap_or(film)
    }

    /// Whether the lens has a radius above 0.
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
        let on_lens = self.on_lens(lens);
        let focus = towards * self.focus_distance;
        Ray::new(self.pose.eye() + self.pose.vector(on_lens), self.pose.vector(focus - on_lens).normalize())
    }

    /// Rays of a pinhole through several points of the film, as [`Camera::ray`](super::Camera::ray).
    #[inline(always)]
    pub(crate) fn pinhole_rays<L: Lanes>(&self, [x, y]: [L::F32; 2], aspect: f32) -> (Vector<L>, Vector<L>) {
        let (one, two, tan) = (L::f32(1.0), L::f32(2.0), L::f32(self.tan_half_fov));
        let (x, y) = ((two * x - one) * tan * L::f32(self.aspect(aspect)), (one - two * y) * tan);
        let d = self.pose.vectors(Vector { x, y, z: L::f32(-1.0) });
        (Vector::splat(self.pose.eye()), d.scaled(one / d.length()))
    }

    /// Point of the lens in the frame of the camera.
    #[inline(always)]
    fn on_lens(&self, lens: Vec2) -> Vec3 {
        (warp::disk(lens) * self.lens_radius).extend(0.0)
    }

    /// We = 1 / (A cos⁴ θ), divided by the area of the lens, for a film that shows the area A = 4τ²a at a distance of 1. The density of
    /// a point on the lens by solid angle has the same area, so that neither depends on it: We / p(ω) = 1 / (A cos³ θ d²).
    pub(super) fn connect(&self, p: Vec3, aspect: f32, lens: Vec2) -> Option<CameraConnection> {
        let on_lens = if self.has_lens() { self.on_lens(lens) } else { Vec3::ZERO };
        let end = self.pose.eye() + self.pose.vector(on_lens);
        let line = end - p;
        let away = self.pose.components(-line);
        let d2 = line.length_squared();
        let d = d2.sqrt();
        let cos = -away.z / d;
        let weight = 1.0 / (self.film_area(aspect) * cos * cos * cos * d2);
        let film = self.film(on_lens, away, aspect);
        (away.z < 0.0 && weight.is_finite()).then_some(CameraConnection { wi: line / d, film, weight, end })
    }

    /// Density 1 / (A cos³ θ) of the direction, and that of the point on the lens.
    pub(super) fn importance(&self, ray: &Ray, aspect: f32) -> Option<CameraImportance> {
        let away = self.pose.components(ray.direction);
        let on_lens = if self.has_lens() { self.pose.components(ray.origin - self.pose.eye()) } else { Vec3::ZERO };
        if away.z >= 0.0 {
            return None;
        }
        let cos = -away.z;
        let direction = 1.0 / (self.film_area(aspect) * cos * cos * cos);
        let lens = 1.0 / (PI * self.lens_radius * self.lens_radius);
        let (position, we) = match self.has_lens() {
            true => (Density::Smooth(AreaPdf::new(lens)), lens * direction / cos),
            false => (Density::Delta, direction / cos),
        };
        let film = self.film(on_lens, away, aspect);
        Some(CameraImportance { film, we, position, direction: Density::Smooth(SolidAnglePdf::new(direction)) })
    }

    /// Area A = 4τ²a that the film shows at a distance of 1 (m²).
    fn film_area(&self, aspect: f32) -> f32 {
        4.0 * self.tan_half_fov * self.tan_half_fov * self.aspect(aspect)
    }

    /// Position on the film of the ray from a point of the lens in the direction `away`, both in the frame of the camera: that of the
    /// point where the ray is in focus, at a distance of 1 for a pinhole.
    fn film(&self, on_lens: Vec3, away: Vec3, aspect: f32) -> Vec2 {
        let focus = on_lens / self.focus_distance + away / -away.z;
        Vec2::new(focus.x / (self.tan_half_fov * self.aspect(aspect)), -focus.y / self.tan_half_fov) * 0.5 + 0.5
    }
}

/// tan(θ/2), with θ in degrees. It uses pt's own sine and cosine, which have the same bits on all machines.
fn tan_half(degrees: f64) -> f64 {
    let (sin, cos) = float::sin_cos_degrees(0.5 * degrees);
    sin / cos
}
