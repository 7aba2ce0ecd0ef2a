//! Adaptive sampling: samples go where they are worth most.
//!
//! ```text
//! relMSE = 1/P Σ s²ᵢ/nᵢ,   s²ᵢ = σ²ᵢ / (r²ᵢ + ε)        is least, for Σ nᵢ fixed, where nᵢ ∝ sᵢ
//! ```
//!
//! s is told by a short pilot. A pixel whose own samples decided how many it gets would be biased: one that saw no light
//! would stop looking. So the pixels are divided like a chess board, and the allocation of each follows from pixels of the
//! other colour alone, of which its own samples are independent: its mean is unbiased and its error bar right, as if the allocation
//! had been given.
//!
//! Source of the allocation: Neyman, *On the Two Different Aspects of the Representative Method* (1934).
//! Tests: own_samples_have_no_say, noisy_pixels_take_more, adaptive_pays.

use std::sync::Arc;
use std::time::Duration;

use super::Watcher;
use super::around::around;
use super::relative::floor_at;
use crate::film::block::estimate;
use crate::film::{Allocation, Film, FilmSpec, MomentFilm};
use crate::integrator::Integrator;
use crate::render::{Render, Settings};
use crate::scene::Scene;

/// The pilot is this share of the samples asked for, …
const PILOT: u64 = 16;

/// … and where they are open, or many, no more than these per pixel.
const LONGEST_PILOT: u64 = 32;

/// Samples per round, on average: a calm pixel takes a single one, a noisy one up to 64.
const MEAN: f64 = 8.0;

/// The pixels whose noise counts lie this far away at most.
const REACH: usize = 2;

/// Renders a pilot and throws its picture away; returns the allocation it suggests, and the seconds it took.
///
/// - `samples`: per pixel, that the picture will have
pub fn explore(
    scene: &Arc<dyn Scene>,
    integrator: &dyn Integrator,
    spec: &FilmSpec,
    settings: &Settings,
    samples: u64,
    watcher: &dyn Watcher,
) -> (Allocation, Duration) {
    let spec = spec.clone().without_layers();
    let fewest = u64::from(2 * settings.sampler.spread().sequences());
    let samples = (samples / PILOT).clamp(fewest, LONGEST_PILOT.max(fewest)).next_power_of_two();
    let mut film = MomentFilm::new(spec.clone());
    let mut render = Render::new(scene.clone(), integrator, &spec, settings);
    render.advance(samples, &mut film, watcher);
    (allocate(&film), render.report().elapsed)
}

/// The allocation that a film's noise suggests.
pub fn allocate(film: &MomentFilm) -> Allocation {
    let size = film.spec().crop.size();
    let noise = Noise::of(film, size.x as usize);
    let mut levels = vec![0; noise.pixels.len()];
    for color in [0, 1] {
        let own: Vec<usize> = (0..levels.len()).filter(|&i| noise.color(i) == color).collect();
        let Some(floor) = noise.floor(1 - color) else { return Allocation::default() };
        let worth: Vec<f64> = own.iter().map(|&i| noise.around(i, floor)).collect();
        let scale = scale(&worth);
        own.iter().zip(&worth).for_each(|(&i, worth)| levels[i] = level(scale * worth));
    }
    Allocation::new(levels)
}

/// The nearest power of two.
fn level(samples: f64) -> u8 {
    samples.log2().round().clamp(0.0, Allocation::MAX_LEVEL.into()) as u8
}

/// By what to multiply these, so that as many samples as are near them average [`MEAN`].
fn scale(worth: &[f64]) -> f64 {
    let mean = |scale: f64| worth.iter().map(|worth| f64::from(1u32 << level(scale * worth))).sum::<f64>() / worth.len() as f64;
    // Between all at 1 and all at 64 it rises by steps; forty halvings end at one of them.
    let largest = worth.iter().fold(0.0, |a: f64, &b| a.max(b));
    if largest == 0.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while mean(high / largest) < MEAN && high < 1e12 {
        high *= 2.0;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if mean(middle / largest) < MEAN { low = middle } else { high = middle }
    }
    high / largest
}

/// A chess board of pixels that know how noisy they are.
struct Noise {
    width: usize,
    /// Mean and variance of a single sample, per colour.
    pixels: Vec<[(f64, f64); 3]>,
}

impl Noise {
    fn of(film: &MomentFilm, width: usize) -> Noise {
        let (block, samples) = (film.total(), film.samples());
        let single = |(mean, variance): (f64, f64)| (mean, variance * samples as f64);
        Noise { width, pixels: block.pixels().map(|pixel| estimate(block.spread(), pixel, samples).map(single)).collect() }
    }

    /// Of the square on which a pixel stands.
    fn color(&self, i: usize) -> usize {
        (i % self.width + i / self.width) % 2
    }

    /// ε, of the squares of one colour; `None` where they are black or none.
    fn floor(&self, color: usize) -> Option<f64> {
        let values = (0..self.pixels.len()).filter(|&i| self.color(i) == color).flat_map(|i| self.pixels[i].map(|(x, _)| x));
        let (sum, count) = values.fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
        floor_at(sum / f64::from(count))
    }

    /// s of pixel i, as its neighbours on squares of the other colour tell it.
    fn around(&self, i: usize, floor: f64) -> f64 {
        let others = around(i, REACH, self.width, self.pixels.len()).filter(|&q| self.color(q) != self.color(i));
        let squares = others.flat_map(|q| self.pixels[q].map(|(x, v)| v / (x * x + floor)));
        let (sum, count) = squares.fold((0.0, 0), |(sum, count), s| (sum + s, count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }
}
