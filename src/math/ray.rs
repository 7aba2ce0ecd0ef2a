//! A half-line, or a piece of one.

use glam::Vec3;

/// The points `origin + t·direction` with 0 < t < `t_max` (m).
///
/// There is no smallest t: rays that leave a surface start beside it, farther off than its
/// error bound (`Surface::spawn`), so that every hit counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    /// The surface point that the ray leaves, beside which `origin` lies; `origin` itself where it leaves none.
    pub from: Vec3,
    /// Unit length.
    pub direction: Vec3,
    pub t_max: f32,
    /// When, as a share of the shutter interval: [0, 1).
    pub time: f32,
}

impl Ray {
    /// A ray that leaves no surface.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, from: origin, direction, t_max: f32::INFINITY, time: 0.0 }
    }

    /// Returns the part of the ray within `distance` of the point that it leaves (m).
    pub fn within(self, distance: f32) -> Ray {
        Ray { t_max: distance - (self.origin - self.from).dot(self.direction), ..self }
    }

    /// Returns the length of the way from the point that the ray leaves to a surface that it meets at `t` (m).
    ///
    /// t + (o − p)·n / (w·n), with o the origin of the ray, p the point that it leaves, w its direction
    ///
    /// - `n`: the geometric normal where it is met
    ///
    /// The offset of the origin shifts the whole ray; both rays are followed to the tangent plane where the shifted one ends.
    /// That is exact between flat faces, where t alone would miss offset / cos θ. Between curved ones it is off by the square of
    /// the offset over their radius. Where the ray meets the plane at so small an angle that this would be more than t itself, the
    /// plane says nothing: there it is the distance of the two points, |o + t w − p|.
    ///
    /// Tests: absorption_knows_no_offset, throughputs_follow_from_the_vertices.
    pub fn length(&self, t: f32, n: Vec3) -> f32 {
        let offset = self.origin - self.from;
        let shift = offset.dot(n) / self.direction.dot(n);
        if shift.abs() <= t { t + shift } else { (offset + self.direction * t).length() }
    }

    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}
