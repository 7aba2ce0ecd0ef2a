//! Pictures at falling resolutions, and averages of a picture over ellipses.

use glam::{DVec2, UVec2};

use super::pixels::Pixels;
use crate::math::Rgb;

/// A picture at ever smaller sizes, down to a single pixel. Each level is the previous one averaged to half its width and height.
///
/// Tests: pyramids_keep_the_mean, filtered_pictures_have_the_spread_of_the_footprint.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    /// The levels, except for the picture itself.
    levels: Vec<Level>,
}

#[derive(Clone, Debug, PartialEq)]
struct Level {
    size: UVec2,
    values: Vec<[f32; 3]>,
}

/// A level of a picture and the part of it that counts in an average.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipse<'a> {
    /// The size of the level (pixels).
    pub size: UVec2,
    values: &'a [[f32; 3]],
    /// xx, xy and yy of the matrix M of the ellipse xᵀ M⁻¹ x < 1 around the place of the lookup (pixels²).
    matrix: [f64; 3],
}

/// The greatest ratio of the axes of an ellipse. A longer one is made wider, so that no lookup takes more than about 150 pixels.
const MAX_RATIO: f64 = 8.0;

/// The variance of a uniform distribution over a parallelogram, divided by that of the weight (1 − r²)² over the ellipse with the same
/// sides for axes: 1/12 over 1/8.
const SPREAD: f64 = 2.0 / 3.0;

/// The least squared half axis for which an ellipse on a level averages enough pixels to stand for the area between them (pixels²).
const LEAST_AXIS: f64 = 1.0;

impl Pyramid {
    /// The levels of a picture.
    pub fn new(picture: &Pixels) -> Pyramid {
        let mut levels: Vec<Level> = vec![];
        loop {
            let (size, values) = levels.last().map_or((picture.size(), picture.values()), |level| (level.size, &level.values));
            if size.max_element() == 1 {
                return Pyramid { levels };
            }
            let next = halved(size, values);
            levels.push(next);
        }
    }

    /// The level and the ellipse on it whose average has the variance of a uniform average over a parallelogram; `None` if the
    /// parallelogram is smaller than the tent of a bilinear lookup.
    ///
    /// A pixel of a level of the scale s (in pixels of the picture) already has the variance (s² − 1) / 12 of its box, which the ellipse
    /// leaves out. So the average does not change its spread from one level to the next.
    ///
    /// - `picture`: the picture that the pyramid was made from
    /// - `sides`: the sides of the parallelogram (pixels of the picture)
    pub(super) fn ellipse<'a>(&'a self, picture: &'a Pixels, sides: [DVec2; 2]) -> Option<Ellipse<'a>> {
        let [a, b] = sides;
        let whole = [a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y].map(|x| SPREAD * x);
        let [least, most] = axes(whole);
        if most.is_nan() || most <= LEAST_AXIS {
            return None;
        }
        let narrow = least.max(most / (MAX_RATIO * MAX_RATIO));
        // The last level on which the narrow axis keeps its least length after the box is left out.
        let level = (whole_log4(narrow / (LEAST_AXIS + SPREAD)) as usize).min(self.levels.len());
        let (level_size, values) = match level.checked_sub(1) {
            None => (picture.size(), picture.values()),
            Some(k) => (self.levels[k].size, &self.levels[k].values[..]),
        };
        if level_size == UVec2::ONE {
            // However far the ellipse reaches, all it meets is the mean of the picture.
            return Some(Ellipse { size: level_size, values, matrix: [LEAST_AXIS, 0.0, LEAST_AXIS] });
        }
        let scale = level_size.as_dvec2() / picture.size().as_dvec2();
        let matrix = [
            whole[0] * scale.x * scale.x - SPREAD * (1.0 - scale.x * scale.x),
            whole[1] * scale.x * scale.y,
            whole[2] * scale.y * scale.y - SPREAD * (1.0 - scale.y * scale.y),
        ];
        Some(Ellipse { size: level_size, values, matrix: widened(matrix) })
    }
}

impl Ellipse<'_> {
    /// The average around a place, with the weight (1 − r²)² where r² = xᵀ M⁻¹ x.
    ///
    /// Source: Heckbert, *Fundamentals of Texture Mapping and Image Warping* (1989), "elliptical weighted average", with another weight.
    ///
    /// - `place`: from the upper left corner of the level (pixels)
    /// - `column`, `row`: the index on the level of any whole number of pixels
    pub fn average(&self, place: DVec2, column: impl Fn(f64) -> usize, row: impl Fn(f64) -> usize) -> Rgb {
        let [xx, xy, yy] = self.matrix;
        let place = place - 0.5;
        let (slope, across) = (xy / yy, xx - xy * xy / yy);
        let reach = yy.sqrt();
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        let mut y = (place.y - reach).ceil();
        while y <= place.y + reach {
            let dy = y - place.y;
            let left = 1.0 - dy * dy / yy;
            let (middle, half) = (place.x + slope * dy, (across * left.max(0.0)).sqrt());
            let line = &self.values[row(y) * self.size.x as usize..];
            let mut x = (middle - half).ceil();
            while x <= middle + half {
                let dx = x - middle;
                let inside = (left - dx * dx / across).max(0.0);
                let weight = inside * inside;
                let [r, g, b] = line[column(x)].map(f64::from);
                sum = [sum[0] + weight * r, sum[1] + weight * g, sum[2] + weight * b];
                weights += weight;
                x += 1.0;
            }
            y += 1.0;
        }
        let [r, g, b] = sum.map(|x| (x / weights) as f32);
        Rgb::new(r, g, b)
    }
}

/// The greatest k with 4ᵏ ≤ x; 0 for x below 1.
fn whole_log4(x: f64) -> u64 {
    if x >= 1.0 { ((x.to_bits() >> 52) - 1023) / 2 } else { 0 }
}

/// The squared half axes of an ellipse with a symmetric matrix, the smaller one first.
fn axes([xx, xy, yy]: [f64; 3]) -> [f64; 2] {
    let (middle, half) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
    [middle - half, middle + half]
}

/// The matrix of an ellipse with at least the half axis [`LEAST_AXIS`] and at most [`MAX_RATIO`] between its axes.
fn widened(matrix: [f64; 3]) -> [f64; 3] {
    let [least, most] = axes(matrix);
    let new_most = most.max(LEAST_AXIS);
    let new_least = least.max(new_most / (MAX_RATIO * MAX_RATIO)).max(LEAST_AXIS);
    if most - least <= f64::EPSILON * most {
        return [new_most, 0.0, new_most];
    }
    // M' = s M + t 1 has the same directions of its axes.
    let s = (new_most - new_least) / (most - least);
    let t = new_least - s * least;
    [s * matrix[0] + t, s * matrix[1], s * matrix[2] + t]
}

/// A picture at half its width and height, rounded down, but at least one pixel. Each pixel is the mean over its area.
fn halved(size: UVec2, values: &[[f32; 3]]) -> Level {
    let half = (size / 2).max(UVec2::ONE);
    let (width, short) = (size.x as usize, half.x as usize);
    let (columns, rows) = (shares(size.x, half.x), shares(size.y, half.y));
    let mut level = Vec::with_capacity(short * half.y as usize);
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0; 3];
            for &(y, of_row) in row {
                for &(x, of_column) in column {
                    let value = values[y * width + x];
                    sum = [0, 1, 2].map(|k| sum[k] + of_row * of_column * f64::from(value[k]));
                }
            }
            level.push(sum.map(|x| x as f32));
        }
    }
    Level { size: half, values: level }
}

/// The pixels of a line of `n` that each of `half` pixels covers, and their shares of it.
fn shares(n: u32, half: u32) -> Vec<Vec<(usize, f64)>> {
    let length = f64::from(n) / f64::from(half);
    let covered = |k: u32| {
        let (from, to) = (f64::from(k) * length, (f64::from(k + 1) * length).min(f64::from(n)));
        let share = |x: usize| ((x as f64 + 1.0).min(to) - (x as f64).max(from)) / length;
        (from as usize..to.ceil() as usize).map(|x| (x, share(x))).filter(|(_, share)| *share > 0.0).collect()
    };
    (0..half).map(covered).collect()
}
