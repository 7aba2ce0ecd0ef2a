//! Tables of triples of numbers, interpolated bilinearly.

use rayon::prelude::*;

/// Table over the unit square, with its first and last entries at the borders.
pub(super) struct Table {
    columns: usize,
    rows: usize,
    values: Vec<[f64; 3]>,
}

impl Table {
    /// Computes a table row by row. Its values do not depend on the number of threads.
    ///
    /// - `row`: the values of a row, given its coordinate y in [0, 1]
    pub fn new(columns: usize, rows: usize, row: impl Fn(f64) -> Vec<[f64; 3]> + Sync) -> Table {
        let lines: Vec<Vec<[f64; 3]>> = (0..rows).into_par_iter().map(|y| row(coordinate(y, rows))).collect();
        Table { columns, rows, values: lines.concat() }
    }

    /// Interpolated values. Coordinates beyond the unit square are clamped to it.
    pub fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let [(column, x), (row, y)] = [(x, self.columns), (y, self.rows)].map(|(share, count)| {
            let at = share.clamp(0.0, 1.0) * (count - 1) as f64;
            let low = at.floor().min((count - 2) as f64);
            (low as usize, at - low)
        });
        let line = |row: usize, k: usize| {
            let at = row * self.columns + column;
            self.values[at][k] * (1.0 - x) + self.values[at + 1][k] * x
        };
        std::array::from_fn(|k| line(row, k) * (1.0 - y) + line(row + 1, k) * y)
    }
}

/// Coordinate of an entry, in [0, 1].
pub(super) fn coordinate(entry: usize, count: usize) -> f64 {
    entry as f64 / (count - 1) as f64
}
