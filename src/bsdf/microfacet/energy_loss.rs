//! What facets lose of the light, because only the first of many reflections is followed.
//!
//! E(w) = ∫ f₁(w, wi) |cos θi| dwi,    the share that one reflection (or refraction) returns of white facets
//!
//! The rest, 1 − E, met a facet again. It is returned by a broad lobe of its own,
//!
//! f₂(wo, wi) = (1 − E(wo)) (1 − E(wi)) / (π m),    m = 2 ∫₀¹ (1 − E(μ)) μ dμ
//!
//! which is reciprocal and integrates to what is missing. E is tabulated when a scene is built, from the model's own
//! sampling of visible normals: 96 cosines, each the mean of 4181 samples, for the very roughness of a material
//! (some ten milliseconds); 17 times that for a textured one, a hundred times that where it is also longer than wide. A lookup costs
//! a division and a square root.
//!
//! Source: Kulla and Conty, *Revisiting Physically Based Shading at Imageworks* (2017).
//! Tests: strong furnace (M2, M5), white with compensation (M4).

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Mutex, PoisonError};

use glam::Vec2;

use super::{Distribution, MIN_ALPHA, Microfacets};
use crate::math::{Local, float};

/// 1 − E over the cosine, and over what else it depends on.
#[derive(PartialEq)]
pub struct EnergyLossTable {
    rows: Vec<Row>,
    axis: Axis,
}

/// Without the table: a hundred numbers are no help in a message.
impl fmt::Debug for EnergyLossTable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("EnergyLossTable").field("axis", &self.axis).finish_non_exhaustive()
    }
}

#[derive(PartialEq)]
struct Row {
    /// 1 − E at equal steps of [`step`].
    losses: [f32; NODES],
    /// m, of all directions to which the row belongs.
    mean: f32,
}

/// What tells one row from the next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axis {
    Single,
    /// The roughness across w, from the smaller α to the larger, of facets that are rougher one way than the other.
    Turn,
    /// √α from 0 to 1, of a texture.
    Roughness,
    /// [`Turn`](Axis::Turn) within the ratio of the alphas within their mean, of textures.
    Grid(Grid),
}

/// Tables for alphas of many means and ratios, each with its turns.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// √ of the geometric mean.
    means: Nodes,
    /// ln of the smaller over the larger.
    ratios: Nodes,
}

/// So many equal steps from one end to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Nodes {
    ends: [f32; 2],
    count: usize,
}

const NODES: usize = 96;
const TURNS: usize = 25;
const ROUGHNESSES: usize = 17;
/// Fibonacci's numbers, one after the other: the second is how many samples there are.
const LATTICE: [u32; 2] = [2584, 4181];

/// Of grids: turns, means and ratios, and samples.
const GRID: [usize; 3] = [9, 9, 5];
const GRID_LATTICE: [u32; 2] = [610, 987];

/// Of grids: longer facets than ten times their width, and smoother ones than √α = 0.003, have the tables of these.
const LEAST_RATIO: f32 = 0.1;
const LEAST_MEAN: f32 = 0.003;

/// The roughness that a table is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// One roughness, by its two alphas.
    One(Vec2),
    /// All from 0 to 1, the same both ways.
    Round,
    /// From the least to the greatest √α, of the geometric mean of two, and ratio of the smaller to the larger (from 0.1 to 1).
    Long { mean: [f32; 2], ratio: [f32; 2] },
}

impl EnergyLossTable {
    /// - `returned`: the share of white light that facets return of a direction, for one pair of uniform numbers
    pub fn tabulate(domain: Domain, distribution: Distribution, returned: impl Fn(&Microfacets, Local, Vec2) -> f32) -> EnergyLossTable {
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

    /// The rows of one roughness.
    fn of_facets(facets: &Microfacets, axis: Axis, turns: usize, share: impl Fn(Local) -> f32) -> EnergyLossTable {
        let row = |k: usize| {
            let (scale, cos2_phi) = match axis {
                Axis::Single => (scale(facets.alpha), 1.0),
                _ => turned(facets.alpha, k as f32 / (turns - 1) as f32),
            };
            let losses: [f32; NODES] = std::array::from_fn(|node| (1.0 - share(direction(node, scale, cos2_phi))).max(0.0));
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

    /// m, for a roughness.
    pub fn mean_loss(&self, alpha: Vec2) -> f32 {
        match self.axis {
            Axis::Single | Axis::Turn => self.rows[0].mean,
            Axis::Roughness => between(&self.rows, scale(alpha).sqrt(), |row| row.mean),
            Axis::Grid(grid) => grid.value(&self.rows, alpha, |rows| rows[0].mean),
        }
    }

    /// Rows of one surface have one mean, over all turns: φ uniform.
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
    /// What the tables around two alphas say, interpolated.
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

/// 1 − E(w) of rows that tell turns apart.
fn turned_loss(rows: &[Row], w: Local, alpha: Vec2) -> f32 {
    let across = w.0.truncate();
    let scale = if across == Vec2::ZERO { alpha.x } else { (across * alpha).length() / across.length() };
    let along = step(w.abs_cos(), scale);
    between(rows, turn_of(scale, alpha), |row| lookup(&row.losses, along))
}

/// Between the two rows about a place among all, from 0 to 1.
#[inline]
fn between(rows: &[Row], at: f32, value: impl Fn(&Row) -> f32) -> f32 {
    let (k, part) = cell(at, rows.len());
    let (low, high) = (value(&rows[k]), value(&rows[k + 1]));
    low + (high - low) * part
}

/// Where the roughness across a direction lies among the rows, from 0 to 1.
fn turn_of(scale: f32, alpha: Vec2) -> f32 {
    let (low, high) = (alpha.min_element(), alpha.max_element());
    // Of round ones all turns are alike.
    if low == high { 0.0 } else { ((scale - low) / (high - low)).clamp(0.0, 1.0) }
}

/// The roughness across the directions of a row, and their cos²φ: scale² = αx² cos²φ + αy² sin²φ.
fn turned(alpha: Vec2, at: f32) -> (f32, f32) {
    let scale = alpha.min_element() + (alpha.max_element() - alpha.min_element()) * at;
    let (x2, y2) = (alpha.x * alpha.x, alpha.y * alpha.y);
    (scale, if x2 == y2 { 1.0 } else { ((scale * scale - y2) / (x2 - y2)).clamp(0.0, 1.0) })
}

/// The roughness by which cosines are spread: E changes where cos θ is about α.
fn scale(alpha: Vec2) -> f32 {
    (alpha.x * alpha.y).sqrt().min(1.0)
}

/// Where a cosine lies in a row, from 0 to 1: (cos + cos (1 + α) / (cos + α)) / 2, half the nodes even and half below α.
fn step(cos: f32, alpha: f32) -> f32 {
    0.5 * (cos + cos * (1.0 + alpha) / (cos + alpha))
}

/// The direction of a node.
fn direction(node: usize, alpha: f32, cos2_phi: f32) -> Local {
    let at = node as f32 / (NODES - 1) as f32;
    // cos² + (1 + 2 α − 2 at) cos − 2 at α = 0, the inverse of `step`; on the horizon itself nothing is in sight, so the
    // first is just above it.
    let half = 0.5 + alpha - at;
    let root = (half * half + 2.0 * at * alpha).sqrt();
    let cos = if half > 0.0 { 2.0 * at * alpha / (half + root) } else { root - half }.clamp(1e-4 * alpha, 1.0);
    let sine = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Local::new(sine * cos2_phi.sqrt(), sine * (1.0 - cos2_phi).sqrt(), cos)
}

/// The mean over the square of uniform numbers, by a Fibonacci lattice of the rings r = max |2u − 1| and the places on them:
/// no edge of the integrand runs along its rows.
///
/// The steepest normals lie at the edges of the square, and with them what leads into the surface: rings crowd there, 1 − r = q³.
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

/// 2 ∫ loss(μ) μ dμ of the table as it is looked up.
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

/// The interval of `at`, in [0, 1], among `count` nodes, and how far in.
#[inline]
fn cell(at: f32, count: usize) -> (usize, f32) {
    let x = at * (count - 1) as f32;
    let k = (x as usize).min(count - 2);
    (k, (x - k as f32).min(1.0))
}

/// Tables made once for each set of parameters and kept for the life of the process (up to 160 kB each),
/// so that a material at a point is plain data.
///
/// - `K`: what a table depends on, the bits of its numbers
pub(in crate::bsdf) struct Cache<K, T: 'static>(Mutex<BTreeMap<K, &'static T>>);

/// Of facets: their distribution, their roughness, and their index of refraction if it matters.
pub(in crate::bsdf) type Key = (Distribution, [u32; 4], u32);

impl<K: Ord, T> Cache<K, T> {
    pub const fn new() -> Cache<K, T> {
        Cache(Mutex::new(BTreeMap::new()))
    }

    pub fn get(&self, key: K, make: impl FnOnce() -> T) -> &'static T {
        // A table is whole or not there: what a panic elsewhere left behind can be used.
        let mut tables = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        tables.entry(key).or_insert_with(|| Box::leak(Box::new(make())))
    }
}

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
