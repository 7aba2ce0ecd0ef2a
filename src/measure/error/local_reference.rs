//! Values of the neighbourhood of each pixel, which serve as references for its error.

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::contribution::{Contribution, LocalReference, PixelEstimate};
use super::epsilon::floor_at;
use crate::film::neighborhood::neighborhood;
use crate::film::pixel_sums::{Estimate, Skew, estimate};
use crate::film::{Film, MomentFilm};

/// Estimates of every pixel of a film, with access to those of its neighbours.
///
/// The local reference of a pixel is the mean of the neighbours that differ from their median by no more than noise explains. The
/// value of the pixel itself would not do: one bright sample makes it bright as well as noisy.
pub(super) struct PixelStatistics {
    width: usize,
    /// ν, the degrees of freedom of the variances.
    pub freedom: f64,
    /// ε of the relative error.
    pub floor: f64,
    /// Value and variance of each colour, per pixel.
    pixels: Vec<Estimate>,
    /// Value and variance of the mean of the colours, per pixel.
    gray: Vec<Gray>,
    /// κ₃/v of the mean of the colours, per pixel.
    skewness_ratio: Vec<f64>,
}

#[derive(Clone, Copy)]
struct Gray {
    value: f64,
    variance: f64,
}

/// Radius of the neighbourhood (pixels).
const REACH: usize = 1;
const AROUND: usize = (2 * REACH + 1) * (2 * REACH + 1);

impl PixelStatistics {
    /// Statistics of a film; `None` if its samples tell no error, or it is black.
    pub fn new(film: &MomentFilm, width: usize) -> Option<PixelStatistics> {
        let (block, freedom) = (film.total(), film.freedom());
        let set = film.sample_set();
        let samples = |(i, pixel)| (pixel, set.of_pixel(film.spec().allocation.level(i)));
        let pixels: Vec<Estimate> =
            block.pixels().enumerate().map(samples).map(|(pixel, samples)| estimate(block.error_estimator(), pixel, samples)).collect();
        let skews: Vec<Skew> = block
            .pixels()
            .enumerate()
            .map(samples)
            .map(|(pixel, samples)| Skew::of(block.error_estimator(), pixel, samples.count()))
            .collect();
        let gray: Vec<Gray> = pixels.iter().map(Gray::of).collect();
        let mean = gray.iter().map(|gray| gray.value).sum::<f64>() / gray.len() as f64;
        let floor = floor_at(mean).filter(|_| freedom > 0.0)?;
        let qmc_stddev_ratio = qmc_stddev_ratio(&gray, &skews, floor);
        let skewness_ratio = skews.iter().map(|skew| qmc_stddev_ratio * skew.skewness_ratio).collect();
        Some(PixelStatistics { width, freedom, floor, pixels, gray, skewness_ratio })
    }

    /// Contribution of each pixel to relMSE, averaged over its colours, with the index of the pixel.
    pub fn contributions(&self) -> Vec<(usize, Contribution)> {
        (0..self.pixels.len()).into_par_iter().map(|i| (i, self.contribution(i))).collect()
    }

    /// Contribution of a pixel without any correction: it is divided by its own value.
    pub fn uncorrected(&self, i: usize) -> f64 {
        self.pixels[i].iter().map(|(x, v)| v / (3.0 * (x * x + self.floor))).sum()
    }

    fn contribution(&self, i: usize) -> Contribution {
        let median = self.median(i);
        // Pushed one by one, because the compiler does not always inline `collect`.
        let mut others: ArrayVec<(usize, f64), AROUND> = ArrayVec::new();
        self.neighbors(i).for_each(|q| others.push((q, self.similarity(q, median))));
        let all: f64 = others.iter().map(|(_, similarity)| similarity).sum();
        // A pixel that differs from most of its neighbours is its own reference.
        let own = if all > 0.0 { 1.0 - self.similarity(i, median) } else { 1.0 };
        let noise = self.gray[i].variance.sqrt();
        let color = |c: usize| {
            let (x, v) = self.pixels[i][c];
            // The square of v overestimates σ⁴ by (ν + 2)/ν.
            let alone = LocalReference { value: own * x, variance: own * v * self.freedom / (self.freedom + 2.0) };
            let local = others.iter().filter(|_| own < 1.0).fold(alone, |local, (q, similarity)| {
                let (weight, (x, v)) = ((1.0 - own) * similarity / all, self.pixels[*q][c]);
                LocalReference { value: local.value + weight * x, variance: local.variance + weight * v }
            });
            // A colour is taken to be as skewed as the mean of the colours, in units of its own noise.
            let skewness_ratio = if noise > 0.0 { self.skewness_ratio[i] * v.sqrt() / noise } else { 0.0 };
            Contribution::new(&PixelEstimate { value: x, variance: v, skewness_ratio, freedom: self.freedom }, &local, self.floor)
        };
        Contribution::mean([color(0), color(1), color(2)])
    }

    /// The neighbours of pixel i, without i.
    fn neighbors(&self, i: usize) -> impl Iterator<Item = usize> {
        neighborhood(i, REACH, self.width, self.pixels.len()).filter(move |q| *q != i)
    }

    /// Medians of value and variance around a pixel. A bright sample or an edge hardly changes them.
    fn median(&self, i: usize) -> Gray {
        let median_of = |f: fn(&Gray) -> f64| {
            let mut values: ArrayVec<f64, AROUND> = self.neighbors(i).chain([i]).map(|q| f(&self.gray[q])).collect();
            let middle = values.len() / 2;
            *values.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        Gray { value: median_of(|gray| gray.value), variance: median_of(|gray| gray.variance) }
    }

    /// Weight of a pixel: 1 where it differs from the median by no more than noise, falling towards 0 beyond.
    fn similarity(&self, q: usize, median: Gray) -> f64 {
        let (distance, noise) = ((self.gray[q].value - median.value).powi(2), self.gray[q].variance + median.variance);
        if distance <= noise { 1.0 } else { (0.5 * (1.0 - distance / noise)).exp() }
    }
}

impl Gray {
    /// Mean of the colours. Colours move together, so their errors add, not their variances.
    fn of(pixel: &Estimate) -> Gray {
        let mean = |f: fn(&(f64, f64)) -> f64| pixel.iter().map(f).sum::<f64>() / 3.0;
        Gray { value: mean(|c| c.0), variance: mean(|c| c.1.sqrt()).powi(2) }
    }
}

/// Ratio of the standard deviation of the picture's noise to that of independent samples, over the whole picture. Scrambled
/// low-discrepancy points make it less than 1.
///
/// The noise of such points is taken to have the same skewness as that of independent samples, so κ₃/v shrinks by this ratio.
fn qmc_stddev_ratio(gray: &[Gray], skews: &[Skew], floor: f64) -> f64 {
    let relative = |variance: f64, value: f64| variance / (value * value + floor);
    let found: f64 = gray.iter().map(|gray| relative(gray.variance, gray.value)).sum();
    let independent: f64 = gray.iter().zip(skews).map(|(gray, skew)| relative(skew.variance, gray.value)).sum();
    if independent > found { (found / independent).sqrt() } else { 1.0 }
}
