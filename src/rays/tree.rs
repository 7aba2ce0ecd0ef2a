//! Bounding volume hierarchy over boxes: those of triangles, or of instances.

use glam::DVec3;

use super::Line;

/// Boxes in a leaf, at most, unless their centres coincide.
const LEAF: usize = 4;
/// Candidates for a division.
const BINS: usize = 16;

/// A binary tree, its root first.
pub struct Tree {
    nodes: Vec<Node>,
    /// Indices of the boxes, leaf by leaf.
    order: Vec<u32>,
}

struct Node {
    low: DVec3,
    high: DVec3,
    /// Of a leaf the first place in `order`; otherwise the index of the second child, which follows the first.
    next: u32,
    /// Number of boxes; 0 if this is not a leaf.
    count: u32,
}

/// A box while the tree is built.
struct Item {
    low: DVec3,
    high: DVec3,
    index: u32,
}

impl Item {
    fn middle(&self) -> DVec3 {
        0.5 * self.low + 0.5 * self.high
    }
}

impl Tree {
    /// The hierarchy over some boxes, given by their lower and upper corners.
    pub fn new(boxes: impl Iterator<Item = [DVec3; 2]>) -> Tree {
        let mut items: Vec<Item> = (0..).zip(boxes).map(|(index, [low, high])| Item { low, high, index }).collect();
        let mut tree = Tree { nodes: vec![], order: vec![] };
        if !items.is_empty() {
            tree.add(&mut items);
        }
        tree
    }

    /// Adds the node of these boxes and all below it.
    fn add(&mut self, items: &mut [Item]) {
        let (low, high) = bounds(items, |item| (item.low, item.high));
        let at = self.nodes.len();
        let first = self.order.len() as u32;
        let split = if items.len() <= LEAF { 0 } else { divide(items) };
        self.nodes.push(Node { low, high, next: first, count: if split == 0 { items.len() as u32 } else { 0 } });
        if split == 0 {
            self.order.extend(items.iter().map(|item| item.index));
            return;
        }
        let (left, right) = items.split_at_mut(split);
        self.add(left);
        self.nodes[at].next = self.nodes.len() as u32;
        self.add(right);
    }

    /// Calls `test` with the index of each box that the ray meets before its end, nearer ones first. `test` returns where the ray then ends,
    /// or `None` to stop.
    pub fn visit(&self, line: &Line, t_max: f64, mut test: impl FnMut(u32) -> Option<f64>) {
        let Some(root) = self.nodes.first() else { return };
        let mut end = t_max;
        let mut stack: Vec<(f64, u32)> = entry(root, line).map(|t| (t, 0)).into_iter().collect();
        while let Some((t, at)) = stack.pop() {
            if t > end {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                for &index in &self.order[node.next as usize..][..node.count as usize] {
                    match test(index) {
                        Some(new_end) => end = new_end,
                        None => return,
                    }
                }
                continue;
            }
            let children = [at + 1, node.next].map(|child| entry(&self.nodes[child as usize], line).map(|t| (t, child)));
            match children {
                [Some(a), Some(b)] => stack.extend(if a.0 < b.0 { [b, a] } else { [a, b] }),
                one => stack.extend(one.into_iter().flatten()),
            }
        }
    }
}

/// Lower bound of the parameter at which a ray enters a box; `None` if it does not meet it. Rounding only makes the box larger.
fn entry(node: &Node, line: &Line) -> Option<f64> {
    // Three roundings of each side: difference, reciprocal and product.
    const MORE: f64 = 1.0 + 4.0 * f64::EPSILON;
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) = (node.low[axis] - line.origin[axis], node.high[axis] - line.origin[axis]);
        let d = line.direction[axis];
        if d == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (first, last) = if d > 0.0 { (low / d, high / d) } else { (high / d, low / d) };
        // Where the quotient leaves the range, the box counts as met.
        near = near.max(if first.is_nan() { 0.0 } else { first });
        far = far.min(if last.is_nan() { f64::INFINITY } else { last * MORE });
    }
    let near = near / MORE;
    (near <= far).then_some(near)
}

fn bounds(items: &[Item], of: impl Fn(&Item) -> (DVec3, DVec3)) -> (DVec3, DVec3) {
    items.iter().map(of).fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (a, b)| (low.min(a), high.max(b)))
}

/// Sorts the boxes into two groups with the least sum of area × count, and returns the size of the first; 0 if nothing divides
/// them.
///
/// Source: Wald, *On Fast Construction of SAH-based Bounding Volume Hierarchies* (2007).
fn divide(items: &mut [Item]) -> usize {
    let (low, high) = bounds(items, |item| (item.middle(), item.middle()));
    let extent = high - low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    if extent[axis] <= 0.0 {
        return 0;
    }
    let bin = |item: &Item| (((item.middle()[axis] - low[axis]) / extent[axis] * BINS as f64) as usize).min(BINS - 1);
    let mut bins = [(DVec3::INFINITY, DVec3::NEG_INFINITY, 0usize); BINS];
    for item in items.iter() {
        let bin = &mut bins[bin(item)];
        *bin = (bin.0.min(item.low), bin.1.max(item.high), bin.2 + 1);
    }
    let cost = |bins: &[(DVec3, DVec3, usize)]| {
        let all = bins.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY, 0), |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2));
        let size = (all.1 - all.0) / extent[axis];
        (all.2, if all.2 == 0 { 0.0 } else { (size.x * size.y + size.y * size.z + size.z * size.x) * all.2 as f64 })
    };
    let candidates = (1..BINS).map(|k| (k, cost(&bins[..k]), cost(&bins[k..]))).filter(|(_, left, right)| left.0 > 0 && right.0 > 0);
    let best = candidates.min_by(|a, b| (a.1.1 + a.2.1).total_cmp(&(b.1.1 + b.2.1)));
    let Some((k, (count, _), _)) = best else { return 0 };
    items.sort_by_key(|item| bin(item) >= k);
    count
}
