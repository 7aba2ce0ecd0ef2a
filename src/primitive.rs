//! Anything a ray can meet.

use glam::Vec2;

use crate::math::{Aabb, Ray};

/// Which surface point a ray met, as plain data; [`crate::scene::Scene::surface`] tells the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub shape: u32,
    pub primitive: u32,
    /// The shape family's own coordinates.
    pub uv: Vec2,
    /// (m)
    pub t: f32,
}

/// Something a ray can meet: one shape's primitives, a list, a hierarchy.
pub trait Primitive: Send + Sync {
    fn bounds(&self) -> Aabb;

    /// The nearest hit with 0 < t < `ray.t_max`; of equally near ones, that of the lowest shape, then primitive.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether there is any hit with 0 < t < `ray.t_max`.
    fn occluded(&self, ray: &Ray) -> bool {
        self.intersect(ray).is_some()
    }
}
