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
//! (some ten milliseconds); 17 times that for a textured one. A lookup costs a division and a square root.
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
pub struct Albedo {
    rows: Vec<Row>,
    axis: Axis,
}

/// Without the table: a hundred numbers are no help in a message.
impl fmt::Debug for Albedo {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Albedo").field("axis", &self.axis).finish_non_exhaustive()
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Axis {
    Single,
    /// The roughness across w, from the smaller α to the larger, of facets that are rougher one way than the other.
    Turn,
    /// √α from 0 to 1, of a texture.
    Roughness,
}

const NODES: usize = 96;
const TURNS: usize = 25;
const ROUGHNESSES: usize = 17;
/// Fibonacci's numbers, one after the other: the second is how many samples there are.
const LATTICE: [u32; 2] = [2584, 4181];

/// The roughness that a table is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// One roughness, by its two alphas.
    One(Vec2),
    /// All from 0 to 1: looked up by the geometric mean of the alphas, which is exact where they are equal.
    All,
}

impl Albedo {
    /// - `returned`: the share of white light that facets return of a direction, for one pair of uniform numbers
    pub fn tabulate(domain: Domain, distribution: Distribution, returned: impl Fn(&Microfacets, Local, Vec2) -> f32) -> Albedo {
        let (axis, count) = match domain {
            Domain::One(alpha) if alpha.x == alpha.y => (Axis::Single, 1),
            Domain::One(_) => (Axis::Turn, TURNS),
            Domain::All => (Axis::Roughness, ROUGHNESSES),
        };
        let row = |k: usize| {
            let at = k as f32 / (count.max(2) - 1) as f32;
            let alpha = match domain {
                Domain::One(alpha) => alpha,
                Domain::All => Vec2::splat(at * at),
            };
            let facets = Microfacets { alpha: alpha.max(Vec2::splat(MIN_ALPHA)), distribution };
            let (scale, cos2_phi) = match axis {
                Axis::Turn => turned(facets.alpha, at),
                Axis::Single | Axis::Roughness => (scale(facets.alpha), 1.0),
            };
            let loss = |node: usize| (1.0 - share_returned(&facets, direction(node, scale, cos2_phi), &returned)).max(0.0);
            let losses: [f32; NODES] = std::array::from_fn(loss);
            Row { losses, mean: mean(&losses, scale) }
        };
        let mut table = Albedo { rows: (0..count).map(row).collect(), axis };
        if let Domain::One(alpha) = domain {
            table.join_means(alpha);
        }
        table
    }

    /// 1 − E(w).
    #[inline]
    pub fn loss(&self, w: Local, alpha: Vec2) -> f32 {
        let (scale, at) = match self.axis {
            Axis::Single => return lookup(&self.rows[0].losses, step(w.abs_cos(), scale(alpha))),
            Axis::Roughness => (scale(alpha), scale(alpha).sqrt()),
            Axis::Turn => {
                let across = w.0.truncate();
                let scale = if across == Vec2::ZERO { alpha.x } else { (across * alpha).length() / across.length() };
                (scale, turn_of(scale, alpha))
            }
        };
        let along = step(w.abs_cos(), scale);
        self.between(at, |row| lookup(&row.losses, along))
    }

    /// m, for a roughness.
    pub fn mean_loss(&self, alpha: Vec2) -> f32 {
        if self.axis == Axis::Single { self.rows[0].mean } else { self.between(scale(alpha).sqrt().min(1.0), |row| row.mean) }
    }

    #[inline]
    fn between(&self, at: f32, value: impl Fn(&Row) -> f32) -> f32 {
        let (k, part) = cell(at, self.rows.len());
        let (low, high) = (value(&self.rows[k]), value(&self.rows[k + 1]));
        low + (high - low) * part
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
            self.between(turn_of(scale, alpha), |row| row.mean)
        };
        let mean = (0..ANGLES).map(at).sum::<f32>() / ANGLES as f32;
        self.rows.iter_mut().for_each(|row| row.mean = mean);
    }
}

/// Where the roughness across a direction lies among the rows, from 0 to 1.
fn turn_of(scale: f32, alpha: Vec2) -> f32 {
    let (low, high) = (alpha.min_element(), alpha.max_element());
    ((scale - low) / (high - low)).clamp(0.0, 1.0)
}

/// The roughness across the directions of a row, and their cos²φ: scale² = αx² cos²φ + αy² sin²φ.
fn turned(alpha: Vec2, at: f32) -> (f32, f32) {
    let scale = alpha.min_element() + (alpha.max_element() - alpha.min_element()) * at;
    let (x2, y2) = (alpha.x * alpha.x, alpha.y * alpha.y);
    (scale, ((scale * scale - y2) / (x2 - y2)).clamp(0.0, 1.0))
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
fn share_returned(facets: &Microfacets, wo: Local, returned: &impl Fn(&Microfacets, Local, Vec2) -> f32) -> f32 {
    let at = |i: u32| {
        let q = (i as f32 + 0.5) / LATTICE[1] as f32;
        let r = 1.0 - q * q * q;
        let place = 4.0 * ((i * LATTICE[0]) % LATTICE[1]) as f32 / LATTICE[1] as f32;
        let along = r * (2.0 * place.fract() - 1.0);
        let ab = match place as u32 {
            0 => Vec2::new(r, along),
            1 => Vec2::new(-r, along),
            2 => Vec2::new(along, r),
            _ => Vec2::new(along, -r),
        };
        f64::from(returned(facets, wo, 0.5 + 0.5 * ab) * (6.0 * r * q * q))
    };
    ((0..LATTICE[1]).map(at).sum::<f64>() / f64::from(LATTICE[1])) as f32
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

/// What a table depends on: which model, the bits of its numbers.
pub(in crate::bsdf) type Key = (Distribution, [u32; 4]);

/// Tables made once for each set of parameters and kept for the life of the process (1 to 18 kB each),
/// so that a material at a point is plain data.
pub(in crate::bsdf) struct Shelf<T: 'static>(Mutex<BTreeMap<Key, &'static T>>);

impl<T> Shelf<T> {
    pub const fn new() -> Shelf<T> {
        Shelf(Mutex::new(BTreeMap::new()))
    }

    pub fn get(&self, key: Key, make: impl FnOnce() -> T) -> &'static T {
        // A table is whole or not there: what a panic elsewhere left behind can be used.
        let mut tables = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        tables.entry(key).or_insert_with(|| Box::leak(Box::new(make())))
    }
}

impl Domain {
    pub(in crate::bsdf) fn bits(self) -> [u32; 2] {
        match self {
            Domain::One(alpha) => alpha.to_array().map(f32::to_bits),
            Domain::All => [u32::MAX; 2],
        }
    }
}
