//! Construction of the hierarchy: obvhs builds a binary hierarchy, which is collapsed to eight children per node.

use std::hash::{DefaultHasher, Hash, Hasher};

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use super::cut::{Cuts, MAX_LEAF};
use super::node::{Child, MAX_DEPTH, Node};
use crate::math::Aabb;
use crate::math::float::unit_f32;

/// Wide hierarchy.
pub struct Wide {
    /// Inner nodes.
    pub nodes: Vec<Node>,
    /// Root.
    pub root: Child,
}

/// Builds a hierarchy over boxes in the order of item numbers; `None` if there are no boxes.
///
/// - `first_instance`: number of the first item that is an instance, whose test takes so long that each gets a leaf of its own
/// - `leaf`: makes a leaf of some item numbers
pub fn wide(boxes: &[Aabb], first_instance: usize, leaf: impl FnMut(&[u32]) -> Child) -> Option<Wide> {
    if boxes.is_empty() {
        return None;
    }
    let duplicates = duplicates(boxes);
    let firsts = firsts(boxes.len(), &duplicates);
    let boxes: Vec<Aabb> = firsts.iter().map(|&item| boxes[item as usize]).collect();
    let weight = |item: u32| if (item as usize) < first_instance { 1 } else { 1 + MAX_LEAF };
    let weights: Vec<u32> = firsts.iter().map(|&item| weight(item) + later(&duplicates, item).map(weight).sum::<u32>()).collect();
    let binary = binary_hierarchy(&boxes);
    let mut collapse = CollapseState {
        cuts: Cuts::new(&binary, &boxes, &weights),
        firsts: &firsts,
        duplicates: &duplicates,
        nodes: vec![],
        make_leaf: leaf,
    };
    let root = collapse.subtree(0, 0);
    Some(Wide { nodes: collapse.nodes, root })
}

/// Item and a later one with exactly the same box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Duplicate {
    first: u32,
    later: u32,
}

/// Items that have the same box as an earlier item, in order. They are put into the leaf of that item.
///
/// A hierarchy cannot separate equal boxes, and clustering and reinsertion would take quadratic time on them.
///
/// Tests: coincident_boxes_are_one_leaf.
fn duplicates(boxes: &[Aabb]) -> Vec<Duplicate> {
    let hash = |(item, b): (usize, &Aabb)| {
        let mut hasher = DefaultHasher::new();
        [b.min, b.max].map(|corner| corner.to_array().map(f32::to_bits)).hash(&mut hasher);
        (hasher.finish(), item as u32)
    };
    let mut hashed: Vec<(u64, u32)> = boxes.par_iter().enumerate().map(hash).collect();
    hashed.par_sort_unstable();
    let mut duplicates = vec![];
    for run in hashed.chunk_by(|a, b| a.0 == b.0) {
        let first = run[0].1;
        // Different boxes with equal hashes are left to the clustering.
        let equal = run[1..].iter().filter(|(_, item)| boxes[*item as usize] == boxes[first as usize]);
        duplicates.extend(equal.map(|&(_, later)| Duplicate { first, later }));
    }
    duplicates.sort_unstable();
    duplicates
}

/// Later duplicates of `first`.
fn later(duplicates: &[Duplicate], first: u32) -> impl Iterator<Item = u32> {
    let start = duplicates.partition_point(|duplicate| duplicate.first < first);
    duplicates[start..].iter().take_while(move |duplicate| duplicate.first == first).map(|duplicate| duplicate.later)
}

/// All items except the later duplicates.
fn firsts(count: usize, duplicates: &[Duplicate]) -> Vec<u32> {
    let mut is_first = vec![true; count];
    duplicates.iter().for_each(|duplicate| is_first[duplicate.later as usize] = false);
    (0..count as u32).filter(|&item| is_first[item as usize]).collect()
}

/// Binary hierarchy by agglomerative clustering and reinsertion of the worst fifth of the nodes. Its quality is near that of a full
/// sweep of the surface area heuristic, in a fraction of the time.
fn binary_hierarchy(boxes: &[Aabb]) -> Bvh2 {
    let boxes: Vec<obvhs::aabb::Aabb> = boxes.iter().enumerate().map(|(item, b)| uneven(item, b)).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    let mut binary = builder.build(PlocSearchDistance::Medium, &boxes, indices, SortPrecision::U64, 3);
    ReinsertionOptimizer::default().run(&mut binary, 0.2, None);
    binary
}

/// Box enlarged by up to a thousandth, by a different fraction for each item.
///
/// Clustering joins nearest neighbours. In a row of equal boxes all distances are equal, so that only one pair would be joined per
/// round, and the time would grow quadratically. No hit depends on the enlarged boxes, because the nodes get the true ones.
///
/// Tests: rows_take_few_rounds.
fn uneven(item: usize, b: &Aabb) -> obvhs::aabb::Aabb {
    // Multiples of the golden ratio modulo 1 differ widely for neighbouring items.
    let share = unit_f32((item as u32).wrapping_mul(0x9e37_79b9));
    let by = (b.max - b.min) * (share / 1024.0);
    obvhs::aabb::Aabb::new(b.min.into(), (b.max + by).into())
}

/// State of collapsing the binary hierarchy to a wide one.
struct CollapseState<'a, F> {
    cuts: Cuts<'a>,
    /// Items in the order of the binary hierarchy.
    firsts: &'a [u32],
    duplicates: &'a [Duplicate],
    nodes: Vec<Node>,
    make_leaf: F,
}

impl<F: FnMut(&[u32]) -> Child> CollapseState<'_, F> {
    fn subtree(&mut self, index: usize, depth: usize) -> Child {
        let children = self.cuts.children(index);
        if children.is_empty() || depth == MAX_DEPTH {
            return self.leaf(index);
        }
        let slot = self.nodes.len();
        self.nodes.push(Node::new(vec![]));
        let children = children.into_iter().map(|c| (self.cuts.bounds(c), self.subtree(c, depth + 1))).collect();
        self.nodes[slot] = Node::new(children);
        Child::inner(slot)
    }

    fn leaf(&mut self, index: usize) -> Child {
        let mut items: Vec<u32> = self.cuts.items(index).into_iter().map(|i| self.firsts[i as usize]).collect();
        for first in items.clone() {
            items.extend(later(self.duplicates, first));
        }
        items.sort_unstable();
        (self.make_leaf)(&items)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use obvhs::bvh2::DEFAULT_MAX_STACK_DEPTH;

    use super::*;

    /// Number of rounds of clustering, if it exceeds the least stack depth of obvhs.
    ///
    /// Each round visits all remaining clusters, so that a build is fast only if there are few rounds.
    fn rounds(boxes: &[Aabb]) -> usize {
        binary_hierarchy(boxes).max_depth
    }

    fn unit_box(corner: Vec3) -> Aabb {
        Aabb { min: corner, max: corner + 1.0 }
    }

    /// Coincident boxes are not passed to clustering and reinsertion, which would take quadratic time.
    #[test]
    fn coincident_boxes_are_one_leaf() {
        let mut leaves = vec![];
        let built = wide(&[unit_box(Vec3::ZERO); 10_000], 10_000, |items| {
            leaves.push(items.to_vec());
            Child::mixed(0)
        });
        assert_eq!((built.expect("boxes").nodes.len(), leaves), (0, vec![(0..10_000).collect()]));
    }

    /// If each round joins a fixed fraction of the clusters, the number of rounds grows logarithmically: log₂ 50,000 = 16, or 86 if a
    /// round joins only one cluster in six. A row of boxes with equal distances would take one round per box.
    #[test]
    fn rows_take_few_rounds() {
        for step in [1.0, 0.5, 1e-3] {
            let row: Vec<Aabb> = (0..50_000).map(|k| unit_box(Vec3::X * (k as f32 * step))).collect();
            let rounds = rounds(&row);
            assert!(rounds <= DEFAULT_MAX_STACK_DEPTH, "{rounds} rounds for a row of boxes {step} apart");
        }
    }
}
