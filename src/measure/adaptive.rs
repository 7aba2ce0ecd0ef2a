//! Adaptive sampling: pixels with more noise receive more samples.
//!
//! ```text
//! relMSE = 1/P Σ s²ᵢ/nᵢ,   s²ᵢ = σ²ᵢ / (r²ᵢ + ε)        is smallest, for a fixed Σ nᵢ, where nᵢ ∝ sᵢ
//! ```
//!
//! A short pilot render estimates s. If the samples of a pixel decided how many samples it gets, the pixel would be biased: a pixel
//! whose first samples found no light would stop too early. Therefore the pixels are divided like a chess board, and the allocation
//! of a pixel depends on pixels of the other colour only. Its own samples are independent of those, so its mean is unbiased and its
//! error bar is right, as if the allocation had been given.
//!
//! The noise of a pilot also tells whether this pays: the noise of each pixel is independent of its own number of samples nᵢ, so that
//!
//! ```text
//! relMSE adaptive / even = 1/P Σ nᵢ · Σ s²ᵢ/nᵢ / Σ s²ᵢ
//! ```
//!
//! Where this ratio is not clearly below 1, all pixels get the same number of samples. All pixels decide that together, so the
//! pilot has random numbers that the picture does not have.
//!
//! Source of the allocation: Neyman, *On the Two Different Aspects of the Representative Method* (1934).
//! Tests: sample_counts_do_not_depend_on_own_samples, noisy_pixels_get_more_samples, adaptive_sampling_reduces_the_error,
//! what_does_not_pay_is_sampled_evenly.

use std::sync::Arc;
use std::time::Duration;

use super::ErrorObserver;
use super::error::epsilon::floor_at;
use crate::film::neighborhood::neighborhood;
use crate::film::pixel_sums::estimate;
use crate::film::{Allocation, Film, FilmSpec, MomentFilm};
use crate::integrator::Integrator;
use crate::render::{Render, Settings};
use crate::sampler::SamplerSpec;
use crate::sampler::hash::mix;
use crate::scene::Scene;

/// Number of requested samples for each sample of the pilot.
const PILOT: u64 = 16;

/// Tells the random numbers of the pilot from those of the picture.
const PILOT_SEED: u64 = 0x0070_696c_6f74;

/// Largest number of samples per pixel of the pilot. It matters where many samples are requested, or an unlimited number.
const LONGEST_PILOT: u64 = 32;

/// Samples per pixel and round, on average. A pixel with little noise takes one, a noisy one up to 64.
const MEAN: f64 = 8.0;

/// Greatest expected ratio of relMSE, adaptive over even, at which uneven samples are taken. It is below 1 because the expectation is a little
/// too good for evenly distributed samples, whose relMSE falls faster than 1/n.
const WORTH: f64 = 0.93;

/// Radius of the neighbourhood from which the noise of a pixel is estimated (pixels).
const REACH: usize = 2;

/// Renders a pilot, discards its picture, and returns the allocation that its noise suggests, and the seconds it took. The allocation is even
/// where an uneven one would hardly lessen the error.
///
/// - `samples`: samples per pixel that the picture will have
pub fn pilot_allocation(
    scene: &Arc<dyn Scene>,
    integrator: &dyn Integrator,
    spec: &FilmSpec,
    settings: &Settings,
    samples: u64,
    observer: &dyn ErrorObserver,
) -> (Allocation, Duration) {
    let spec = spec.clone().without_layers();
    let fewest = u64::from(2 * settings.sampler.error_estimator().sequences());
    let samples = (samples / PILOT).clamp(fewest, LONGEST_PILOT.max(fewest)).next_power_of_two();
    let sampler = SamplerSpec { seed: mix(settings.sampler.seed ^ PILOT_SEED), ..settings.sampler };
    let mut film = MomentFilm::new(spec.clone());
    let mut render = Render::new(scene.clone(), integrator, &spec, &Settings { sampler, ..settings.clone() });
    render.advance(samples, &mut film, observer);
    let allocation = allocate(&film);
    let pays = relmse_ratio(&film, &allocation) <= WORTH;
    (if pays { allocation } else { Allocation::default() }, render.report().elapsed)
}

/// Returns the allocation that the noise of a film suggests.
pub fn allocate(film: &MomentFilm) -> Allocation {
    let size = film.spec().crop.size();
    let noise = PixelNoise::of(film, size.x as usize);
    let mut levels = vec![0; noise.pixels.len()];
    for color in [0, 1] {
        let own: Vec<usize> = (0..levels.len()).filter(|&i| noise.color(i) == color).collect();
        let Some(floor) = noise.floor(1 - color) else { return Allocation::default() };
        let worth: Vec<f64> = own.iter().map(|&i| noise.neighbors(i, floor)).collect();
        let scale = scale(&worth);
        own.iter().zip(&worth).for_each(|(&i, worth)| levels[i] = level(scale * worth));
    }
    Allocation::new(levels)
}

/// Expected relMSE with this allocation, over that of the same total number of samples with equally many in every pixel; NaN for a black
/// film.
fn relmse_ratio(film: &MomentFilm, allocation: &Allocation) -> f64 {
    let noise = PixelNoise::of(film, film.spec().crop.size().x as usize);
    let floors = [0, 1].map(|color| noise.floor(color));
    let contribution =
        |i: usize| floors[noise.color(i)].map_or(0.0, |floor| noise.pixels[i].iter().map(|(x, v)| v / (x * x + floor)).sum());
    let (mut even, mut adaptive) = (0.0, 0.0);
    for i in 0..noise.pixels.len() {
        let square: f64 = contribution(i);
        even += square;
        adaptive += square / allocation.samples(i, 1) as f64;
    }
    adaptive * allocation.mean() / even
}

/// Returns the exponent of the power of two that is nearest to a number of samples.
fn level(samples: f64) -> u8 {
    samples.log2().round().clamp(0.0, Allocation::MAX_LEVEL.into()) as u8
}

/// Returns the factor that turns these weights into numbers of samples whose average, after rounding to powers of two, is [`MEAN`].
fn scale(worth: &[f64]) -> f64 {
    let mean = |scale: f64| worth.iter().map(|worth| f64::from(1u32 << level(scale * worth))).sum::<f64>() / worth.len() as f64;
    // The average rises in steps from 1 to 64. Forty halvings end at one of the steps.
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

/// Noise of the pixels of a film. The pixels are divided into two colours like the squares of a chess board.
struct PixelNoise {
    width: usize,
    /// Mean and variance of a single sample, for red, green and blue.
    pixels: Vec<[(f64, f64); 3]>,
}

impl PixelNoise {
    fn of(film: &MomentFilm, width: usize) -> PixelNoise {
        let (block, set, samples) = (film.total(), film.sample_set(), film.samples());
        let single = |(mean, variance): (f64, f64)| (mean, variance * samples as f64);
        let noise = |pixel| estimate(block.error_estimator(), pixel, set.of_pixel(0)).map(single);
        PixelNoise { width, pixels: block.pixels().map(noise).collect() }
    }

    /// Colour of the square on which a pixel stands: 0 or 1.
    fn color(&self, i: usize) -> usize {
        (i % self.width + i / self.width) % 2
    }

    /// ε of the pixels of one colour; `None` if there are none or all of them are black.
    fn floor(&self, color: usize) -> Option<f64> {
        let values = (0..self.pixels.len()).filter(|&i| self.color(i) == color).flat_map(|i| self.pixels[i].map(|(x, _)| x));
        let (sum, count) = values.fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
        floor_at(sum / f64::from(count))
    }

    /// Relative standard deviation s = √(mean of v/(x² + ε)) of a sample of pixel i, estimated from the neighbours of the other colour.
    ///
    /// - `floor`: ε
    fn neighbors(&self, i: usize, floor: f64) -> f64 {
        let others = neighborhood(i, REACH, self.width, self.pixels.len()).filter(|&q| self.color(q) != self.color(i));
        let squares = others.flat_map(|q| self.pixels[q].map(|(x, v)| v / (x * x + floor)));
        let (sum, count) = squares.fold((0.0, 0), |(sum, count), s| (sum + s, count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }
}
