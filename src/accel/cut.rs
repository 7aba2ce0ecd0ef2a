//! Where to cut a binary hierarchy into wide nodes: the cuts of least expected cost.
//!
//! A ray that meets the whole meets a part of it with the probability A, the ratio of their surfaces. So
//!
//!   cost(n, 1) = min( A(n) · PACKET · ⌈triangles/8⌉,  A(n) · NODE + split(n, 8) )      a leaf, or a node of its own
//!   cost(n, r) = min( split(n, r),  cost(n, r − 1) )
//!   split(n, r) = min over 0 < k < r of  cost(left, k) + cost(right, r − k)
//!
//! is the least cost of n as at most r children of the node above.
//!
//! Source: Ylitie, Karras and Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (2017),
//! section 3. Tests: hierarchy_is_the_list.

use obvhs::bvh2::Bvh2;

use super::node::WIDTH;
use super::packet::LANES;
use crate::math::Aabb;

/// Testing eight boxes, and testing eight triangles: taken as one to two.
const NODE: f32 = 1.0;
const PACKET: f32 = 2.0;

/// No leaf is made of more triangles, but for those that share one box.
const MAX_LEAF: u32 = LANES as u32;

/// A binary hierarchy, and what its cuts cost.
pub struct Cuts<'a> {
    binary: &'a Bvh2,
    /// The box around each node, and how many triangles it holds.
    bounds: Vec<Aabb>,
    counts: Vec<u32>,
    is_leaf: Vec<bool>,
    /// cost(n, r) at r − 1.
    costs: Vec<[f32; WIDTH - 1]>,
}

impl<'a> Cuts<'a> {
    /// - `boxes`: of the items, as `binary` numbers them; `copies`: how many triangles each of them stands for
    pub fn new(binary: &'a Bvh2, boxes: &[Aabb], copies: &[u32]) -> Cuts<'a> {
        let n = binary.nodes.len();
        let (bounds, counts, is_leaf) = (vec![Aabb::EMPTY; n], vec![0; n], vec![true; n]);
        let mut cuts = Cuts { binary, bounds, counts, is_leaf, costs: vec![[0.0; WIDTH - 1]; n] };
        let order = cuts.parents_first();
        for &index in order.iter().rev() {
            cuts.measure(index, boxes, copies);
        }
        let whole = cuts.bounds[0].area();
        for &index in order.iter().rev() {
            cuts.weigh(index, whole);
        }
        cuts
    }

    pub fn bounds(&self, index: usize) -> Aabb {
        self.bounds[index]
    }

    /// The nodes that become the children of `index`; none where it is a leaf.
    pub fn children(&self, index: usize) -> Vec<usize> {
        let mut roots = vec![];
        if let Some([left, right]) = self.halves(index).filter(|_| !self.is_leaf[index]) {
            let (_, k) = self.split([left, right], WIDTH);
            self.gather(left, k, &mut roots);
            self.gather(right, WIDTH - k, &mut roots);
        }
        roots
    }

    /// The items below `index`.
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

    /// Adds the roots of `index` as at most `r` children.
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

    fn parents_first(&self) -> Vec<usize> {
        let mut order = vec![0];
        for next in 0.. {
            let Some(&index) = order.get(next) else { break };
            order.extend(self.halves(index).into_iter().flatten());
        }
        order
    }

    fn halves(&self, index: usize) -> Option<[usize; 2]> {
        let node = &self.binary.nodes[index];
        let first = node.first_index as usize;
        (!node.is_leaf()).then_some([first, first + 1])
    }

    /// Of a leaf of the binary hierarchy.
    fn own_items(&self, index: usize) -> &'a [u32] {
        let node = &self.binary.nodes[index];
        let first = node.first_index as usize;
        &self.binary.primitive_indices[first..first + node.prim_count as usize]
    }

    fn measure(&mut self, index: usize, boxes: &[Aabb], copies: &[u32]) {
        (self.bounds[index], self.counts[index]) = match self.halves(index) {
            Some([left, right]) => (self.bounds[left].union(self.bounds[right]), self.counts[left] + self.counts[right]),
            None => {
                let items = self.own_items(index);
                let bounds = items.iter().map(|&item| boxes[item as usize]).fold(Aabb::EMPTY, Aabb::union);
                (bounds, items.iter().map(|&item| copies[item as usize]).sum())
            }
        };
    }

    fn weigh(&mut self, index: usize, whole: f64) {
        // Where the whole has no surface, every ray that meets it meets all.
        let share = if whole > 0.0 { (self.bounds[index].area() / whole) as f32 } else { 1.0 };
        let leaf = share * PACKET * self.counts[index].div_ceil(LANES as u32) as f32;
        self.costs[index] = [leaf; WIDTH - 1];
        let Some(halves) = self.halves(index) else { return };
        let node = share * NODE + self.split(halves, WIDTH).0;
        self.is_leaf[index] = self.counts[index] <= MAX_LEAF && leaf <= node;
        self.costs[index][0] = if self.is_leaf[index] { leaf } else { node };
        for r in 2..WIDTH {
            self.costs[index][r - 1] = self.split(halves, r).0.min(self.costs[index][r - 2]);
        }
    }

    /// The least cost of both halves as `r` children, and how many of them are the left half's.
    fn split(&self, [left, right]: [usize; 2], r: usize) -> (f32, usize) {
        let cost = |k: usize| self.costs[left][k - 1] + self.costs[right][r - k - 1];
        (2..r).fold((cost(1), 1), |best, k| if cost(k) < best.0 { (cost(k), k) } else { best })
    }
}
