//! Building of light trees.

use super::node::{Child, Node};
use super::{LightBounds, MAX_LEVELS, PLACE_BITS, WIDTH};

/// Number of intervals along an axis whose ends are tried as places to divide the lights.
const BUCKETS: usize = 12;

/// Level from which lights are divided by their number alone, so that the levels suffice for any number of lights: eight parts of equal
/// number each time need 11 levels for 2³¹ lights.
const BALANCED_FROM: u32 = MAX_LEVELS - 11;

/// Lights that are divided among the children of a node.
type Lights = [(LightBounds, u32)];

/// Builds a tree.
///
/// - `lights`: bounds and indices of the lights, at least one
/// - `scale`: factor for the intensities
/// - `nodes`: receives the nodes, the root first
/// - `trails`: receives the bit trail of each light, by its index
pub(super) fn build(mut lights: Vec<(LightBounds, u32)>, scale: f64, nodes: &mut Vec<Node>, trails: &mut [u64]) {
    Builder { nodes, trails, scale }.node(&mut lights, 0, 0);
}

struct Builder<'a> {
    nodes: &'a mut Vec<Node>,
    trails: &'a mut [u64],
    /// Factor for intensities.
    scale: f64,
}

impl Builder<'_> {
    /// Adds the node of some lights, and those below it; returns its index.
    ///
    /// - `trail`: bit trail of the node, of `level` places
    fn node(&mut self, lights: &mut Lights, level: u32, trail: u64) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::default());
        for (place, part) in divided(lights, level >= BALANCED_FROM).into_iter().enumerate() {
            let trail = trail | (place as u64) << (level * PLACE_BITS);
            let bounds = bounds_of(part);
            let child = match *part {
                [(_, light)] => {
                    self.trails[light as usize] = trail;
                    Child::Light(light)
                }
                _ => Child::Node(self.node(part, level + 1, trail)),
            };
            self.nodes[index].set(place, &bounds, self.scale, child);
        }
        index as u32
    }
}

/// Divides lights into up to eight parts: always the part with the greatest cost in two, or the one with the most lights.
fn divided(lights: &mut Lights, by_number: bool) -> Vec<&mut Lights> {
    let cost = |part: &Lights| if by_number { part.len() as f64 } else { bounds_of(part).cost() };
    let mut parts = vec![(cost(lights), lights)];
    while parts.len() < WIDTH {
        // The first of the greatest; parts that cannot be divided do not count.
        let divisible = (0..parts.len()).filter(|&i| parts[i].1.len() > 1);
        let Some(next) = divisible.reduce(|best, i| if parts[i].0 > parts[best].0 { i } else { best }) else { break };
        let (_, part) = parts.swap_remove(next);
        let middle = if by_number { part.len() / 2 } else { halve(part) };
        let (left, right) = part.split_at_mut(middle);
        parts.push((cost(left), left));
        parts.push((cost(right), right));
    }
    parts.into_iter().map(|(_, part)| part).collect()
}

fn bounds_of(lights: &Lights) -> LightBounds {
    let mut bounds = lights[0].0;
    for (other, _) in &lights[1..] {
        bounds = bounds.union(*other);
    }
    bounds
}

/// Sorts lights so that those of one half come first, and returns their number, which is neither 0 nor all.
///
/// The halves have the least sum of costs among divisions at the ends of equal intervals along each axis. The cost is multiplied by the
/// ratio of the greatest extent to that along the axis, so that thin slices are avoided.
fn halve(lights: &mut Lights) -> usize {
    let center = |bounds: &LightBounds| bounds.space.center();
    let centers = crate::math::Aabb::around(lights.iter().map(|(bounds, _)| center(bounds)));
    let extent = centers.max - centers.min;
    let bucket = |bounds: &LightBounds, axis: usize| {
        let place = (center(bounds)[axis] - centers.min[axis]) / extent[axis];
        ((place * BUCKETS as f32) as usize).min(BUCKETS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut buckets: [Option<LightBounds>; BUCKETS] = [None; BUCKETS];
        for (bounds, _) in lights.iter() {
            let sum = &mut buckets[bucket(bounds, axis)];
            *sum = joined(*sum, Some(*bounds));
        }
        let ratio = f64::from(extent.max_element() / extent[axis]);
        // Costs of the first buckets and of the last buckets.
        let mut last = [0.0; BUCKETS];
        let mut sum = None;
        for i in (1..BUCKETS).rev() {
            sum = joined(sum, buckets[i]);
            last[i] = sum.map_or(0.0, |bounds: LightBounds| bounds.cost());
        }
        let mut sum = None;
        for end in 1..BUCKETS {
            sum = joined(sum, buckets[end - 1]);
            let cost = ratio * (sum.map_or(0.0, |bounds: LightBounds| bounds.cost()) + last[end]);
            let is_division = sum.is_some() && buckets[end..].iter().any(Option::is_some);
            if is_division && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, end));
            }
        }
    }
    // Lights that all have one centre are divided by their order.
    let Some((_, axis, end)) = best else { return lights.len() / 2 };
    // A stable order: that of the lights within each half.
    lights.sort_by_key(|(bounds, _)| bucket(bounds, axis) >= end);
    lights.partition_point(|(bounds, _)| bucket(bounds, axis) < end)
}

fn joined(a: Option<LightBounds>, b: Option<LightBounds>) -> Option<LightBounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (a, b) => a.or(b),
    }
}
