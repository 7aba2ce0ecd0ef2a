//! Axis-aligned boxes.

use glam::Vec3;

/// Axis-aligned box. It is empty if `min` exceeds `max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Smallest box around some points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, |b, p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Smallest box around both boxes.
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Centre.
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Radius of the sphere around the box, half its diagonal; 0 if the box is empty.
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.max - self.min).length() }
    }

    /// Greatest |coordinate| on each axis.
    pub fn magnitude(&self) -> Vec3 {
        self.min.abs().max(self.max.abs())
    }

    /// Area of all six faces (m²); 0 if the box is empty.
    pub fn area(&self) -> f64 {
        let [x, y, z] = if self.is_empty() { [0.0; 3] } else { (self.max.as_dvec3() - self.min.as_dvec3()).to_array() };
        2.0 * (x * y + y * z + z * x)
    }

    /// The box enlarged on every side by `by`.
    pub fn padded(&self, by: Vec3) -> Aabb {
        Aabb { min: self.min - by, max: self.max + by }
    }
}
