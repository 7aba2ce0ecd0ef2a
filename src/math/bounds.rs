//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box; empty where `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    pub min: Vec3,
    pub max: Vec3,
}

impl Aabb {
    pub const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, |b, p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Half the diagonal: the radius of the sphere around the box; 0 where empty.
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.max - self.min).length() }
    }

    /// The largest |coordinate|, per axis.
    pub fn magnitude(&self) -> Vec3 {
        self.min.abs().max(self.max.abs())
    }

    /// Of all six faces (m²); 0 where empty.
    pub fn area(&self) -> f64 {
        let [x, y, z] = if self.is_empty() { [0.0; 3] } else { (self.max.as_dvec3() - self.min.as_dvec3()).to_array() };
        2.0 * (x * y + y * z + z * x)
    }

    /// Larger on every side by `by` per axis.
    pub fn padded(&self, by: Vec3) -> Aabb {
        Aabb { min: self.min - by, max: self.max + by }
    }
}
