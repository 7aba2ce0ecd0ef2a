//! Rays.

use glam::Vec3;

/// Points `origin + t·direction` with 0 < t < `t_max` (m).
///
/// There is no least t, because rays that leave a surface start off it by more than its error bound (`Surface::spawn`), so that every
/// hit counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Point at t = 0 (m).
    pub origin: Vec3,
    /// Surface point that the ray leaves, near `origin`; `origin` itself if the ray leaves no surface.
    pub from: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// End of the ray (m).
    pub t_max: f32,
    /// Time as a fraction of the shutter interval, in [0, 1).
    pub time: f32,
}

impl Ray {
    /// A ray that leaves no surface.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, from: origin, direction, t_max: f32::INFINITY, time: 0.0 }
    }

    /// The part of the ray within `distance` of the point that it leaves (m).
    pub fn within(self, distance: f32) -> Ray {
        Ray { t_max: distance - (self.origin - self.from).dot(self.direction), ..self }
    }

    /// Length of the path from the point that the ray leaves to a surface that it hits at `t` (m).
    ///
    /// t + (o − p)·n / (w·n), where o is the origin of the ray, p the point that it leaves, and w its direction
    ///
    /// - `n`: geometric normal at the hit
    ///
    /// The offset of the origin shifts the whole ray. The formula is the length of the unshifted ray to the tangent plane at the hit. It
    /// is exact between flat faces, where t alone has an error of offset / cos θ, and has an error of the square of the offset over the
    /// radius between curved ones. If the correction exceeds t, because the ray is nearly parallel to the plane, the result is the
    /// distance of the two points, |o + t w − p|.
    ///
    /// Tests: absorption_does_not_depend_on_ray_offsets, throughputs_follow_from_the_vertices.
    pub fn length(&self, t: f32, n: Vec3) -> f32 {
        let offset = self.origin - self.from;
        let shift = offset.dot(n) / self.direction.dot(n);
        if shift.abs() <= t { t + shift } else { (offset + self.direction * t).length() }
    }

    /// Point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}
