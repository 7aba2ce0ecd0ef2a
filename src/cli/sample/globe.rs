//! Histogram of directions by longitude and latitude, counted and drawn as the sample tester of dirt and darts does it.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::{DVec3, UVec2};

use crate::error::Result;
use crate::film::{Channel, Image};
use crate::output::{self, Colormap, Tonemap, png};

/// Cells from pole to pole; z is up.
pub const ROWS: usize = 256;
/// Cells around; the azimuth runs from +x to the right.
pub const COLUMNS: usize = 512;
/// Directions within each cell at which the density is evaluated, along each side.
const FINER: usize = 4;
/// Cells, along each side, whose counts are merged: a single one has only fifty.
const MERGED: usize = 4;

/// Density over the sphere: its mean in each cell, from the upper pole, and its integral.
pub struct Density {
    /// Mean of each cell.
    pub cells: Vec<f64>,
    /// Integral over the sphere.
    pub integral: f64,
    /// Whether a value was negative or not finite.
    pub is_wrong: bool,
}

impl Density {
    /// Evaluates a density.
    ///
    /// - `pdf`: density of a unit direction [sr⁻¹]
    pub fn new(pdf: impl Fn(DVec3) -> f64) -> Density {
        let mut density = Density { cells: vec![], integral: 0.0, is_wrong: false };
        let side = |cell: usize, part: usize, cells: usize| (cell as f64 + (part as f64 + 0.5) / FINER as f64) / cells as f64;
        let patch = PI / (ROWS * FINER) as f64 * TAU / (COLUMNS * FINER) as f64;
        for (row, column) in (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column))) {
            let mut sum = 0.0;
            for (i, j) in (0..FINER).flat_map(|i| (0..FINER).map(move |j| (i, j))) {
                let (sin, cos) = (PI * side(row, i, ROWS)).sin_cos();
                let (y, x) = (TAU * side(column, j, COLUMNS)).sin_cos();
                let value = pdf(DVec3::new(sin * x, sin * y, cos));
                density.is_wrong |= !value.is_finite() || value < 0.0;
                sum += value;
                density.integral += value * sin * patch;
            }
            density.cells.push(sum / (FINER * FINER) as f64);
        }
        density
    }

    /// Value that is shown brightest: all but the largest half per mille lies below it.
    fn brightest(&self) -> f64 {
        let mut sorted = self.cells.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[((sorted.len() - 1) as f64 * 0.9995) as usize]
    }
}

/// Counts of sampled directions.
pub struct Histogram {
    counts: Vec<u64>,
    drawn: u64,
}

impl Histogram {
    /// Empty counts.
    ///
    /// - `drawn`: total number of samples, valid or not
    pub fn new(drawn: u64) -> Histogram {
        Histogram { counts: vec![0; ROWS / MERGED * (COLUMNS / MERGED)], drawn }
    }

    /// Counts a direction.
    pub fn add(&mut self, w: DVec3) {
        let (theta, phi) = (w.z.clamp(-1.0, 1.0).acos(), w.y.atan2(w.x).rem_euclid(TAU));
        let [rows, columns] = [ROWS / MERGED, COLUMNS / MERGED];
        let row = ((theta / PI * rows as f64) as usize).min(rows - 1);
        let column = ((phi / TAU * columns as f64) as usize).min(columns - 1);
        self.counts[row * columns + column] += 1;
    }

    /// Density that the counts show, in each cell of a [`Density`].
    fn cells(&self) -> Vec<f64> {
        let of = |row: usize, column: usize| {
            let row = row / MERGED;
            let edge = |row: usize| (PI * (row * MERGED) as f64 / ROWS as f64).cos();
            let solid_angle = (edge(row) - edge(row + 1)) * TAU * MERGED as f64 / COLUMNS as f64;
            self.counts[row * (COLUMNS / MERGED) + column / MERGED] as f64 / (self.drawn as f64 * solid_angle)
        };
        (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column))).map(|(row, column)| of(row, column)).collect()
    }
}

/// Writes `STEM-pdf.png` and `STEM-sampled.png`, with the same scale of colours.
///
/// # Errors
/// `Io`.
pub fn pictures(pdf: &Density, drawn: &Histogram, stem: &str) -> Result<()> {
    let brightest = pdf.brightest();
    for (name, cells) in [("pdf", &pdf.cells), ("sampled", &drawn.cells())] {
        let picture = picture(cells, brightest);
        output::replace(Path::new(&format!("{stem}-{name}.png")), &png::encode(&picture, &Tonemap::default())?)?;
    }
    Ok(())
}

/// Picture in the colours of the sample tester of dirt and darts: the map Inferno, whose values are taken as linear light.
fn picture(cells: &[f64], brightest: f64) -> Image {
    let share = |x: f64| if brightest > 0.0 { x / brightest } else { 0.0 };
    let colors: Vec<[u8; 3]> = cells.iter().map(|&x| Colormap::Inferno.color(share(x))).collect();
    let channel =
        |(c, name): (usize, &str)| Channel { name: name.into(), values: colors.iter().map(|rgb| f32::from(rgb[c]) / 255.0).collect() };
    let size = UVec2::new(COLUMNS as u32, ROWS as u32);
    Image { full_size: size, origin: UVec2::ZERO, size, channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
}
