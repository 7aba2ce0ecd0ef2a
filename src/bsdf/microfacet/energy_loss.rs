//! The energy that single scattering at facets loses, and its compensation.
//!
//! E(w) = ∫ f₁(w, wi) |cos θi| dwi,    the albedo of a single reflection (or refraction) at white facets
//!
//! The rest, 1 − E, hits further facets. It is returned by a wide lobe of its own,
//!
//! f₂(wo, wi) = (1 − E(wo)) (1 − E(wi)) / (π m),    m = 2 ∫₀¹ (1 − E(μ)) μ dμ
//!
//! which is reciprocal and integrates to 1 − E. E is tabulated when a scene is built, with the model's own sampling of visible
//! normals, on all threads: for the roughness of each material at 96 cosines with 4181 samples each (some ten milliseconds of one
//! thread). That takes 17 times as long for a textured roughness, and a hundred times as long for a textured anisotropic one. A lookup
//! costs a division and a square root.
//!
//! Source: Kulla and Conty, *Revisiting Physically Based Shading at Imageworks* (2017).
//! Tests: row M2, row M5 and row M4 of `pt torture`.

use std::fmt;

use glam::Vec2;
use rayon::prelude::*;

use super::{Distribution, MIN_ALPHA, Microfacets};
use crate::math::{Local, float};

/// A table of 1 − E over the cosine, the azimuth and the roughness, as far as it depends on them.
#[derive(PartialEq)]
pub struct EnergyLossTable {
    rows: Vec<Row>,
    axis: Axis,
}

/// Leaves out the hundreds of numbers in the table.
impl fmt::Debug for EnergyLossTable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("EnergyLossTable").field("axis", &self.axis).finish_non_exhaustive()
    }
}

#[derive(PartialEq)]
struct Row {
    /// 1 − E at equal steps of [`step`].
    losses: [f32; NODES],
    /// m for the roughness of the row.
    mean: f32,
}

/// The parameter that differs between rows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axis {
    /// None: there is a single row.
    Single,
    /// The roughness along the azimuth of w, from the smaller α to the larger, for anisotropic facets.
    Turn,
    /// √α from 0 to 1, for a textured isotropic roughness.
    Roughness,
    /// [`Turn`](Axis::Turn) within the ratio of the alphas within their mean, for a textured anisotropic roughness.
    Grid(Grid),
}

/// The grid of tables over the mean and the ratio of the alphas; each table has rows over the azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// √ of the geometric mean of the alphas.
    means: Nodes,
    /// ln of the smaller alpha over the larger.
    ratios: Nodes,
}

/// Nodes at equal steps between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Nodes {
    ends: [f32; 2],
    count: usize,
}

/// The number of cosines of a row.
const NODES: usize = 96;
/// The number of rows over the azimuth, for a constant roughness.
const TURNS: usize = 25;
/// The number of rows over a textured isotropic roughness.
const ROUGHNESSES: usize = 17;
/// Two consecutive Fibonacci numbers; the second is the number of samples.
const LATTICE: [u32; 2] = [2584, 4181];

/// The numbers of turns, means and ratios of a grid.
const GRID: [usize; 3] = [9, 9, 5];
/// Two consecutive Fibonacci numbers for grids; the second is the number of samples.
const GRID_LATTICE: [u32; 2] = [610, 987];

/// The smallest ratio of the alphas in a grid. Smaller ones use its table.
const LEAST_RATIO: f32 = 0.1;
/// The smallest √α in a grid. Smaller ones use its table.
const LEAST_MEAN: f32 = 0.003;

/// The range of roughness that a table covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// A single roughness, given by its two alphas.
    One(Vec2),
    /// All isotropic roughnesses, with α from 0 to 1.
    Round,
    /// Anisotropic roughnesses in a range.
    Long {
        /// The least and the greatest √ of the geometric mean of the alphas.
        mean: [f32; 2],
        /// The least and the greatest ratio of the smaller alpha to the larger, from 0.1 to 1.
        ratio: [f32; 2],
    },
}

impl EnergyLossTable {
    /// Computes a table by sampling.
    ///
    /// - `returned`: the estimate of E for the facets and a direction from one pair of uniform numbers
    pub fn tabulate(
        domain: Domain,
        distribution: Distribution,
        returned: impl Fn(&Microfacets, Local, Vec2) -> f32 + Sync,
    ) -> EnergyLossTable {
        let one = |alpha: Vec2, axis, turns, lattice| {
            let facets = Microfacets { alpha: alpha.max(Vec2::splat(MIN_ALPHA)), distribution };
            EnergyLossTable::of_facets(&facets, axis, turns, |wo| share_returned(&facets, wo, lattice, &returned))
        };
        match domain {
            Domain::One(alpha) if alpha.x == alpha.y => one(alpha, Axis::Single, 1, LATTICE),
            Domain::One(alpha) => one(alpha, Axis::Turn, TURNS, LATTICE),
            Domain::Round => {
                let at = |k: usize| k as f32 / (ROUGHNESSES - 1) as f32;
                let rows = (0..ROUGHNESSES).flat_map(|k| one(Vec2::splat(at(k) * at(k)), Axis::Single, 1, LATTICE).rows);
                EnergyLossTable { rows: rows.collect(), axis: Axis::Roughness }
            }
            Domain::Long { mean, ratio } => {
                let grid = Grid {
                    means: Nodes::new(mean.map(|mean| mean.max(LEAST_MEAN)), GRID[1]),
                    ratios: Nodes::new(ratio.map(|ratio| float::ln(ratio.max(LEAST_RATIO))), GRID[2]),
                };
                let table = |(i, j): (usize, usize)| {
                    let (mean, aspect) = (grid.means.at(i), float::exp(0.5 * grid.ratios.at(j)));
                    one(Vec2::new(1.0 / aspect, aspect) * (mean * mean), Axis::Turn, GRID[0], GRID_LATTICE).rows
                };
                let places = (0..grid.means.count).flat_map(|i| (0..grid.ratios.count).map(move |j| (i, j)));
                EnergyLossTable { rows: places.flat_map(table).collect(), axis: Axis::Grid(grid) }
            }
        }
    }

    /// Computes the rows of one roughness.
    fn of_facets(facets: &Microfacets, axis: Axis, turns: usize, share: impl Fn(Local) -> f32 + Sync) -> EnergyLossTable {
        let row = |k: usize| {
            let (scale, cos2_phi) = match axis {
                Axis::Single => (scale(facets.alpha), 1.0),
                _ => turned(facets.alpha, k as f32 / (turns - 1) as f32),
            };
            let mut losses = [0.0; NODES];
            let loss = |(node, loss): (usize, &mut f32)| *loss = (1.0 - share(direction(node, scale, cos2_phi))).max(0.0);
            losses.par_iter_mut().enumerate().for_each(loss);
            Row { losses, mean: mean(&losses, scale) }
        };
        let mut table = EnergyLossTable { rows: (0..turns).map(row).collect(), axis };
        table.join_means(facets.alpha);
        table
    }

    /// 1 − E(w).
    #[inline]
    pub fn loss(&self, w: Local, alpha: Vec2) -> f32 {
        match self.axis {
            Axis::Single => lookup(&self.rows[0].losses, step(w.abs_cos(), scale(alpha))),
            Axis::Roughness => {
                let scale = scale(alpha);
                let along = step(w.abs_cos(), scale);
                between(&self.rows, scale.sqrt(), |row| lookup(&row.losses, along))
            }
            Axis::Turn => turned_loss(&self.rows, w, alpha),
            Axis::Grid(grid) => grid.value(&self.rows, alpha, |rows| turned_loss(rows, w, alpha)),
        }
    }

    /// m for a roughness.
    pub fn mean_loss(&self, alpha: Vec2) -> f32 {
        match self.axis {
            Axis::Single | Axis::Turn => self.rows[0].mean,
            Axis::Roughness => between(&self.rows, scale(alpha).sqrt(), |row| row.mean),
            Axis::Grid(grid) => grid.value(&self.rows, alpha, |rows| rows[0].mean),
        }
    }

    /// Sets m of all rows of one roughness to their mean over a uniform azimuth φ.
    fn join_means(&mut self, alpha: Vec2) {
        if self.axis != Axis::Turn {
            return;
        }
        const ANGLES: usize = 64;
        let at = |k: usize| {
            let (sin, cos) = float::sin_cos_degrees(90.0 * (k as f64 + 0.5) / ANGLES as f64);
            let scale = (alpha * Vec2::new(cos as f32, sin as f32)).length();
            between(&self.rows, turn_of(scale, alpha), |row| row.mean)
        };
        let mean = (0..ANGLES).map(at).sum::<f32>() / ANGLES as f32;
        self.rows.iter_mut().for_each(|row| row.mean = mean);
    }
}

impl Nodes {
    fn new(ends: [f32; 2], count: usize) -> Nodes {
        Nodes { ends, count: if ends[0] == ends[1] { 1 } else { count } }
    }

    fn at(&self, node: usize) -> f32 {
        self.ends[0] + (self.ends[1] - self.ends[0]) * (node as f32 / (self.count.max(2) - 1) as f32)
    }

    /// The node below a value, and the share of the next one.
    fn cell(&self, value: f32) -> (usize, f32) {
        match self.count {
            1 => (0, 0.0),
            count => cell(((value - self.ends[0]) / (self.ends[1] - self.ends[0])).clamp(0.0, 1.0), count),
        }
    }
}

impl Grid {
    /// Interpolates a value of the tables around two alphas.
    fn value(&self, rows: &[Row], alpha: Vec2, read: impl Fn(&[Row]) -> f32) -> f32 {
        let (i, high) = self.means.cell(scale(alpha).sqrt());
        let (j, wide) = self.ratios.cell(float::ln(alpha.min_element() / alpha.max_element()));
        let table = |i: usize, j: usize| read(&rows[(i * self.ratios.count + j) * GRID[0]..][..GRID[0]]);
        let along = |i: usize| {
            let low = table(i, j);
            if wide == 0.0 { low } else { low + (table(i, j + 1) - low) * wide }
        };
        let low = along(i);
        if high == 0.0 { low } else { low + (along(i + 1) - low) * high }
    }
}

/// 1 − E(w) from rows over the azimuth.
fn turned_loss(rows: &[Row], w: Local, alpha: Vec2) -> f32 {
    let across = w.0.truncate();
    let scale = if across == Vec2::ZERO { alpha.x } else { (across * alpha).length() / across.length() };
    let along = step(w.abs_cos(), scale);
    between(rows, turn_of(scale, alpha), |row| lookup(&row.losses, along))
}

/// Interpolates a value of the two rows around a position from 0 to 1 among all rows.
#[inline]
fn between(rows: &[Row], at: f32, value: impl Fn(&Row) -> f32) -> f32 {
    let (k, part) = cell(at, rows.len());
    let (low, high) = (value(&rows[k]), value(&rows[k + 1]));
    low + (high - low) * part
}

/// The position from 0 to 1 among the rows of the roughness along an azimuth.
fn turn_of(scale: f32, alpha: Vec2) -> f32 {
    let (low, high) = (alpha.min_element(), alpha.max_element());
    // All azimuths are alike for isotropic facets.
    if low == high { 0.0 } else { ((scale - low) / (high - low)).clamp(0.0, 1.0) }
}

/// The roughness along the azimuth of a row, and cos²φ of that azimuth: scale² = αx² cos²φ + αy² sin²φ.
fn turned(alpha: Vec2, at: f32) -> (f32, f32) {
    let scale = alpha.min_element() + (alpha.max_element() - alpha.min_element()) * at;
    let (x2, y2) = (alpha.x * alpha.x, alpha.y * alpha.y);
    (scale, if x2 == y2 { 1.0 } else { ((scale * scale - y2) / (x2 - y2)).clamp(0.0, 1.0) })
}

/// The roughness that scales the cosines of a row: E varies most where cos θ is about α.
fn scale(alpha: Vec2) -> f32 {
    (alpha.x * alpha.y).sqrt().min(1.0)
}

/// The position from 0 to 1 of a cosine in a row: (cos + cos (1 + α) / (cos + α)) / 2. Half of the nodes are uniform, half concentrate
/// below α.
fn step(cos: f32, alpha: f32) -> f32 {
    0.5 * (cos + cos * (1.0 + alpha) / (cos + alpha))
}

/// The direction of a node.
fn direction(node: usize, alpha: f32, cos2_phi: f32) -> Local {
    let at = node as f32 / (NODES - 1) as f32;
    // The inverse of `step` solves cos² + (1 + 2 α − 2 at) cos − 2 at α = 0. No facet is visible from the horizon itself, so that the
    // first node is slightly above it.
    let half = 0.5 + alpha - at;
    let root = (half * half + 2.0 * at * alpha).sqrt();
    let cos = if half > 0.0 { 2.0 * at * alpha / (half + root) } else { root - half }.clamp(1e-4 * alpha, 1.0);
    let sine = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Local::new(sine * cos2_phi.sqrt(), sine * (1.0 - cos2_phi).sqrt(), cos)
}

/// The mean over the unit square of uniform numbers, by a Fibonacci lattice over the rings r = max |2u − 1| and the positions on them.
/// The lattice is laid over the rings so that edges of the integrand are not aligned with its rows.
///
/// The steepest normals, some of which reflect into the surface, are at the edges of the square. Rings are denser there: 1 − r = q³.
fn share_returned(facets: &Microfacets, wo: Local, [stride, count]: [u32; 2], returned: &impl Fn(&Microfacets, Local, Vec2) -> f32) -> f32 {
    let at = |i: u32| {
        let q = (i as f32 + 0.5) / count as f32;
        let r = 1.0 - q * q * q;
        let place = 4.0 * ((i * stride) % count) as f32 / count as f32;
        let along = r * (2.0 * place.fract() - 1.0);
        let ab = match place as u32 {
            0 => Vec2::new(r, along),
            1 => Vec2::new(-r, along),
            2 => Vec2::new(along, r),
            _ => Vec2::new(along, -r),
        };
        f64::from(returned(facets, wo, 0.5 + 0.5 * ab) * (6.0 * r * q * q))
    };
    ((0..count).map(at).sum::<f64>() / f64::from(count)) as f32
}

/// 2 ∫ loss(μ) μ dμ of the interpolated row.
fn mean(losses: &[f32; NODES], alpha: f32) -> f32 {
    const STEPS: usize = 1024;
    let at = |k: usize| (k as f32 + 0.5) / STEPS as f32;
    let sum: f64 = (0..STEPS).map(|k| f64::from(2.0 * at(k) * lookup(losses, step(at(k), alpha)))).sum();
    (sum / STEPS as f64) as f32
}

#[inline]
fn lookup(losses: &[f32; NODES], at: f32) -> f32 {
    let (k, part) = cell(at, NODES);
    losses[k] + (losses[k + 1] - losses[k]) * part
}

/// The interval of the position `at`, in [0, 1], between `count` nodes, and the position within the interval, from 0 to 1.
#[inline]
fn cell(at: f32, count: usize) -> (usize, f32) {
    let x = at * (count - 1) as f32;
    let k = (x as usize).min(count - 2);
    (k, (x - k as f32).min(1.0))
}

/// The key of a table for facets: the distribution, the roughness, and the index of refraction if it matters.
pub(in crate::bsdf) type Key = (Distribution, [u32; 4], u32);

impl Domain {
    pub(in crate::bsdf) fn bits(self) -> [u32; 4] {
        let numbers = match self {
            Domain::One(alpha) => [alpha.x, alpha.y, -1.0, -1.0],
            Domain::Round => [-1.0; 4],
            Domain::Long { mean, ratio } => [mean[0], mean[1], ratio[0], ratio[1]],
        };
        numbers.map(f32::to_bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torture::everything::with_threads;

    /// Row D1 of `pt torture` cannot tell, because tables are kept for the life of the process.
    #[test]
    fn tables_do_not_depend_on_the_number_of_threads() {
        let returned = |facets: &Microfacets, wo: Local, u: Vec2| (wo.abs_cos() * u.x + facets.alpha.y * u.y).sin().abs();
        for alpha in [Vec2::splat(0.3), Vec2::new(0.1, 0.4)] {
            let table = |threads| with_threads(threads, || EnergyLossTable::tabulate(Domain::One(alpha), Distribution::Ggx, returned));
            assert_eq!(table(1), table(16), "{alpha}");
        }
    }
}
