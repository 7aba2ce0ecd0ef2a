//! Acceleration structures for ray intersection.

mod build;
mod bundle;
mod bvh;
mod cut;
mod leaves;
mod list;
mod node;
mod packet;

use std::sync::Arc;

use crate::primitive::{Instance, Primitive};
use crate::shape::{FacetUv, Shape};

pub(crate) use bvh::Bvh;
pub use list::List;
pub(crate) use packet::NO_PLACE;
pub use packet::{Hits, intersect_all, occluded_all};

/// Shapes of a scene.
pub(crate) type Shapes = Arc<[Box<dyn Shape>]>;

/// Builds a hierarchy over all primitives of the shapes.
pub fn build(shapes: Shapes) -> Box<dyn Primitive> {
    let all = 0..shapes.len() as u32;
    build_with_instances(shapes, all.collect(), vec![])
}

/// Builds a hierarchy over the primitives of some shapes, and over instances.
///
/// - `shapes`: all shapes of a scene, by whose indices hits name them
/// - `own`: indices of the shapes of this hierarchy
/// - `instances`: numbered in their order from 1, each followed by the instances within it
pub fn build_with_instances(shapes: Shapes, own: Vec<u32>, instances: Vec<Instance>) -> Box<dyn Primitive> {
    Box::new(bvh::Bvh::new(shapes, own, instances))
}

/// Item of the hierarchy: a triangle, a curved primitive or an instance. Items are ordered by shape, then by primitive, and instances
/// follow, so that of equally near hits the one with the lowest item is preferred.
#[derive(Clone, Copy, Debug)]
struct Item {
    /// Index of the shape; [`INSTANCE`] for an instance.
    shape: u32,
    /// Index of the primitive within the shape, or index of the instance.
    primitive: u32,
    facet_uv: FacetUv,
}

/// Mark of items that are instances.
const INSTANCE: u32 = u32::MAX;
