//! Nodes with eight child boxes.

use arrayvec::ArrayVec;
use glam::{Vec3, Vec3A};

use super::bits;
use crate::math::simd::{Lanes, splat};
use crate::math::{Aabb, Ray};
use crate::shape::triangle::Tolerance;

/// Number of children of a node.
pub const WIDTH: usize = 8;

/// Depth at which the remaining items become one leaf, so that the stack of the traversal is bounded. With eight children per node,
/// only deeply nested boxes reach it.
pub const MAX_DEPTH: usize = 24;

/// Greatest size of the stack: each level leaves at most WIDTH − 1 children on it.
pub const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// Node with up to [`WIDTH`] children. Unused slots have boxes that no ray hits.
#[repr(align(64))]
#[derive(Clone)]
pub struct Node {
    /// Lower faces along x, y, z, then upper faces, with one lane per child.
    faces: [[f32; WIDTH]; 6],
    /// Children.
    pub child: [Child; WIDTH],
}

/// Reference to an inner node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

const LEAF: u32 = 1 << 31;

impl Child {
    /// Reference to the inner node with this index.
    pub fn inner(index: usize) -> Child {
        Child(index as u32)
    }

    /// Reference to the leaf with this index.
    pub fn leaf(index: usize) -> Child {
        Child(index as u32 | LEAF)
    }

    /// `Ok` with the index of an inner node, or `Err` with the index of a leaf.
    #[inline(always)]
    pub fn get(self) -> Result<usize, usize> {
        if self.0 & LEAF == 0 { Ok(self.0 as usize) } else { Err((self.0 & !LEAF) as usize) }
    }
}

/// Ray prepared for box tests, per axis.
pub struct Slabs<L> {
    /// Origin; with a tolerance, moved by it along each axis as the direction points, so that faces are met earlier.
    origin: [L; 3],
    /// Origin moved the other way, so that faces are left later. Not used without a tolerance.
    leave_origin: [L; 3],
    inverse: [L; 3],
    /// `inverse` times [`WIDEN`].
    widened: [L; 3],
    /// Indices of the faces through which the ray enters and leaves.
    enter: [usize; 3],
    leave: [usize; 3],
}

impl<L: Lanes> Slabs<L> {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new<T: Tolerance>(ray: &Ray, tolerance: T) -> Slabs<L> {
        let direction = ray.direction.to_array();
        // The inverse is finite, so that a ray which starts in the plane of a face and runs along it gives 0 and not 0·∞.
        const BOUND: f32 = f32::MAX / 2.0;
        let inverse = (1.0 / Vec3A::from(ray.direction)).max(Vec3A::splat(-BOUND)).min(Vec3A::splat(BOUND)).to_array();
        let upper = direction.map(|d| if d.is_sign_negative() { 3 } else { 0 });
        let moved = tolerance.get() * ray.direction.signum();
        let [entering, leaving] = if T::IS_EXACT { [ray.origin; 2] } else { [ray.origin + moved, ray.origin - moved] };
        Slabs {
            origin: splat(entering.to_array()),
            leave_origin: splat(leaving.to_array()),
            inverse: splat(inverse),
            widened: splat([inverse[0] * WIDEN, inverse[1] * WIDEN, inverse[2] * WIDEN]),
            enter: std::array::from_fn(|axis| axis + upper[axis]),
            leave: std::array::from_fn(|axis| axis + 3 - upper[axis]),
        }
    }
}

/// Factor 1 + 2γ(3), which covers the rounding of both slab distances, so that no box is missed that exact arithmetic hits, and of the
/// comparison of an entry distance with a hit, so that all equally near hits are found.
///
/// Source: Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013.
pub const WIDEN: f32 = 1.0 + 2.0 * (3.0 * 0.5 * f32::EPSILON) + f32::EPSILON;

impl Node {
    /// A node with the given boxes and children.
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

    /// Distance at which the ray enters each box, and a bit mask of the boxes that it hits before `t_max`.
    #[inline(always)]
    pub fn intersect<L: Lanes, T: Tolerance>(&self, slabs: &Slabs<L>, t_max: f32) -> (L, u32) {
        let (mut near, mut far) = (L::splat(0.0), L::splat(t_max * WIDEN));
        for axis in 0..3 {
            let (enter, leave) = (L::load(&self.faces[slabs.enter[axis]]), L::load(&self.faces[slabs.leave[axis]]));
            near = enter.minus(slabs.origin[axis]).times(slabs.inverse[axis]).larger(near);
            far = leave
                .minus(if T::IS_EXACT { slabs.origin[axis] } else { slabs.leave_origin[axis] })
                .times(slabs.widened[axis])
                .smaller(far);
        }
        (near, near.at_most(far))
    }

    /// Pushes the children that the ray hits before `t_max` with their distances, the nearest last.
    #[inline(always)]
    pub fn push_hits<L: Lanes, T: Tolerance>(&self, slabs: &Slabs<L>, t_max: f32, stack: &mut ArrayVec<(f32, Child), STACK>) {
        let (near, hits) = self.intersect::<L, T>(slabs, t_max);
        let near = near.to_array();
        let first = stack.len();
        for i in bits(hits) {
            let entry = (near[i], self.child[i]);
            stack.push(entry);
            let pushed = &mut stack[first..];
            let mut at = pushed.len() - 1;
            while at > 0 && pushed[at - 1].0 < entry.0 {
                pushed[at] = pushed[at - 1];
                at -= 1;
            }
            pushed[at] = entry;
        }
    }
}

/// Padding of the bounds of every item: two units in the last place of the greatest coordinate, because the corners themselves were
/// rounded once.
pub fn padding(scene: &Aabb) -> Vec3 {
    Vec3::splat(2.0 * f32::EPSILON * scene.magnitude().max_element())
}
