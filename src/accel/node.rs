//! Nodes with eight child boxes.

use arrayvec::ArrayVec;
use glam::{Vec3, Vec3A};

use crate::math::lanes::each_lane;
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
// The children share a cache line with a face, so that they arrive with it.
#[repr(C, align(64))]
#[derive(Clone)]
pub struct Node {
    /// Children.
    pub child: [Child; WIDTH],
    /// Lower faces along x, y, z, then upper faces, with one lane per child.
    faces: [[f32; WIDTH]; 6],
}

/// Reference to an inner node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

/// What a [`Child`] refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Inner node with this index.
    Inner(usize),
    /// Leaf of at most eight triangles: the first of them, and their number.
    Run(usize, usize),
    /// Leaf of a bundle of slender items, with this index.
    Bundle(usize),
    /// Leaf of any items, with this index.
    Mixed(usize),
}

const LEAF: u32 = 1 << 31;
const MIXED: u32 = 1 << 30;
/// Set in addition to [`MIXED`]: the leaf is a bundle, and the lower bits are its index.
const BUNDLE: u32 = 1 << 29;
/// Position of the number of triangles less 1, in three bits. The index of the first triangle is below.
const COUNT_AT: u32 = 27;

impl Child {
    /// Reference to the inner node with this index.
    pub fn inner(index: usize) -> Child {
        Child(index as u32)
    }

    /// Reference to a run of triangles, from 1 to 8; `None` if the index of the first is too great for 27 bits.
    pub fn run(first: usize, count: usize) -> Option<Child> {
        (first >> COUNT_AT == 0).then_some(Child(LEAF | (count as u32).wrapping_sub(1) << COUNT_AT | first as u32))
    }

    /// Reference to the bundle with this index.
    pub fn bundle(index: usize) -> Child {
        Child(LEAF | MIXED | BUNDLE | index as u32)
    }

    /// Reference to the leaf of any items with this index.
    pub fn mixed(index: usize) -> Child {
        Child(LEAF | MIXED | index as u32)
    }

    /// What this refers to.
    #[inline(always)]
    pub fn target(self) -> Target {
        let Child(bits) = self;
        if bits & LEAF == 0 {
            Target::Inner(bits as usize)
        } else if bits & MIXED == 0 {
            Target::Run((bits & ((1 << COUNT_AT) - 1)) as usize, (bits >> COUNT_AT & 7) as usize + 1)
        } else if bits & BUNDLE != 0 {
            Target::Bundle((bits & (BUNDLE - 1)) as usize)
        } else {
            Target::Mixed((bits & (BUNDLE - 1)) as usize)
        }
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
    ///
    /// The children are sorted so that the last ones most likely stop a ray for the least work: triangles and bundles after inner nodes, curved
    /// items and instances before them, and large boxes after small ones.
    pub fn new(mut children: Vec<(Aabb, Child)>) -> Node {
        let rank = |child: Child| match child.target() {
            Target::Mixed(_) => 0,
            Target::Inner(_) => 1,
            Target::Run(..) | Target::Bundle(_) => 2,
        };
        children.sort_by(|(a, x), (b, y)| rank(*x).cmp(&rank(*y)).then(a.area().total_cmp(&b.area())));
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

    /// Places of the children, with the lower and upper corner of their boxes.
    #[inline(always)]
    pub fn boxes(&self) -> impl Iterator<Item = (usize, [Vec3; 2])> {
        let corner =
            |slot: usize, first: usize| Vec3::new(self.faces[first][slot], self.faces[first + 1][slot], self.faces[first + 2][slot]);
        // Places without a child come last.
        (0..WIDTH).take_while(|&slot| self.faces[0][slot] < f32::INFINITY).map(move |slot| (slot, [corner(slot, 0), corner(slot, 3)]))
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

    /// Nearest child that the ray hits before `t_max`, with its distance. The others are pushed, the nearest last.
    #[inline(always)]
    pub fn nearest<L: Lanes, T: Tolerance>(
        &self,
        slabs: &Slabs<L>,
        t_max: f32,
        stack: &mut ArrayVec<(f32, Child), STACK>,
    ) -> Option<(f32, Child)> {
        let (near, hits) = self.intersect::<L, T>(slabs, t_max);
        if hits == 0 {
            return None;
        }
        let near = near.to_array();
        let mut hits = each_lane(hits).map(|i| (near[i], self.child[i]));
        let mut nearest = hits.next()?;
        let first = stack.len();
        for mut entry in hits {
            if entry.0 < nearest.0 {
                std::mem::swap(&mut entry, &mut nearest);
            }
            stack.push(entry);
            let pushed = &mut stack[first..];
            let mut at = pushed.len() - 1;
            while at > 0 && pushed[at - 1].0 < entry.0 {
                pushed[at] = pushed[at - 1];
                at -= 1;
            }
            pushed[at] = entry;
        }
        Some(nearest)
    }
}

/// Bounds of an item, padded by two units in the last place of its own greatest coordinate, because bounds of curved shapes and of
/// instances were rounded once. The box test needs no padding of its own: see [`WIDEN`].
///
/// The padding does not depend on the rest of the scene. If it did, one object far away would enlarge the boxes of all others.
///
/// Tests: far_objects_leave_the_boxes_of_others_alone.
pub fn padded(item: &Aabb) -> Aabb {
    item.padded(Vec3::splat(2.0 * f32::EPSILON * item.magnitude().max_element()))
}
