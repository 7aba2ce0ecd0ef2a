//! Directions sampled at one incidence, with the expectations that the density gives.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::Vec2;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::model::Model;
use super::options::Options;
use super::quadrature::{Hint, Limits, integrate};
use super::rect::{CylinderPoint, Rect, direction, to_cylinder};
use super::rounding::{same_direction, shifted};
use crate::bsdf::{BsdfSample, TransportMode};
use crate::math::float::unit_f32;
use crate::math::{Density, Local};
use crate::measure::Mean;

/// Rows and columns of the fine grid: bins of 1°–2°, which show a shifted edge.
pub const FINE: [usize; 2] = [80, 160];
/// Rows and columns of the coarse grid: few bins, which show a shape that is wrong by 1 %. Each holds 8 × 8 fine bins.
pub const COARSE: [usize; 2] = [10, 20];
/// Halvings of the third division: at most 2⁸ cells of equal probability, however narrow the lobe is.
const HALVINGS: u32 = 8;
/// Smallest width of a cell (rad): rounding by 2⁻²⁴ must not move directions over its edges.
const NARROWEST: f64 = 1.0 / 65_536.0;
/// Directions sampled beforehand, to form the cells of equal probability. They are not counted.
const GUIDES: u64 = 1 << 14;
/// Number of samples of a bin that guide the quadrature.
const HINTS: usize = 1024;

/// Halvings of a piece for its error alone, at most.
const MAX_ERROR_DEPTH: u32 = 14;
/// Largest width of a piece (rad). It limits what the nodes can miss.
const WIDEST: f64 = 0.05;

/// Division of the sphere into bins, with expectations and counts.
#[derive(Clone, Debug)]
pub struct Division {
    /// Name for reports.
    pub name: &'static str,
    /// The bins.
    pub bins: Vec<Rect>,
    /// Probability ∫ pdf dω of each bin.
    pub shares: Vec<f64>,
    /// Samples in each bin.
    pub counts: Vec<u64>,
}

/// A delta lobe that the model lists, with the result of sampling it.
#[derive(Clone, Debug)]
pub struct SampledLobe {
    /// The lobe as listed.
    pub listed: BsdfSample,
    /// Mean of weight · [this lobe was chosen], averaged over the coefficients: its expectation is the lobe's own weight.
    pub weight: Mean,
}

/// Samples for one `wo`.
#[derive(Clone, Debug)]
pub struct SampledDirections {
    /// Direction towards the viewer, for which the samples were drawn.
    pub wo: Local,
    /// Number of samples.
    pub samples: u64,
    /// Number of samples that failed.
    pub failed: u64,
    /// Number of samples with a density.
    pub smooth: u64,
    /// Delta lobes.
    pub lobes: Vec<SampledLobe>,
    /// A delta sample that is not a listed lobe, if there was one.
    pub stray: Option<BsdfSample>,
    /// Albedo: mean of the weights of importance, per coefficient, where a failed sample counts as 0.
    pub albedo: [Mean; 3],
    /// ∫ pdf over the sphere. It is computed by two quadratures over different cells. A jump may deceive one of them, but a wrong
    /// density is wrong in both, so the value nearer to the share of samples with a density is kept.
    pub mass: f64,
    /// Mean relative change of the density under one rounding of a direction.
    pub blur: f64,
    /// Fine, coarse, and cells of equal probability.
    pub divisions: [Division; 3],
}

/// Random numbers of one incidence.
struct RandomNumbers(Xoshiro256PlusPlus);

impl RandomNumbers {
    fn next(&mut self) -> (f32, Vec2) {
        let [choice, x, y] = [(); 3].map(|()| unit_f32(self.0.next_u32()));
        (choice, Vec2::new(x, y))
    }
}

impl SampledDirections {
    /// Samples the model at `wo`; `stream` makes the random numbers of incidences independent.
    pub fn new(model: &dyn Model, wo: Local, stream: u64, options: &Options) -> SampledDirections {
        let mut numbers = RandomNumbers(Xoshiro256PlusPlus::seed_from_u64(options.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ stream));
        let mut draw = || {
            let (choice, u) = numbers.next();
            model.sample(wo, choice, u, TransportMode::Importance)
        };
        let guides: Vec<BsdfSample> = (0..GUIDES).filter_map(|_| draw()).filter(|s| smooth_point(*s).is_some()).collect();
        let blur = blur(model, wo, &guides[..guides.len().min(BLUR_SAMPLES)]);
        let guides = guides.into_iter().filter_map(smooth_point).collect();
        let (cells, tree) = equal_probability_cells(guides);
        let mut fine = BinCounts::new((0..FINE[0] * FINE[1]).map(|i| Rect::bin(i, FINE[0], FINE[1])).collect());
        let mut cells_of_equal_probability = BinCounts::new(cells);
        let mut tally = LobeTally::new(model.delta_lobes(wo, TransportMode::Importance));
        for _ in 0..options.samples {
            if let Some(at) = tally.add(draw()) {
                fine.add(Rect::bin_of(at, FINE[0], FINE[1]), at);
                cells_of_equal_probability.add(tree.leaf(at), at);
            }
        }
        let pdf = |at: CylinderPoint| f64::from(model.pdf(wo, direction(at)).get());
        let fine = fine.integrate_density(&pdf, "80×160", options.samples);
        let cells_of_equal_probability = cells_of_equal_probability.integrate_density(&pdf, "equal chance", options.samples);
        let coarse = coarse(&fine);
        let n = options.samples;
        let lobes = tally.lobes.into_iter().map(|(listed, sums)| SampledLobe { listed, weight: sums.mean(n) }).collect();
        let share = tally.smooth as f64 / n as f64;
        let masses = [&fine, &cells_of_equal_probability].map(|division| division.shares.iter().sum::<f64>());
        let mass = if (masses[0] - share).abs() <= (masses[1] - share).abs() { masses[0] } else { masses[1] };
        let albedo = tally.weights.map(|sums| sums.mean(n));
        let (failed, smooth, stray) = (tally.failed, tally.smooth, tally.stray);
        SampledDirections {
            wo,
            samples: n,
            failed,
            smooth,
            lobes,
            stray,
            albedo,
            mass,
            blur,
            divisions: [fine, coarse, cells_of_equal_probability],
        }
    }
}

impl SampledDirections {
    /// Whether f32 resolves the directions of a lobe well enough to judge their distribution.
    ///
    /// Rounding moves a share `blur` of the density elsewhere, and most of that cancels. A limit of 1 % hides no error that matters
    /// and causes none.
    pub fn is_resolved(&self) -> bool {
        self.blur <= 0.01
    }
}

/// Number of samples for which the effect of rounding is measured.
const BLUR_SAMPLES: usize = 1024;

fn blur(model: &dyn Model, wo: Local, samples: &[BsdfSample]) -> f64 {
    let pdf = |wi: Local| f64::from(model.pdf(wo, wi).get());
    let change = |sample: &BsdfSample| {
        let centre = pdf(sample.wi);
        let largest = shifted(sample.wi, 1.0).map(|wi| (pdf(wi) - centre).abs()).into_iter().fold(0.0, f64::max);
        if largest > 0.0 { (largest / centre).min(1.0) } else { 0.0 }
    };
    samples.iter().map(change).sum::<f64>() / samples.len().max(1) as f64
}

fn smooth_point(sample: BsdfSample) -> Option<CylinderPoint> {
    matches!(sample.density, Density::Smooth(_)).then(|| to_cylinder(sample.wi))
}

/// Σx, Σx²
#[derive(Clone, Copy, Default)]
struct Sums(f64, f64);

impl Sums {
    fn add(&mut self, x: f32) {
        self.0 += f64::from(x);
        self.1 += f64::from(x) * f64::from(x);
    }

    fn mean(self, samples: u64) -> Mean {
        Mean::from_sums(self.0, self.1, samples)
    }
}

struct LobeTally {
    failed: u64,
    smooth: u64,
    lobes: Vec<(BsdfSample, Sums)>,
    stray: Option<BsdfSample>,
    weights: [Sums; 3],
}

impl LobeTally {
    fn new(lobes: Vec<BsdfSample>) -> LobeTally {
        let lobes = lobes.into_iter().map(|lobe| (lobe, Sums::default())).collect();
        LobeTally { failed: 0, smooth: 0, lobes, stray: None, weights: [Sums::default(); 3] }
    }

    /// Counts a sample. Returns its point if it has a density.
    fn add(&mut self, sample: Option<BsdfSample>) -> Option<CylinderPoint> {
        let Some(sample) = sample else {
            self.failed += 1;
            return None;
        };
        // Measuring reads the coefficients, as the film does.
        self.weights.iter_mut().zip(sample.weight.to_rgb()).for_each(|(sums, x)| sums.add(x));
        let at = smooth_point(sample);
        match (at, self.lobes.iter_mut().find(|(lobe, _)| same_direction(lobe.wi, sample.wi))) {
            (Some(_), _) => self.smooth += 1,
            (None, Some((_, sums))) => sums.add(sample.weight.average()),
            (None, None) => self.stray = self.stray.or(Some(sample)),
        }
        at
    }
}

/// Bins with counts.
struct BinCounts {
    bins: Vec<Rect>,
    counts: Vec<u64>,
    /// First samples of each bin.
    hints: Vec<Vec<CylinderPoint>>,
}

impl BinCounts {
    fn new(bins: Vec<Rect>) -> BinCounts {
        BinCounts { counts: vec![0; bins.len()], hints: vec![vec![]; bins.len()], bins }
    }

    fn add(&mut self, bin: usize, at: CylinderPoint) {
        self.counts[bin] += 1;
        if self.hints[bin].len() < HINTS {
            self.hints[bin].push(at);
        }
    }

    /// Integrates the density over the bins.
    ///
    /// Each expectation may be wrong by ε standard deviations, so that all of them add Σε² = 0.05 √(2 bins) to a statistic with a
    /// standard deviation of √(2 bins).
    fn integrate_density(self, pdf: &(impl Fn(CylinderPoint) -> f64 + Sync), name: &'static str, samples: u64) -> Division {
        let (n, bins) = (samples as f64, self.bins.len() as f64);
        let epsilon = (0.05 * (2.0 * bins).sqrt() / bins).sqrt();
        let share = |((&bin, &count), hints): ((&Rect, &u64), &Vec<CylinderPoint>)| {
            // Bins that expect fewer than 5 are pooled, so an error below that of 5 does not matter.
            let spread = count.max(5) as f64;
            let mut hints: Vec<Hint> = hints.iter().map(|&point| Hint { point, density: pdf(point) }).collect();
            integrate_bin(pdf, bin, &mut hints, Limits { tolerance: epsilon * spread.sqrt() / n, max_error_depth: MAX_ERROR_DEPTH })
        };
        let shares = self.bins.iter().zip(&self.counts).zip(&self.hints).map(share).collect();
        Division { name, bins: self.bins, shares, counts: self.counts }
    }
}

/// ∫ pdf over a bin, which is first cut into pieces about as small as the bins of the fine grid.
fn integrate_bin(pdf: &impl Fn(CylinderPoint) -> f64, bin: Rect, hints: &mut [Hint], limits: Limits) -> f64 {
    let widths = bin.extent();
    let axis = usize::from(widths[1] > widths[0]);
    if widths[axis] <= WIDEST {
        return integrate(pdf, bin, hints, limits);
    }
    let at = bin.middle()[axis];
    hints.sort_unstable_by(|a, b| a.point[axis].total_cmp(&b.point[axis]));
    let (low, high) = hints.split_at_mut(hints.partition_point(|hint| hint.point[axis] < at));
    let [first, second] = bin.cut(axis, at);
    let limits = Limits { tolerance: limits.tolerance * FRAC_1_SQRT_2, ..limits };
    integrate_bin(pdf, first, low, limits) + integrate_bin(pdf, second, high, limits)
}

/// Cells with equal numbers of guides, and the tree that finds them.
fn equal_probability_cells(mut guides: Vec<CylinderPoint>) -> (Vec<Rect>, Tree) {
    guides.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let surface = guides.partition_point(|at| at[0] < 0.0);
    let (below, above) = guides.split_at_mut(surface);
    let mut cells = vec![];
    // A density may jump at the surface, so no cell extends across it.
    let [lower, upper] = Rect::HALVES;
    let parts = Box::new([halve(lower, below, HALVINGS, &mut cells), halve(upper, above, HALVINGS, &mut cells)]);
    (cells, Tree::Cut { axis: 0, at: 0.0, parts })
}

/// Halves the guides of a cell at their median, across its longer side.
fn halve(cell: Rect, guides: &mut [CylinderPoint], left: u32, cells: &mut Vec<Rect>) -> Tree {
    let widths = cell.extent();
    let axis = usize::from(widths[1] > widths[0]);
    guides.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
    let at = guides.get(guides.len() / 2).map_or(0.0, |median| median[axis]);
    let [first, second] = cell.cut(axis, at);
    let wide = [first, second].iter().all(|part| part.extent()[axis] > NARROWEST);
    let few = (guides.len() as u64) < GUIDES >> HALVINGS;
    if left == 0 || few || !wide {
        cells.push(cell);
        return Tree::Leaf(cells.len() - 1);
    }
    let (low, high) = guides.split_at_mut(guides.partition_point(|guide| guide[axis] < at));
    Tree::Cut { axis, at, parts: Box::new([halve(first, low, left - 1, cells), halve(second, high, left - 1, cells)]) }
}

/// Tree that finds the cell of equal probability that holds a point.
enum Tree {
    Leaf(usize),
    Cut { axis: usize, at: f64, parts: Box<[Tree; 2]> },
}

impl Tree {
    fn leaf(&self, point: CylinderPoint) -> usize {
        match self {
            Tree::Leaf(index) => *index,
            Tree::Cut { axis, at, parts } => parts[usize::from(point[*axis] >= *at)].leaf(point),
        }
    }
}

/// Sums of 8 × 8 fine bins.
fn coarse(fine: &Division) -> Division {
    let [rows, columns] = COARSE;
    let bins: Vec<Rect> = (0..rows * columns).map(|i| Rect::bin(i, rows, columns)).collect();
    let (mut shares, mut counts) = (vec![0.0; bins.len()], vec![0; bins.len()]);
    for (i, (share, count)) in fine.shares.iter().zip(&fine.counts).enumerate() {
        let (row, column) = (i / FINE[1] * rows / FINE[0], i % FINE[1] * columns / FINE[1]);
        shares[row * columns + column] += share;
        counts[row * columns + column] += count;
    }
    Division { name: "10×20", bins, shares, counts }
}
