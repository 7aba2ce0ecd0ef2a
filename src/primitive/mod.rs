//! Interface of everything that rays can hit, and instances: groups of it at several places.

mod instance;

use std::any::Any;
use std::num::NonZeroU32;

use glam::Vec2;

use crate::math::{Aabb, Ray};

pub use instance::{Group, Instance, Nesting};

/// Hit of a ray with a surface, as plain data. [`crate::scene::Scene::surface`] computes the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Instance that was hit; `None` for a shape of the scene itself.
    pub instance: Option<InstanceId>,
    /// Index of the shape.
    pub shape: u32,
    /// Index of the primitive within the shape.
    pub primitive: u32,
    /// Coordinates on the primitive, as defined by the kind of shape.
    pub uv: Vec2,
    /// Ray parameter (m).
    pub t: f32,
}

/// Number of an instance, from 1, in the order of a walk through the tree of all instances: each is followed by those within it. What an
/// instance of a group contains is counted for each instance of the group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InstanceId(NonZeroU32);

impl InstanceId {
    /// The id with this number; `None` for 0.
    pub fn new(number: u32) -> Option<InstanceId> {
        NonZeroU32::new(number).map(InstanceId)
    }

    /// The number.
    pub fn get(self) -> u32 {
        self.0.get()
    }
}

/// Greatest number of instances within each other.
pub const MAX_NESTING: usize = 8;

/// Set of surfaces that rays can hit, such as a list or a hierarchy.
pub trait Primitive: Any + Send + Sync {
    /// Bounding box.
    fn bounds(&self) -> Aabb;

    /// Nearest hit with 0 < t < `ray.t_max`. Of equally near hits, the one with the lowest shape index, then primitive index; instances
    /// follow all shapes.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether there is a hit with 0 < t < `ray.t_max`.
    fn occluded(&self, ray: &Ray) -> bool {
        self.intersect(ray).is_some()
    }

    /// Nearest hit of a ray that is known only to within a distance: triangles that the ray passes at most that far outside are hit too.
    ///
    /// Rays that enter an instance are rounded in its space. Without the tolerance they could pass between instances that touch.
    ///
    /// - `tolerance`: distance (m)
    fn intersect_with_tolerance(&self, ray: &Ray, _tolerance: f32) -> Option<Hit> {
        self.intersect(ray)
    }

    /// Whether [`Primitive::intersect_with_tolerance`] finds a hit.
    fn occluded_with_tolerance(&self, ray: &Ray, tolerance: f32) -> bool {
        self.intersect_with_tolerance(ray, tolerance).is_some()
    }

    /// Number of instances, including those within them.
    fn instance_count(&self) -> u32 {
        0
    }

    /// Instance with this number and those around it at a time, the outermost first; empty if there are no instances.
    fn instance(&self, _id: InstanceId, _time: f32) -> Nesting<'_> {
        Nesting::default()
    }
}
