//! Finding the hit among millions: the only folder that knows how a hierarchy is built or walked.

mod build;
mod bvh;
mod cut;
mod list;
mod node;
mod packet;
mod simd;

use std::sync::Arc;

use crate::primitive::Primitive;
use crate::shape::{Fold, Shape};

pub use list::List;

pub(crate) type Shapes = Arc<[Box<dyn Shape>]>;

/// A hierarchy over every primitive of the shapes.
pub fn build(shapes: Shapes) -> Box<dyn Primitive> {
    Box::new(bvh::Bvh::new(shapes))
}

/// Which primitive an item of the hierarchy belongs to. Items count shapes, then primitives,
/// so that the order of items is the order in which equally near hits are preferred.
#[derive(Clone, Copy, Debug)]
struct Item {
    shape: u32,
    primitive: u32,
    fold: Fold,
}

/// The places of the ones, from the lowest.
#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        lowest
    })
}
