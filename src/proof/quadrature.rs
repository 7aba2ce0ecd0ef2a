//! Integrals of a density over bins, with errors that a χ² test does not notice.

use std::f64::consts::FRAC_1_SQRT_2;

use super::rect::{CylinderPoint, Rect};

/// Largest number of halvings: f64 has no more digits for z and φ.
const MAX_DEPTH: u32 = 96;
/// Ratio of a hint's density to the largest density at the nodes, above which the nodes count as having missed the hint.
const HIDDEN: f64 = 2.0;

/// Ratio of the largest to the smallest density at the nodes of a cell above which one agreement is not believed: where a jump or an edge
/// of the density moves across a cell, the difference between the rule and that on halves changes its sign, and is 0 somewhere.
const UNEVEN: f64 = 4.0;

/// Number of hints in less than half of a cell that count as a lobe; fewer may be chance.
const CLUSTER: usize = 16;

/// Point where a sample fell, with the density there.
#[derive(Clone, Copy, Debug)]
pub struct Hint {
    /// The point.
    pub point: CylinderPoint,
    /// Density at the point.
    pub density: f64,
}

/// Accuracy of an integral, and the work allowed for it.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Tolerance of the result. Each half gets 1/√2 of it: along a jump of the density the errors of the cells are nearly random.
    pub tolerance: f64,
    /// Halvings of a cell for its error alone, at most. Without this limit a density without an integral would never end.
    pub max_error_depth: u32,
}

/// ∫ f over a rectangle.
///
/// Gauss's rule with 3 × 3 nodes is compared with the same rule on halves, in both directions. Where they differ, the cell is
/// halved in the direction of the larger difference. Where a hint has a much larger density than all nodes, it is halved in the
/// direction that separates the hints best. So a lobe far narrower than the bin cannot be missed if a sample of it fell there.
///
/// - `hints`: their order is changed
///
/// Tests: polynomials, a jump, edges at all places of a cell, a peak of 10⁻³ rad, a layer of 10⁻⁶.
pub fn integrate(f: &impl Fn(CylinderPoint) -> f64, rect: Rect, hints: &mut [Hint], limits: Limits) -> f64 {
    refine(
        f,
        Cell { rect, whole: gauss(f, rect).sum, parent_converged: None, depth: MAX_DEPTH, max_error_depth: limits.max_error_depth },
        hints,
        limits,
    )
}

/// Part of the rectangle, with the state of its integration.
struct Cell {
    rect: Rect,
    /// Estimate by Gauss's rule.
    whole: f64,
    /// Whether halving the parent cell changed nothing; `None` without a parent.
    parent_converged: Option<bool>,
    /// Halvings left.
    depth: u32,
    /// Halvings left for the sake of an error.
    max_error_depth: u32,
}

fn refine(f: &impl Fn(CylinderPoint) -> f64, cell: Cell, hints: &mut [Hint], limits: Limits) -> f64 {
    let Cell { rect, whole, parent_converged, depth, max_error_depth } = cell;
    let middle = rect.middle();
    let halves = [0, 1].map(|axis| rect.cut(axis, middle[axis]));
    let parts = halves.map(|[low, high]| [gauss(f, low), gauss(f, high)]);
    let changes = parts.map(|[low, high]| low.sum + high.sum - whole);
    let largest = parts.as_flattened().iter().fold(0.0, |largest: f64, part| part.largest.max(largest));
    let smallest = parts.as_flattened().iter().fold(f64::INFINITY, |smallest, part| part.smallest.min(smallest));
    let hidden = hints.iter().any(|hint| hint.density > HIDDEN * largest);
    let converged = changes.iter().all(|change| change.abs() <= limits.tolerance);
    // At a jump no node may show that the jump cuts off a corner of the cell; the nodes of the halves do.
    let confirmed = parent_converged.unwrap_or(largest <= UNEVEN * smallest);
    let settled = (converged && confirmed) || max_error_depth == 0;
    if depth == 0 || (settled && !hidden) {
        // The corrections of both directions are added.
        return whole + changes[0] + changes[1];
    }
    let spreads = [0, 1].map(|axis| spread(hints, &rect, axis));
    let axis = usize::from(if hidden { spreads[1] < spreads[0] } else { changes[1].abs() > changes[0].abs() });
    // Halvings on the way to a lobe are not counted.
    let on_the_way = hidden || (hints.len() >= CLUSTER && spreads[0].min(spreads[1]) < 0.5);
    let left = if on_the_way { limits.max_error_depth } else { max_error_depth.saturating_sub(1) };
    let is_low = |hint: &Hint| hint.point[axis] < middle[axis];
    hints.sort_unstable_by_key(|hint| !is_low(hint));
    let (low, high) = hints.split_at_mut(hints.partition_point(is_low));
    let next = Limits { tolerance: limits.tolerance * FRAC_1_SQRT_2, ..limits };
    let half = |k: usize| Cell {
        rect: halves[axis][k],
        whole: parts[axis][k].sum,
        parent_converged: Some(converged && !hidden),
        depth: depth - 1,
        max_error_depth: left,
    };
    let part = |k: usize, own: &mut [Hint]| refine(f, half(k), own, next);
    part(0, low) + part(1, high)
}

/// Share of the width of a cell that the hints take up along an axis.
fn spread(hints: &[Hint], rect: &Rect, axis: usize) -> f64 {
    let [low, high] = [rect.z, rect.phi][axis];
    let points = || hints.iter().map(|hint| hint.point[axis]);
    (points().fold(low, f64::max) - points().fold(high, f64::min)) / (high - low)
}

/// Gauss's rule on a cell.
#[derive(Clone, Copy)]
struct Estimate {
    /// The integral.
    sum: f64,
    /// The smallest value at a node.
    smallest: f64,
    /// The largest value at a node.
    largest: f64,
}

/// Gauss–Legendre rule with 3 × 3 nodes, exact for polynomials of degree 5 in z and in φ.
fn gauss(f: &impl Fn(CylinderPoint) -> f64, rect: Rect) -> Estimate {
    /// Outer node of Gauss's rule with three nodes on [−1, 1]: √(3/5).
    const NODE: f64 = 0.774_596_669_241_483_4;
    const RULE: [(f64, f64); 3] = [(-NODE, 5.0 / 18.0), (0.0, 8.0 / 18.0), (NODE, 5.0 / 18.0)];
    let node = |[low, high]: [f64; 2], x: f64| 0.5 * (low + high) + 0.5 * (high - low) * x;
    let (mut sum, mut smallest, mut largest) = (0.0, f64::INFINITY, 0.0f64);
    for (x, weight) in RULE {
        for (y, other) in RULE {
            let value = f([node(rect.z, x), node(rect.phi, y)]);
            sum += weight * other * value;
            smallest = smallest.min(value);
            largest = largest.max(value);
        }
    }
    Estimate { sum: rect.solid_angle() * sum, smallest, largest }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    const UPPER: Rect = Rect::HALVES[1];

    fn limits(tolerance: f64) -> Limits {
        Limits { tolerance, max_error_depth: 22 }
    }

    #[test]
    fn polynomials_are_exact() {
        // ∫ z⁵ φ³ = 1/6 · (2π)⁴/4
        let found = integrate(&|[z, phi]| z.powi(5) * phi.powi(3), UPPER, &mut [], limits(1e-9));
        assert!((found / (TAU.powi(4) / 24.0) - 1.0).abs() < 1e-13);
    }

    /// A cap around the x axis, which no edge of a cell follows: x > 0.7 above the horizon is half a cap.
    #[test]
    fn a_jump_is_found_to_its_tolerance() {
        let cap = |[z, phi]: CylinderPoint| f64::from(u8::from((1.0 - z * z).sqrt() * phi.cos() > 0.7));
        let everywhere = (0..4000).map(|i| [(0.618_034 * i as f64).fract(), TAU * i as f64 / 4000.0]);
        for tolerance in [1e-2, 1e-3] {
            let mut hints: Vec<Hint> = everywhere.clone().filter(|&p| cap(p) > 0.0).map(|point| Hint { point, density: 1.0 }).collect();
            let found = integrate(&cap, UPPER, &mut hints, limits(tolerance));
            // Corners of cells that no node and no hint sees add some 4000ths.
            assert!((found - PI * 0.3).abs() < 2.0 * tolerance, "{found}");
        }
    }

    /// A density that grows from 0 beyond an edge, at 20,000 places of the edge. Its difference to that of the halves is 0 at some of them.
    #[test]
    fn an_edge_is_found_wherever_it_is() {
        let cell = Rect { z: [0.2, 0.225], phi: [1.0, 1.04] };
        for k in 0..20_000 {
            let edge = 0.2 + 0.025 * (f64::from(k) + 0.5) / 20_000.0;
            let density = |[z, _]: CylinderPoint| (z - edge).max(0.0);
            let hint = Hint { point: [0.2249, 1.02], density: density([0.2249, 1.02]) };
            let found = integrate(&density, cell, &mut [hint], Limits { tolerance: 1e-9, max_error_depth: 14 });
            let exact = 0.04 * (0.225 - edge).powi(2) / 2.0;
            assert!((found - exact).abs() < 1e-8, "{edge}: {found}, not {exact}");
        }
    }

    /// 1/|z| has no integral over the sphere, but the quadrature ends.
    #[test]
    fn a_density_without_an_integral_ends() {
        let whole = Rect { z: [-1.0, 1.0], ..UPPER };
        assert!(integrate(&|[z, _]| 1.0 / (z - 0.1).abs(), whole, &mut [], limits(1e-6)) > 10.0);
    }

    /// All of the density lies within 10⁻³ of a point that no node is near.
    #[test]
    fn hints_lead_to_a_peak() {
        let (z0, phi0, width) = (0.637, 2.345, 1e-3);
        let peak =
            |[z, phi]: CylinderPoint| (-((z - z0).powi(2) + (phi - phi0).powi(2)) / (2.0 * width * width)).exp() / (TAU * width * width);
        assert!(integrate(&peak, UPPER, &mut [], limits(1e-4)) < 1e-9, "this peak is too easy");
        // Radii and angles of a normal distribution, evenly distributed.
        let hint = |i: u32| {
            let (r, turn) = ((-2.0 * ((f64::from(i) + 0.5) / 256.0).ln()).sqrt() * width, 2.4 * f64::from(i));
            let point = [z0 + r * turn.sin(), phi0 + r * turn.cos()];
            Hint { point, density: peak(point) }
        };
        let mut hints: Vec<Hint> = (0..256).map(hint).collect();
        assert!((integrate(&peak, UPPER, &mut hints, limits(1e-4)) - 1.0).abs() < 1e-3);
    }

    /// Tail of a lobe: all of it lies within 10⁻⁶ of the upper edge, for all φ.
    #[test]
    fn a_layer_at_an_edge_is_found() {
        let layer = |[z, _]: CylinderPoint| (-(1.0 - z) / 1e-6).exp() / (TAU * 1e-6);
        let point = [1.0 - 1e-6, 1.0];
        let mut hints = [Hint { point, density: layer(point) }];
        assert!((integrate(&layer, UPPER, &mut hints, limits(1e-4)) - 1.0).abs() < 1e-4);
    }
}
