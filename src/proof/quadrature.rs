//! Integrals of a density over bins, to an error that a chi² test does not notice.

use std::f64::consts::FRAC_1_SQRT_2;

use super::rect::{Place, Rect};

/// Finer is never cut: f64 has no more digits for z and φ.
const DEEPEST: u32 = 96;
/// A hint is hidden where the density is so many times that of the nodes.
const HIDDEN: f64 = 2.0;

/// So many hints in less than half of a cell are a lobe, fewer may be chance.
const CLUSTER: usize = 16;

/// A place where a sample fell, and the density there.
#[derive(Clone, Copy, Debug)]
pub struct Hint {
    pub place: Place,
    pub density: f64,
}

/// How well an integral has to be known.
#[derive(Clone, Copy, Debug)]
pub struct Care {
    /// Of the result. Each half gets 1/√2 of it: along a jump of the density the errors of the cells are as good as random.
    pub tolerance: f64,
    /// How often a cell is halved for its error alone: a density without an integral must not take for ever.
    pub patience: u32,
}

/// ∫ f over a rectangle.
///
/// Gauss's rule of 3 × 3 nodes, against the same on halves, both ways. Where they differ, the cell is halved the way
/// that matters more; where hints know of more than the nodes do, the way that tells the hints from the rest. So a lobe
/// far narrower than the bin cannot be missed, if a sample of it fell there.
///
/// - `hints`: their order is changed
///
/// Tests: polynomials, a jump, a peak of 10⁻³ rad, a layer of 10⁻⁶.
pub fn integrate(f: &impl Fn(Place) -> f64, rect: Rect, hints: &mut [Hint], care: Care) -> f64 {
    refine(f, Cell { rect, whole: gauss(f, rect).0, above_is_calm: true, depth: DEEPEST, patience: care.patience }, hints, care)
}

/// A part of the rectangle, and what is known of it.
struct Cell {
    rect: Rect,
    /// Gauss's estimate.
    whole: f64,
    /// Halving the cell that this is half of changed nothing.
    above_is_calm: bool,
    /// Halvings left.
    depth: u32,
    /// Halvings left for the sake of an error.
    patience: u32,
}

fn refine(f: &impl Fn(Place) -> f64, cell: Cell, hints: &mut [Hint], care: Care) -> f64 {
    let Cell { rect, whole, above_is_calm, depth, patience } = cell;
    let middle = rect.middle();
    let halves = [0, 1].map(|axis| rect.cut(axis, middle[axis]));
    let parts = halves.map(|[low, high]| [gauss(f, low), gauss(f, high)]);
    let changes = parts.map(|[low, high]| low.0 + high.0 - whole);
    let largest = parts.as_flattened().iter().fold(0.0, |largest, part| part.1.max(largest));
    let hidden = hints.iter().any(|hint| hint.density > HIDDEN * largest);
    let calm = changes.iter().all(|change| change.abs() <= care.tolerance);
    // Where there is a jump no node need see that it cuts a corner; those of the halves do.
    let settled = (calm && above_is_calm) || patience == 0;
    if depth == 0 || (settled && !hidden) {
        // What cutting z changes and what cutting φ changes, together.
        return whole + changes[0] + changes[1];
    }
    let spreads = [0, 1].map(|axis| spread(hints, &rect, axis));
    let axis = usize::from(if hidden { spreads[1] < spreads[0] } else { changes[1].abs() > changes[0].abs() });
    // On the way to a lobe none is used up.
    let on_the_way = hidden || (hints.len() >= CLUSTER && spreads[0].min(spreads[1]) < 0.5);
    let left = if on_the_way { care.patience } else { patience.saturating_sub(1) };
    let is_low = |hint: &Hint| hint.place[axis] < middle[axis];
    hints.sort_unstable_by_key(|hint| !is_low(hint));
    let (low, high) = hints.split_at_mut(hints.partition_point(is_low));
    let next = Care { tolerance: care.tolerance * FRAC_1_SQRT_2, ..care };
    let half = |k: usize| Cell {
        rect: halves[axis][k],
        whole: parts[axis][k].0,
        above_is_calm: calm && !hidden,
        depth: depth - 1,
        patience: left,
    };
    let part = |k: usize, own: &mut [Hint]| refine(f, half(k), own, next);
    part(0, low) + part(1, high)
}

/// How much of the width of a cell the hints take up along an axis.
fn spread(hints: &[Hint], rect: &Rect, axis: usize) -> f64 {
    let [low, high] = [rect.z, rect.phi][axis];
    let places = || hints.iter().map(|hint| hint.place[axis]);
    (places().fold(low, f64::max) - places().fold(high, f64::min)) / (high - low)
}

/// Gauss and Legendre's rule with 3 × 3 nodes, exact for polynomials of degree 5 in z and in φ; and the largest value at a node.
fn gauss(f: &impl Fn(Place) -> f64, rect: Rect) -> (f64, f64) {
    /// √(3/5)
    const NODE: f64 = 0.774_596_669_241_483_4;
    const RULE: [(f64, f64); 3] = [(-NODE, 5.0 / 18.0), (0.0, 8.0 / 18.0), (NODE, 5.0 / 18.0)];
    let node = |[low, high]: [f64; 2], x: f64| 0.5 * (low + high) + 0.5 * (high - low) * x;
    let (mut sum, mut largest) = (0.0, 0.0f64);
    for (x, weight) in RULE {
        for (y, other) in RULE {
            let value = f([node(rect.z, x), node(rect.phi, y)]);
            sum += weight * other * value;
            largest = largest.max(value);
        }
    }
    (rect.solid_angle() * sum, largest)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    const UPPER: Rect = Rect::HALVES[1];

    fn care(tolerance: f64) -> Care {
        Care { tolerance, patience: 22 }
    }

    #[test]
    fn polynomials_are_exact() {
        // ∫ z⁵ φ³ = 1/6 · (2π)⁴/4
        let found = integrate(&|[z, phi]| z.powi(5) * phi.powi(3), UPPER, &mut [], care(1e-9));
        assert!((found / (TAU.powi(4) / 24.0) - 1.0).abs() < 1e-13);
    }

    /// A cap around the x axis, which no edge of a cell follows: x > 0.7 above the horizon is half a cap.
    #[test]
    fn a_jump_is_found_to_its_tolerance() {
        let cap = |[z, phi]: Place| f64::from(u8::from((1.0 - z * z).sqrt() * phi.cos() > 0.7));
        let everywhere = (0..4000).map(|i| [(0.618_034 * i as f64).fract(), TAU * i as f64 / 4000.0]);
        for tolerance in [1e-2, 1e-3] {
            let mut hints: Vec<Hint> = everywhere.clone().filter(|&p| cap(p) > 0.0).map(|place| Hint { place, density: 1.0 }).collect();
            let found = integrate(&cap, UPPER, &mut hints, care(tolerance));
            // What corners of cells no node and no hint sees comes on top: some 4000ths.
            assert!((found - PI * 0.3).abs() < 2.0 * tolerance, "{found}");
        }
    }

    /// 1/|z| has no integral over the sphere; asking for it ends all the same.
    #[test]
    fn a_density_without_an_integral_ends() {
        let whole = Rect { z: [-1.0, 1.0], ..UPPER };
        assert!(integrate(&|[z, _]| 1.0 / (z - 0.1).abs(), whole, &mut [], care(1e-6)) > 10.0);
    }

    /// All of the density within 10⁻³ of a place that no node is near.
    #[test]
    fn hints_lead_to_a_peak() {
        let (z0, phi0, width) = (0.637, 2.345, 1e-3);
        let peak = |[z, phi]: Place| (-((z - z0).powi(2) + (phi - phi0).powi(2)) / (2.0 * width * width)).exp() / (TAU * width * width);
        assert!(integrate(&peak, UPPER, &mut [], care(1e-4)) < 1e-9, "this peak is too easy");
        // Radii and angles of a normal distribution, evenly spread.
        let hint = |i: u32| {
            let (r, turn) = ((-2.0 * ((f64::from(i) + 0.5) / 256.0).ln()).sqrt() * width, 2.4 * f64::from(i));
            let place = [z0 + r * turn.sin(), phi0 + r * turn.cos()];
            Hint { place, density: peak(place) }
        };
        let mut hints: Vec<Hint> = (0..256).map(hint).collect();
        assert!((integrate(&peak, UPPER, &mut hints, care(1e-4)) - 1.0).abs() < 1e-3);
    }

    /// The tail of a lobe: all of it within 10⁻⁶ of the upper edge, for all φ.
    #[test]
    fn a_layer_at_an_edge_is_found() {
        let layer = |[z, _]: Place| (-(1.0 - z) / 1e-6).exp() / (TAU * 1e-6);
        let place = [1.0 - 1e-6, 1.0];
        let mut hints = [Hint { place, density: layer(place) }];
        assert!((integrate(&layer, UPPER, &mut hints, care(1e-4)) - 1.0).abs() < 1e-4);
    }
}
