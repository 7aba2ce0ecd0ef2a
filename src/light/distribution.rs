//! Sampling of points of a picture in proportion to a bilinearly interpolated weight.

use glam::{IVec2, UVec2, Vec2};
use rayon::prelude::*;

use crate::math::Discrete;
use crate::math::discrete::{Condition, partition_point_lanes};
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::lanes::{Lanes, One};

/// Weights of the pixels of a picture, which are interpolated between the centres of pixels.
pub(super) trait Weights: Sync {
    /// Width and height of the picture (pixels).
    fn size(&self) -> UVec2;

    /// Weight of a pixel; coordinates run from −1 to the width and height, one beyond the borders.
    ///
    /// The weights may be negative beyond the borders, as long as all means of neighbours are at least 0.
    fn weight(&self, pixel: IVec2) -> f32;

    /// Weights of the four pixels around a cell in each lane, those above before those below.
    ///
    /// - `cell`: column and row, from 0 to the width and height; the cell (0, 0) is between the pixels (−1, −1) and (0, 0)
    fn around<L: Lanes>(&self, cell: [L::U32; 2]) -> [L::F32; 4];
}

/// Distribution of points of the unit square whose density is proportional to the interpolated weight of a picture.
///
/// The centres of the pixels and the borders of the picture divide the square into cells, within which the weight is bilinear. A cell is
/// chosen by its row and then by its column, and a point in it by inverting the integral of the weight.
///
/// The density is that of the interpolation and not of pixels, so that there is no point with a weight above 0 and a density of 0.
///
/// Tests: a_picture_is_sampled_in_proportion_to_its_interpolation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Distribution {
    rows: Discrete,
    /// For each row of cells, the share of the row's weight in each cell and all before it.
    cumulative: Vec<f32>,
    /// Integral of the weight over the unit square.
    integral: f64,
}

impl Distribution {
    /// The distribution for some weights; `None` if they are 0 everywhere.
    ///
    /// The sums are independent of the number of threads. Scaling all weights by a power of two changes no bit of a sample.
    pub fn new(weights: &impl Weights) -> Option<Distribution> {
        let [columns, rows] = weights.size().to_array().map(|n| n as usize + 1);
        let mut cumulative = vec![0.0; columns * rows];
        let row = |(y, shares): (usize, &mut [f32])| fill_row(weights, y, shares);
        let sums: Vec<f32> = cumulative.par_chunks_mut(columns).enumerate().map(row).collect();
        let rows = Discrete::new(&sums)?;
        let size = weights.size().as_dvec2();
        let integral = rows.total() / (size.x * size.y);
        Some(Distribution { rows, cumulative, integral })
    }

    /// Samples a point in [0, 1)².
    pub fn sample(&self, weights: &impl Weights, u: Vec2) -> Vec2 {
        self.sample_lanes::<One>(weights, u.to_array()).into()
    }

    /// [`Distribution::sample`] in each lane.
    #[inline(always)]
    pub fn sample_lanes<L: Lanes>(&self, weights: &impl Weights, [u, v]: [L::F32; 2]) -> [L::F32; 2] {
        let size = weights.size();
        let columns = size.x + 1;
        let (row, rest_y) = self.rows.sample_lanes::<L>(v);
        let shares = RowShares::<L> { shares: &self.cumulative, first: row * L::u32(columns), u };
        let column = partition_point_lanes(columns, &shares);
        let (zero, below_one) = (L::f32(0.0), L::f32(ONE_MINUS_EPSILON));
        let before = L::select(L::eq_u32(column, L::u32(0)), zero, shares.at(column - L::u32(1)));
        let rest_x = L::min(L::max((u - before) / (shares.at(column) - before), zero), below_one);
        let cell = Cell::<L>::new(size, [column, row], weights.around::<L>([column, row]));
        let [x, y] = cell.sample([rest_x, rest_y]);
        let x = (x - L::f32(0.5)) / L::f32(size.x as f32);
        let y = (y - L::f32(0.5)) / L::f32(size.y as f32);
        [L::min(L::max(x, zero), below_one), L::min(L::max(y, zero), below_one)]
    }

    /// Density of a point, by area of the unit square: its weight over the integral of the weight.
    ///
    /// - `weight`: interpolated weight of the point
    pub fn density(&self, weight: f32) -> f32 {
        self.density_lanes::<One>(weight)
    }

    /// [`Distribution::density`] in each lane.
    #[inline(always)]
    pub fn density_lanes<L: Lanes>(&self, weight: L::F32) -> L::F32 {
        L::narrow(L::widen(weight) / L::f64(self.integral))
    }
}

/// Cumulative shares of the cells of a row in each lane, and a random number that is compared with them.
struct RowShares<'a, L: Lanes> {
    shares: &'a [f32],
    /// Place of the row's first share.
    first: L::U32,
    u: L::F32,
}

impl<L: Lanes> RowShares<'_, L> {
    #[inline(always)]
    fn at(&self, column: L::U32) -> L::F32 {
        L::gather(self.shares, self.first + column)
    }
}

impl<L: Lanes> Condition<L> for RowShares<'_, L> {
    #[inline(always)]
    fn holds(&self, column: L::U32) -> L::Mask {
        L::le(self.at(column), self.u)
    }
}

/// Sets the cumulative shares of a row of cells; returns the sum of its weights, each times the area of its cell in pixels.
fn fill_row(weights: &impl Weights, y: usize, shares: &mut [f32]) -> f32 {
    let size = weights.size();
    let line = |row: i32| (-1..=size.x as i32).map(|x| weights.weight(IVec2::new(x, row))).collect::<Vec<f32>>();
    let (above, below) = (line(y as i32 - 1), line(y as i32));
    let mut sum = 0.0;
    let mut sums = Vec::with_capacity(shares.len());
    for x in 0..shares.len() {
        let around = [above[x], above[x + 1], below[x], below[x + 1]];
        sum += f64::from(Cell::<One>::new(size, [x, y].map(|k| One::u32(k as u32)), around).weight());
        sums.push(sum);
    }
    if sum > 0.0 {
        // The last share is exactly 1, so that a random number below 1 always finds a cell with weight.
        shares.iter_mut().zip(sums).for_each(|(share, part)| *share = (part / sum) as f32);
    }
    sum as f32
}

/// Cells between the centres of four pixels, or the halves of them that are within the picture, one in each lane.
struct Cell<L: Lanes> {
    /// Lower and upper ends along x and y, as coordinates in which the centre of the first pixel is at 1.
    extent: [[L::F32; 2]; 2],
    /// Weights at the corners: left and right above, left and right below.
    corners: [L::F32; 4],
}

impl<L: Lanes> Cell<L> {
    /// - `around`: weights of the four pixels, [`Weights::around`]
    #[inline(always)]
    fn new(size: UVec2, cell: [L::U32; 2], around: [L::F32; 4]) -> Cell<L> {
        let [x, y] = [extent::<L>(cell[0], size.x), extent::<L>(cell[1], size.y)];
        let (left, right) = (x[0] - L::to_f32(cell[0]), x[1] - L::to_f32(cell[0]));
        let (top, bottom) = (y[0] - L::to_f32(cell[1]), y[1] - L::to_f32(cell[1]));
        let (a, b) = (bilinear::<L>(around, [left, top]), bilinear::<L>(around, [right, top]));
        let (c, d) = (bilinear::<L>(around, [left, bottom]), bilinear::<L>(around, [right, bottom]));
        let zero = L::f32(0.0);
        Cell { extent: [x, y], corners: [L::max(a, zero), L::max(b, zero), L::max(c, zero), L::max(d, zero)] }
    }

    /// Integral of the weight (square pixels).
    #[inline(always)]
    fn weight(&self) -> L::F32 {
        let [[left, right], [top, bottom]] = self.extent;
        let [a, b, c, d] = self.corners;
        L::f32(0.25) * ((a + b) + (c + d)) * (right - left) * (bottom - top)
    }

    #[inline(always)]
    fn sample(&self, u: [L::F32; 2]) -> [L::F32; 2] {
        let [a, b, c, d] = self.corners;
        let y = linear::<L>(u[1], a + b, c + d);
        let x = linear::<L>(u[0], a + (c - a) * y, b + (d - b) * y);
        let [[left, right], [top, bottom]] = self.extent;
        [left + (right - left) * x, top + (bottom - top) * y]
    }
}

/// Lower and upper ends of cells along an axis, of `count` pixels.
#[inline(always)]
fn extent<L: Lanes>(cell: L::U32, count: u32) -> [L::F32; 2] {
    let (at, half) = (L::to_f32(cell), L::f32(0.5));
    let low = L::select(L::eq_u32(cell, L::u32(0)), half, at);
    [low, L::select(L::eq_u32(cell, L::u32(count)), at + half, at + L::f32(1.0))]
}

/// Samples the share x of an interval with a density that goes linearly from `a` to `b`.
///
/// x = u (a + b) / (a + √(a² + u (b² − a²)))
#[inline(always)]
fn linear<L: Lanes>(u: L::F32, a: L::F32, b: L::F32) -> L::F32 {
    let (u, a, b) = (L::widen(u), L::widen(a), L::widen(b));
    let zero = L::f64(0.0);
    let denominator = a + L::sqrt_f64(L::max_f64(a * a + u * (b * b - a * a), zero));
    let share = L::select_f64(L::lt_f64(zero, denominator), u * (a + b) / denominator, u);
    L::min(L::narrow(share), L::f32(1.0))
}

/// Bilinear interpolation of values at left and right above, and left and right below.
#[inline(always)]
pub(super) fn bilinear<L: Lanes>([a, b, c, d]: [L::F32; 4], [x, y]: [L::F32; 2]) -> L::F32 {
    let (above, below) = (a + (b - a) * x, c + (d - c) * x);
    above + (below - above) * y
}
