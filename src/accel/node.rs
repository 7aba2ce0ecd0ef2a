//! Eight boxes side by side.

use arrayvec::ArrayVec;
use glam::{Vec3, Vec3A};

use super::bits;
use super::simd::Lanes;
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
    /// The lower faces along x, y, z, then the upper ones; a lane for each child.
    faces: [[f32; WIDTH]; 6],
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

/// What the box tests need to know of a ray, per axis.
pub struct Slabs<L> {
    origin: [L; 3],
    inverse: [L; 3],
    /// Larger by [`WIDEN`].
    widened: [L; 3],
    /// Of the faces by which the ray enters and leaves.
    enter: [usize; 3],
    leave: [usize; 3],
}

impl<L: Lanes> Slabs<L> {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Slabs<L> {
        let direction = ray.direction.to_array();
        // Finite, so that a ray that starts in the plane of a face and runs along it gives 0, not 0·∞.
        const BOUND: f32 = f32::MAX / 2.0;
        let inverse = (1.0 / Vec3A::from(ray.direction)).max(Vec3A::splat(-BOUND)).min(Vec3A::splat(BOUND)).to_array();
        let upper = direction.map(|d| if d.is_sign_negative() { 3 } else { 0 });
        Slabs {
            origin: ray.origin.to_array().map(L::splat),
            inverse: inverse.map(L::splat),
            widened: inverse.map(|i| L::splat(i * WIDEN)),
            enter: std::array::from_fn(|axis| axis + upper[axis]),
            leave: std::array::from_fn(|axis| axis + 3 - upper[axis]),
        }
    }
}

/// 1 + 2γ(3): covers the rounding of both slab distances, so that no box is missed that exact arithmetic meets,
/// and of the entry distance compared with that of a hit, so that equally near hits are all seen.
///
/// Source: Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013.
pub const WIDEN: f32 = 1.0 + 2.0 * (3.0 * 0.5 * f32::EPSILON) + f32::EPSILON;

impl Node {
    pub fn new(children: &[(Aabb, Child)]) -> Node {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        let mut node = Node { faces: [low, low, low, high, high, high], child: [Child(LEAF); WIDTH] };
        for (slot, (bounds, child)) in children.iter().enumerate() {
            for axis in 0..3 {
                node.faces[axis][slot] = bounds.min[axis];
                node.faces[axis + 3][slot] = bounds.max[axis];
            }
            node.child[slot] = *child;
        }
        node
    }

    /// The distance at which the ray enters each box, and a bit for each that it meets before `t_max`.
    #[inline(always)]
    pub fn meet<L: Lanes>(&self, slabs: &Slabs<L>, t_max: f32) -> (L, u32) {
        let (mut near, mut far) = (L::splat(0.0), L::splat(t_max * WIDEN));
        for axis in 0..3 {
            let (enter, leave) = (L::load(&self.faces[slabs.enter[axis]]), L::load(&self.faces[slabs.leave[axis]]));
            near = enter.minus(slabs.origin[axis]).times(slabs.inverse[axis]).larger(near);
            far = leave.minus(slabs.origin[axis]).times(slabs.widened[axis]).smaller(far);
        }
        (near, near.at_most(far))
    }

    /// Pushes the children that the ray meets before `t_max` with their distances, the nearest last.
    #[inline(always)]
    pub fn push_met<L: Lanes>(&self, slabs: &Slabs<L>, t_max: f32, stack: &mut ArrayVec<(f32, Child), STACK>) {
        let (near, met) = self.meet(slabs, t_max);
        let near = near.to_array();
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
