//! A half-line, or a piece of one.

use glam::Vec3;

/// The points `origin + t·direction` with 0 < t < `t_max` (m).
///
/// There is no smallest t: rays that leave a surface start beside it, farther off than its
/// error bound (`Surface::spawn`), so that every hit counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    /// Unit length.
    pub direction: Vec3,
    pub t_max: f32,
    /// When, as a share of the shutter interval: [0, 1).
    pub time: f32,
}

impl Ray {
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_max: f32::INFINITY, time: 0.0 }
    }

    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}
