//! Sampling of points of a picture in proportion to a bilinearly interpolated weight.

use std::ops::Range;

use glam::{IVec2, UVec2, Vec2, Vec4};
use rayon::prelude::*;

use crate::math::Discrete;
use crate::math::float::ONE_MINUS_EPSILON;

/// Weights of the pixels of a picture, which are interpolated between the centres of pixels.
pub(super) trait Weights: Sync {
    /// Width and height of the picture (pixels).
    fn size(&self) -> UVec2;

    /// Weight of a pixel; coordinates run from −1 to the width and height, one beyond the borders.
    ///
    /// The weights may be negative beyond the borders, as long as all means of neighbours are at least 0.
    fn weight(&self, pixel: IVec2) -> f32;

    /// Weights of the four pixels around a point, those above before those below.
    #[inline]
    fn around(&self, [left, top]: [i32; 2]) -> [f32; 4] {
        [[left, top], [left + 1, top], [left, top + 1], [left + 1, top + 1]].map(|pixel| self.weight(pixel.into()))
    }
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
        let size = weights.size();
        let (row, _, rest_y) = self.rows.sample(u.y);
        let columns = size.x as usize + 1;
        let shares = &self.cumulative[row * columns..(row + 1) * columns];
        let column = shares.partition_point(|&share| share <= u.x).min(columns - 1);
        let before = if column == 0 { 0.0 } else { shares[column - 1] };
        let rest_x = ((u.x - before) / (shares[column] - before)).clamp(0.0, ONE_MINUS_EPSILON);
        let around = weights.around([column as i32 - 1, row as i32 - 1]);
        let cell = Cell::new(size, [column, row], around);
        let point = cell.sample(Vec2::new(rest_x, rest_y));
        ((point - 0.5) / size.as_vec2()).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// Density of a point by the area of the unit square, without the factors that `weights` lacks there.
    ///
    /// - `weight`: interpolated weight of the point
    pub fn density(&self, weight: f32) -> f32 {
        (f64::from(weight) / self.integral) as f32
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
        sum += f64::from(Cell::new(size, [x, y], [above[x], above[x + 1], below[x], below[x + 1]]).weight());
        sums.push(sum);
    }
    if sum > 0.0 {
        // The last share is exactly 1, so that a random number below 1 always finds a cell with weight.
        shares.iter_mut().zip(sums).for_each(|(share, part)| *share = (part / sum) as f32);
    }
    sum as f32
}

/// Cell between the centres of four pixels, or the half of one that is within the picture.
struct Cell {
    /// Extent along x and y, as coordinates in which the centre of the first pixel is at 1.
    extent: [Range<f32>; 2],
    /// Weights at the corners: left and right above, left and right below.
    corners: [f32; 4],
}

impl Cell {
    /// - `around`: weights of the four pixels, [`Weights::around`]
    #[inline]
    fn new(size: UVec2, cell: [usize; 2], around: [f32; 4]) -> Cell {
        let extent = [(cell[0], size.x), (cell[1], size.y)].map(|(at, count)| {
            let low = if at == 0 { 0.5 } else { at as f32 };
            let high = if at == count as usize { at as f32 + 0.5 } else { at as f32 + 1.0 };
            low..high
        });
        let inside = |axis: usize, x: f32| x - cell[axis] as f32;
        let [x, y] = &extent;
        let corner = |x, y| bilinear(around, Vec2::new(inside(0, x), inside(1, y))).max(0.0);
        let corners = [corner(x.start, y.start), corner(x.end, y.start), corner(x.start, y.end), corner(x.end, y.end)];
        Cell { extent, corners }
    }

    /// Integral of the weight (square pixels).
    #[inline]
    fn weight(&self) -> f32 {
        let [x, y] = &self.extent;
        0.25 * Vec4::from(self.corners).element_sum() * (x.end - x.start) * (y.end - y.start)
    }

    fn sample(&self, u: Vec2) -> Vec2 {
        let [a, b, c, d] = self.corners;
        let y = linear(u.y, a + b, c + d);
        let x = linear(u.x, a + (c - a) * y, b + (d - b) * y);
        let within = |range: &Range<f32>, share: f32| range.start + (range.end - range.start) * share;
        Vec2::new(within(&self.extent[0], x), within(&self.extent[1], y))
    }
}

/// Samples the share x of an interval with a density that goes linearly from `a` to `b`.
///
/// x = u (a + b) / (a + √(a² + u (b² − a²)))
fn linear(u: f32, a: f32, b: f32) -> f32 {
    let (a, b, u) = (f64::from(a), f64::from(b), f64::from(u));
    let denominator = a + (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    if denominator > 0.0 { ((u * (a + b) / denominator) as f32).min(1.0) } else { u as f32 }
}

/// Bilinear interpolation of values at left and right above, and left and right below.
#[inline]
pub(super) fn bilinear(values: [f32; 4], share: Vec2) -> f32 {
    let [a, b, c, d] = values;
    let (above, below) = (a + (b - a) * share.x, c + (d - c) * share.x);
    above + (below - above) * share.y
}
