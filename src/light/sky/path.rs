//! Straight paths through the atmosphere.

use super::atmosphere::{Amounts, GROUND, KINDS, TOP, densities};

/// Points of a path through the atmosphere, with their weights in integrals over its length.
pub(super) struct Path {
    pub points: Vec<PathPoint>,
    /// Amounts of particles along the whole path (m).
    pub amounts: Amounts,
    /// Whether the path ends at the ground.
    pub hits_ground: bool,
    /// Length (m).
    pub length: f64,
}

/// Point of a path.
pub(super) struct PathPoint {
    /// Distance from the start (m).
    pub distance: f64,
    /// Distance from the centre of the earth (m).
    pub radius: f64,
    /// Weight in an integral over the length (m).
    pub weight: f64,
    /// Densities at the point.
    pub densities: Amounts,
    /// Amounts of particles between the start and the point (m).
    pub amounts: Amounts,
}

/// Nodes and weights of Gauss' method with three points in [0, 1], and the weights of the integrals from 0 to each node.
///
/// Source: Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, the method of order 6.
const ROOT15: f64 = 3.872_983_346_207_417;
const NODES: [f64; 3] = [0.5 - ROOT15 / 10.0, 0.5, 0.5 + ROOT15 / 10.0];
const WEIGHTS: [f64; 3] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
const PARTIAL: [[f64; 3]; 3] = [
    [5.0 / 36.0, 2.0 / 9.0 - ROOT15 / 15.0, 5.0 / 36.0 - ROOT15 / 30.0],
    [5.0 / 36.0 + ROOT15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - ROOT15 / 24.0],
    [5.0 / 36.0 + ROOT15 / 30.0, 2.0 / 9.0 + ROOT15 / 15.0, 5.0 / 36.0],
];

impl Path {
    /// The path from a point to the ground or out of the atmosphere, in steps that grow with the distance from the start.
    ///
    /// - `radius`: distance of the start from the centre of the earth (m); `cos`: cosine of the angle to the zenith there
    pub fn new(radius: f64, cos: f64, steps: u32) -> Path {
        let hits_ground = is_below_horizon(radius, cos);
        let length = if hits_ground { distance_to_ground(radius, cos) } else { distance_to_top(radius, cos) };
        let (mut points, mut amounts) = (Vec::with_capacity(3 * steps as usize), [0.0; KINDS]);
        for step in 0..steps {
            let at = |k: u32| length * square(f64::from(k) / f64::from(steps));
            let (start, width) = (at(step), at(step + 1) - at(step));
            let radii = NODES.map(|node| radius_at(radius, cos, start + width * node));
            let found = radii.map(densities);
            for (node, partial) in PARTIAL.iter().enumerate() {
                points.push(PathPoint {
                    distance: start + width * NODES[node],
                    radius: radii[node],
                    weight: width * WEIGHTS[node],
                    densities: found[node],
                    amounts: std::array::from_fn(|kind| amounts[kind] + width * dot(partial, &found, kind)),
                });
            }
            amounts = std::array::from_fn(|kind| amounts[kind] + width * dot(&WEIGHTS, &found, kind));
        }
        Path { points, amounts, hits_ground, length }
    }
}

/// Amounts of particles along the path from a point out of the atmosphere (m).
///
/// - `radius`: distance of the start from the centre of the earth (m); `cos`: cosine of the angle to the zenith there, above the horizon
pub(super) fn amounts_to_top(radius: f64, cos: f64, steps: u32) -> Amounts {
    let length = distance_to_top(radius, cos);
    let at = |k: u32| length * square(f64::from(k) / f64::from(steps));
    let step = |k: u32| {
        let (start, width) = (at(k), at(k + 1) - at(k));
        let found = NODES.map(|node| densities(radius_at(radius, cos, start + width * node)));
        std::array::from_fn(|kind| width * dot(&WEIGHTS, &found, kind))
    };
    (0..steps).map(step).fold([0.0; KINDS], |sum, more: Amounts| std::array::from_fn(|kind| sum[kind] + more[kind]))
}

fn dot(weights: &[f64; 3], found: &[Amounts; 3], kind: usize) -> f64 {
    weights.iter().zip(found).map(|(weight, amounts)| weight * amounts[kind]).sum()
}

/// Distance from the centre of the earth after a distance along a path: √(r² + 2 r t cos + t²).
pub(super) fn radius_at(radius: f64, cos: f64, distance: f64) -> f64 {
    (radius * radius + distance * (2.0 * radius * cos + distance)).max(GROUND * GROUND).sqrt()
}

/// Whether a path meets the ground.
pub(super) fn is_below_horizon(radius: f64, cos: f64) -> bool {
    cos < 0.0 && radius * radius * (1.0 - cos * cos) < GROUND * GROUND
}

/// Distance to the upper end of the atmosphere (m).
pub(super) fn distance_to_top(radius: f64, cos: f64) -> f64 {
    let along = radius * cos;
    ((along * along + (TOP - radius) * (TOP + radius)).max(0.0).sqrt() - along).max(0.0)
}

fn distance_to_ground(radius: f64, cos: f64) -> f64 {
    let along = radius * cos;
    (-along - (along * along - (radius - GROUND) * (radius + GROUND)).max(0.0).sqrt()).max(0.0)
}

/// x², by a product: `powi` may have other bits on other systems.
pub(super) fn square(x: f64) -> f64 {
    x * x
}
