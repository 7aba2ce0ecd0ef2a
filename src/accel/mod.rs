//! Acceleration structures for ray intersection.

mod build;
mod bvh;
mod cut;
mod list;
mod node;
mod packet;
mod simd;

use std::sync::Arc;

use crate::primitive::Primitive;
use crate::shape::{FacetUv, Shape};

pub use list::List;

/// Shapes of a scene.
pub(crate) type Shapes = Arc<[Box<dyn Shape>]>;

/// Builds a hierarchy over all primitives of the shapes.
pub fn build(shapes: Shapes) -> Box<dyn Primitive> {
    Box::new(bvh::Bvh::new(shapes))
}

/// Item of the hierarchy: a triangle or a curved primitive. Items are ordered by shape, then by primitive, so that of equally near hits
/// the one with the lowest item is preferred.
#[derive(Clone, Copy, Debug)]
struct Item {
    shape: u32,
    primitive: u32,
    facet_uv: FacetUv,
}

/// Positions of the bits that are 1, from the lowest.
#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        lowest
    })
}
