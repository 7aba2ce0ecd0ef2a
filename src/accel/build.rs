//! From boxes to a wide hierarchy: obvhs joins them in pairs, we fold the pairs into eights.

use std::hash::{DefaultHasher, Hash, Hasher};

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use super::cut::Cuts;
use super::node::{Child, MAX_DEPTH, Node};
use crate::math::Aabb;
use crate::math::float::unit_f32;

/// A hierarchy whose leaves are runs of item numbers.
pub struct Wide {
    pub nodes: Vec<Node>,
    pub leaves: Vec<Vec<u32>>,
    pub root: Child,
}

/// Over the given boxes, in the order of item numbers; `None` for no boxes.
pub fn wide(boxes: &[Aabb]) -> Option<Wide> {
    if boxes.is_empty() {
        return None;
    }
    let twins = twins(boxes);
    let firsts = firsts(boxes.len(), &twins);
    let boxes: Vec<Aabb> = firsts.iter().map(|&item| boxes[item as usize]).collect();
    let copies: Vec<u32> = firsts.iter().map(|&item| 1 + later(&twins, item).count() as u32).collect();
    let binary = pairs(&boxes);
    let mut fold = Fold {
        cuts: Cuts::new(&binary, &boxes, &copies),
        firsts: &firsts,
        twins: &twins,
        wide: Wide { nodes: vec![], leaves: vec![], root: Child::leaf(0) },
    };
    fold.wide.root = fold.subtree(0, 0);
    Some(fold.wide)
}

/// An item, and a later one with exactly the same box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Twin {
    first: u32,
    later: u32,
}

/// Items that share their box with an earlier one, in order; they join the leaf of that one.
///
/// No hierarchy can tell them apart, and clustering and reinsertion would take forever to try.
///
/// Tests: coincident_boxes_are_one_leaf.
fn twins(boxes: &[Aabb]) -> Vec<Twin> {
    let hash = |(item, b): (usize, &Aabb)| {
        let mut hasher = DefaultHasher::new();
        [b.min, b.max].map(|corner| corner.to_array().map(f32::to_bits)).hash(&mut hasher);
        (hasher.finish(), item as u32)
    };
    let mut hashed: Vec<(u64, u32)> = boxes.par_iter().enumerate().map(hash).collect();
    hashed.par_sort_unstable();
    let mut twins = vec![];
    for run in hashed.chunk_by(|a, b| a.0 == b.0) {
        let first = run[0].1;
        // Boxes of equal hash that differ, should there ever be any, are left to the clustering.
        let equal = run[1..].iter().filter(|(_, item)| boxes[*item as usize] == boxes[first as usize]);
        twins.extend(equal.map(|&(_, later)| Twin { first, later }));
    }
    twins.sort_unstable();
    twins
}

/// The later twins of `first`.
fn later(twins: &[Twin], first: u32) -> impl Iterator<Item = u32> {
    let start = twins.partition_point(|twin| twin.first < first);
    twins[start..].iter().take_while(move |twin| twin.first == first).map(|twin| twin.later)
}

/// All items but the later twins.
fn firsts(count: usize, twins: &[Twin]) -> Vec<u32> {
    let mut is_first = vec![true; count];
    twins.iter().for_each(|twin| is_first[twin.later as usize] = false);
    (0..count as u32).filter(|&item| is_first[item as usize]).collect()
}

/// Agglomerative clustering, then reinsertion of the worst fifth: near the quality of a full
/// sweep of the surface-area heuristic in a fraction of its time.
fn pairs(boxes: &[Aabb]) -> Bvh2 {
    let boxes: Vec<obvhs::aabb::Aabb> = boxes.iter().enumerate().map(|(item, b)| uneven(item, b)).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    let mut binary = builder.build(PlocSearchDistance::Medium, &boxes, indices, SortPrecision::U64, 3);
    ReinsertionOptimizer::default().run(&mut binary, 0.2, None);
    binary
}

/// The box, grown by up to a thousandth, each item by another share.
///
/// Clustering joins nearest neighbours. In a row of equal boxes all are equally near; it would
/// join one pair per round, and its time grow with the square of their number. No hit depends on these boxes:
/// the nodes get the true ones.
///
/// Tests: rows_take_few_rounds.
fn uneven(item: usize, b: &Aabb) -> obvhs::aabb::Aabb {
    // Multiples of the golden ratio, modulo 1: far apart for neighbours.
    let share = unit_f32((item as u32).wrapping_mul(0x9e37_79b9));
    let by = (b.max - b.min) * (share / 1024.0);
    obvhs::aabb::Aabb::new(b.min.into(), (b.max + by).into())
}

struct Fold<'a> {
    cuts: Cuts<'a>,
    /// The items that the binary hierarchy counts.
    firsts: &'a [u32],
    twins: &'a [Twin],
    wide: Wide,
}

impl Fold<'_> {
    fn subtree(&mut self, index: usize, depth: usize) -> Child {
        let children = self.cuts.children(index);
        if children.is_empty() || depth == MAX_DEPTH {
            return self.leaf(index);
        }
        let slot = self.wide.nodes.len();
        self.wide.nodes.push(Node::new(&[]));
        let children: Vec<(Aabb, Child)> = children.into_iter().map(|c| (self.cuts.bounds(c), self.subtree(c, depth + 1))).collect();
        self.wide.nodes[slot] = Node::new(&children);
        Child::inner(slot)
    }

    fn leaf(&mut self, index: usize) -> Child {
        let mut items: Vec<u32> = self.cuts.items(index).into_iter().map(|i| self.firsts[i as usize]).collect();
        for first in items.clone() {
            items.extend(later(self.twins, first));
        }
        items.sort_unstable();
        self.wide.leaves.push(items);
        Child::leaf(self.wide.leaves.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use obvhs::bvh2::DEFAULT_MAX_STACK_DEPTH;

    use super::*;

    /// How many rounds of clustering these boxes take, as far as that is more than obvhs's least stack.
    ///
    /// Each round looks at all clusters that are left: few rounds are what makes a build fast.
    fn rounds(boxes: &[Aabb]) -> usize {
        pairs(boxes).max_depth
    }

    fn unit_box(corner: Vec3) -> Aabb {
        Aabb { min: corner, max: corner + 1.0 }
    }

    /// Clustering and reinsertion never see them: they would take time with the square of their number.
    #[test]
    fn coincident_boxes_are_one_leaf() {
        let built = wide(&[unit_box(Vec3::ZERO); 10_000]).expect("boxes");
        assert_eq!((built.nodes.len(), built.leaves), (0, vec![(0..10_000).collect()]));
    }

    /// Where a round joins a share of all clusters, rounds grow with the logarithm of their number: log₂ 50,000 = 16, and if a round
    /// joins no more than one in six, 86. A row whose boxes are all equally near takes a round per box.
    #[test]
    fn rows_take_few_rounds() {
        for step in [1.0, 0.5, 1e-3] {
            let row: Vec<Aabb> = (0..50_000).map(|k| unit_box(Vec3::X * (k as f32 * step))).collect();
            let rounds = rounds(&row);
            assert!(rounds <= DEFAULT_MAX_STACK_DEPTH, "{rounds} rounds for a row of boxes {step} apart");
        }
    }
}
