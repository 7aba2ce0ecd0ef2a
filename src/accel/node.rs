//! Eight boxes side by side.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::bits;
use crate::math::{Aabb, Ray};

pub const WIDTH: usize = 8;

/// Deeper than this, what is left becomes one leaf, so that the walk's stack stays bounded: eight to a node,
/// only boxes nested in one another get there.
pub const MAX_DEPTH: usize = 24;

/// Each level leaves at most WIDTH − 1 children waiting.
pub const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// Up to [`WIDTH`] children; unused slots hold boxes that nothing meets.
#[repr(align(64))]
#[derive(Clone)]
pub struct Node {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
    pub child: [Child; WIDTH],
}

/// An inner node, or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

const LEAF: u32 = 1 << 31;

impl Child {
    pub fn inner(index: usize) -> Child {
        Child(index as u32)
    }

    pub fn leaf(index: usize) -> Child {
        Child(index as u32 | LEAF)
    }

    /// `Ok` with the index of a node, `Err` with that of a leaf.
    #[inline(always)]
    pub fn get(self) -> Result<usize, usize> {
        if self.0 & LEAF == 0 { Ok(self.0 as usize) } else { Err((self.0 & !LEAF) as usize) }
    }
}

/// What the box tests need to know of a ray.
pub struct Slabs {
    origin: [f32; 3],
    inverse: [f32; 3],
    negative: [bool; 3],
}

impl Slabs {
    pub fn new(ray: &Ray) -> Slabs {
        // Finite, so that a ray that starts in the plane of a face and runs along it gives 0, not 0·∞.
        let inverse = ray.direction.to_array().map(|d| (1.0 / d).clamp(-f32::MAX, f32::MAX));
        Slabs { origin: ray.origin.to_array(), inverse, negative: ray.direction.to_array().map(|d| d.is_sign_negative()) }
    }
}

/// 1 + 2γ(3): covers the rounding of both slab distances, so that no box is missed that exact arithmetic meets,
/// and of the entry distance compared with that of a hit, so that equally near hits are all seen.
///
/// Source: Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013.
pub const WIDEN: f32 = 1.0 + 2.0 * (3.0 * 0.5 * f32::EPSILON) + f32::EPSILON;

impl Node {
    pub fn new(children: &[(Aabb, Child)]) -> Node {
        let mut node = Node { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3], child: [Child(LEAF); WIDTH] };
        for (slot, (bounds, child)) in children.iter().enumerate() {
            for axis in 0..3 {
                node.min[axis][slot] = bounds.min[axis];
                node.max[axis][slot] = bounds.max[axis];
            }
            node.child[slot] = *child;
        }
        node
    }

    /// The distance at which the ray enters each box, and a bit for each that it meets before `t_max`.
    ///
    /// Comparisons, not `f32::min`: they map to one instruction each, and NaN keeps the old value.
    #[inline(always)]
    pub fn meet(&self, slabs: &Slabs, t_max: f32) -> ([f32; WIDTH], u32) {
        let mut near = [0f32; WIDTH];
        let mut far = [t_max * WIDEN; WIDTH];
        for axis in 0..3 {
            let (enter, leave) = if slabs.negative[axis] { (&self.max[axis], &self.min[axis]) } else { (&self.min[axis], &self.max[axis]) };
            let (origin, inverse) = (slabs.origin[axis], slabs.inverse[axis]);
            for i in 0..WIDTH {
                let t = (enter[i] - origin) * inverse;
                near[i] = if t > near[i] { t } else { near[i] };
                let t = (leave[i] - origin) * inverse * WIDEN;
                far[i] = if t < far[i] { t } else { far[i] };
            }
        }
        let mask = (0..WIDTH).fold(0, |mask, i| mask | ((near[i] <= far[i]) as u32) << i);
        (near, mask)
    }

    /// Pushes the children that the ray meets before `t_max` with their distances, the nearest last.
    #[inline(always)]
    pub fn push_met(&self, slabs: &Slabs, t_max: f32, stack: &mut ArrayVec<(f32, Child), STACK>) {
        let (near, met) = self.meet(slabs, t_max);
        let first = stack.len();
        for i in bits(met) {
            let entry = (near[i], self.child[i]);
            stack.push(entry);
            let waiting = &mut stack[first..];
            let mut at = waiting.len() - 1;
            while at > 0 && waiting[at - 1].0 < entry.0 {
                waiting[at] = waiting[at - 1];
                at -= 1;
            }
            waiting[at] = entry;
        }
    }
}

/// Two units in the last place of the largest coordinate: what the bounds of every item are padded by,
/// since the corners they bound were themselves rounded once.
pub fn padding(scene: &Aabb) -> Vec3 {
    Vec3::splat(2.0 * f32::EPSILON * scene.magnitude().max_element())
}
