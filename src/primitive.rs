//! Interface of everything that rays can hit.

use glam::Vec2;

use crate::math::{Aabb, Ray};

/// Hit of a ray with a surface, as plain data. [`crate::scene::Scene::surface`] computes the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the shape.
    pub shape: u32,
    /// Index of the primitive within the shape.
    pub primitive: u32,
    /// Coordinates on the primitive, as defined by the kind of shape.
    pub uv: Vec2,
    /// Ray parameter (m).
    pub t: f32,
}

/// Set of surfaces that rays can hit, such as a list or a hierarchy.
pub trait Primitive: Send + Sync {
    /// Bounding box.
    fn bounds(&self) -> Aabb;

    /// Nearest hit with 0 < t < `ray.t_max`. Of equally near hits, the one with the lowest shape index, then primitive index.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether there is a hit with 0 < t < `ray.t_max`.
    fn occluded(&self, ray: &Ray) -> bool {
        self.intersect(ray).is_some()
    }
}
