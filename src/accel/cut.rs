//! Collapsing of a binary hierarchy into wide nodes with the least expected cost.
//!
//! A ray that hits the whole box hits a part of it with the probability A, the ratio of their surface areas. The least cost of n as at
//! most r children of the node above is
//!
//!   cost(n, 1) = min( A(n) · RUN · ⌈triangles/8⌉,  A(n) · NODE + split(n, 8) )      a leaf, or a node of its own
//!   cost(n, r) = min( split(n, r),  cost(n, r − 1) )
//!   split(n, r) = min over 0 < k < r of  cost(left, k) + cost(right, r − k)
//!
//! Source: Ylitie, Karras and Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (2017),
//! section 3. Tests: the_hierarchy_finds_what_a_linear_search_finds.

use obvhs::bvh2::Bvh2;

use super::leaves::LANES;
use super::node::WIDTH;
use crate::math::Aabb;

/// Cost of testing eight boxes, relative to [`RUN`].
const NODE: f32 = 1.0;
/// Cost of testing eight triangles.
const RUN: f32 = 2.0;

/// Greatest number of triangles in a leaf, except for triangles with equal boxes.
pub const MAX_LEAF: u32 = LANES as u32;

/// Binary hierarchy with the costs of its cuts.
pub struct Cuts<'a> {
    binary: &'a Bvh2,
    /// Bounding box of each node.
    bounds: Vec<Aabb>,
    /// Number of triangles below each node.
    counts: Vec<u32>,
    is_leaf: Vec<bool>,
    /// cost(n, r), at the index r − 1.
    costs: Vec<[f32; WIDTH - 1]>,
}

impl<'a> Cuts<'a> {
    /// Computes the costs of all cuts.
    ///
    /// - `boxes`: boxes of the items in the order of `binary`
    /// - `weights`: number of triangles that each item represents, or whose test takes as long
    pub fn new(binary: &'a Bvh2, boxes: &[Aabb], weights: &[u32]) -> Cuts<'a> {
        let n = binary.nodes.len();
        let (bounds, counts, is_leaf) = (vec![Aabb::EMPTY; n], vec![0; n], vec![true; n]);
        let mut cuts = Cuts { binary, bounds, counts, is_leaf, costs: vec![[0.0; WIDTH - 1]; n] };
        let order = cuts.parents_first();
        for &index in order.iter().rev() {
            cuts.measure(index, boxes, weights);
        }
        let whole = cuts.bounds[0].area();
        for &index in order.iter().rev() {
            cuts.compute_costs(index, whole);
        }
        cuts
    }

    /// Bounding box of a node.
    pub fn bounds(&self, index: usize) -> Aabb {
        self.bounds[index]
    }

    /// Nodes that become the children of `index`; none if it is a leaf.
    pub fn children(&self, index: usize) -> Vec<usize> {
        let mut roots = vec![];
        if let Some([left, right]) = self.halves(index).filter(|_| !self.is_leaf[index]) {
            let (_, k) = self.split([left, right], WIDTH);
            self.gather(left, k, &mut roots);
            self.gather(right, WIDTH - k, &mut roots);
        }
        roots
    }

    /// Items below `index`.
    pub fn items(&self, index: usize) -> Vec<u32> {
        let mut items = vec![];
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            match self.halves(index) {
                Some(halves) => open.extend(halves),
                None => items.extend(self.own_items(index)),
            }
        }
        items
    }

    /// Appends the nodes that represent `index` as at most `r` children.
    fn gather(&self, index: usize, r: usize, roots: &mut Vec<usize>) {
        let costs = self.costs[index];
        let fewest = (1..r).find(|&fewer| costs[fewer - 1] == costs[r - 1]).unwrap_or(r);
        match self.halves(index) {
            Some([left, right]) if fewest > 1 => {
                let (_, k) = self.split([left, right], fewest);
                self.gather(left, k, roots);
                self.gather(right, fewest - k, roots);
            }
            _ => roots.push(index),
        }
    }

    /// Nodes in an order in which parents precede their children.
    fn parents_first(&self) -> Vec<usize> {
        let mut order = vec![0];
        for next in 0.. {
            let Some(&index) = order.get(next) else { break };
            order.extend(self.halves(index).into_iter().flatten());
        }
        order
    }

    /// Children of a node of the binary hierarchy; `None` for a leaf.
    fn halves(&self, index: usize) -> Option<[usize; 2]> {
        let node = &self.binary.nodes[index];
        let first = node.first_index as usize;
        (!node.is_leaf()).then_some([first, first + 1])
    }

    /// Items of a leaf of the binary hierarchy.
    fn own_items(&self, index: usize) -> &'a [u32] {
        let node = &self.binary.nodes[index];
        let first = node.first_index as usize;
        &self.binary.primitive_indices[first..first + node.prim_count as usize]
    }

    /// Computes the bounding box and the number of triangles of a node from its children.
    fn measure(&mut self, index: usize, boxes: &[Aabb], weights: &[u32]) {
        (self.bounds[index], self.counts[index]) = match self.halves(index) {
            Some([left, right]) => (self.bounds[left].union(self.bounds[right]), self.counts[left] + self.counts[right]),
            None => {
                let items = self.own_items(index);
                let bounds = items.iter().map(|&item| boxes[item as usize]).fold(Aabb::EMPTY, Aabb::union);
                (bounds, items.iter().map(|&item| weights[item as usize]).sum())
            }
        };
    }

    /// Computes the costs of a node from those of its children.
    fn compute_costs(&mut self, index: usize, whole: f64) {
        // If the whole box has no area, every ray that hits it hits all parts.
        let share = if whole > 0.0 { (self.bounds[index].area() / whole) as f32 } else { 1.0 };
        let leaf = share * RUN * self.counts[index].div_ceil(LANES as u32) as f32;
        self.costs[index] = [leaf; WIDTH - 1];
        let Some(halves) = self.halves(index) else { return };
        let node = share * NODE + self.split(halves, WIDTH).0;
        self.is_leaf[index] = self.counts[index] <= MAX_LEAF && leaf <= node;
        self.costs[index][0] = if self.is_leaf[index] { leaf } else { node };
        for r in 2..WIDTH {
            self.costs[index][r - 1] = self.split(halves, r).0.min(self.costs[index][r - 2]);
        }
    }

    /// Least cost of both halves as `r` children, and the number of children for the left half.
    fn split(&self, [left, right]: [usize; 2], r: usize) -> (f32, usize) {
        let cost = |k: usize| self.costs[left][k - 1] + self.costs[right][r - k - 1];
        (2..r).fold((cost(1), 1), |best, k| if cost(k) < best.0 { (cost(k), k) } else { best })
    }
}
