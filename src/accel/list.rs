//! Intersection by testing every primitive.

use super::Shapes;
use crate::math::{Aabb, Ray};
use crate::primitive::{Hit, Primitive};

/// List of shapes whose primitives are all tested. It is the reference in tests of the hierarchy.
pub struct List {
    shapes: Shapes,
}

impl List {
    /// A list of shapes.
    pub fn new(shapes: Shapes) -> List {
        List { shapes }
    }
}

impl Primitive for List {
    fn bounds(&self) -> Aabb {
        let all = self.shapes.iter().flat_map(|shape| (0..shape.count()).map(|i| shape.bounds(i)));
        all.fold(Aabb::EMPTY, Aabb::union)
    }

    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut nearest = None;
        let mut ray = *ray;
        for (k, shape) in self.shapes.iter().enumerate() {
            for primitive in 0..shape.count() {
                // A later primitive must be strictly nearer: t < t_max.
                if let Some(hit) = shape.intersect(primitive, &ray) {
                    ray.t_max = hit.t;
                    nearest = Some(Hit { instance: None, shape: k as u32, primitive, uv: hit.uv, t: hit.t });
                }
            }
        }
        nearest
    }
}
