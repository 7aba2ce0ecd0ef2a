//! How far a picture is from the truth, told by its own error bars.

use arrayvec::ArrayVec;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

use super::around::around;
use crate::film::block::{Estimate, estimate, pull};
use crate::film::{Block, Film, Image, MomentFilm};

/// The estimated relative error of a picture, and how sure the estimate is.
///
/// ```text
/// error = √relMSE,   relMSE = 1/3P Σ (x − r)² / (r² + ε),   ε = 0.01 · mean(r)²
/// ```
///
/// over P pixels x and three colours, with r the picture that infinitely many samples would give. Scaling the
/// light scales x, r and √ε alike and leaves the error as it is.
///
/// Of r nothing is known but x and its variance v, so that each (x − r)² is replaced by v, and the denominator
/// is corrected for standing at x instead of r. What is estimated is the error of this very picture, which varies
/// from seed to seed as the noise does.
///
/// Tests: intervals hold the true error as often as they say; scale invariance; heavy tails are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeError {
    /// √relMSE
    pub value: f64,
    /// Of ln(value): its standard deviation.
    pub spread: f64,
    /// As many pixels of equal noise would tell as much.
    pub effective_pixels: f64,
}

/// ε over the square of the picture's mean.
pub const EPSILON: f64 = 0.01;

/// Fewer than so many equally noisy pixels say nothing about the noise of a picture.
///
/// At 30 the relative standard deviation of relMSE is 21 to 26 %, just where an interval about a logarithm
/// still means something.
const FEWEST: f64 = 30.0;

impl RelativeError {
    /// Of the picture so far. `None` where its samples tell no error, and for a black picture.
    pub fn of(film: &MomentFilm) -> Option<RelativeError> {
        let (block, freedom) = (film.total(), film.freedom());
        let smoothed = Smoothed::new(&block, |i| film.samples_of(i), film.spec().crop.size().x as usize);
        let floor = smoothed.floor().filter(|_| freedom > 0.0)?;
        let (mut sum, mut square) = (0.0, 0.0);
        for share in smoothed.shares(floor) {
            sum += share;
            square += share * share;
        }
        let count = smoothed.pixels.len() as f64;
        // Both the estimate of v, of relative variance 2/ν, and the noise itself, of 2, the colours moving together:
        // Σ c² (2 + 2/ν), where the squares of the estimates are (1 + 2/ν) times too large.
        let effective = if square > 0.0 { sum * sum / square } else { count };
        let chance = (2.0 * (freedom + 1.0) / (freedom + 2.0) / effective).sqrt();
        // What the denominators were corrected by is right to first order: anything from nothing to twice as much may be
        // due, all alike as far as is known. The standard deviation of ±c is c/√3.
        let corrected = if sum > 0.0 { (sum / smoothed.uncorrected(floor)).ln() / 3f64.sqrt() } else { 0.0 };
        Some(RelativeError { value: (sum / count).sqrt(), spread: 0.5 * chance.hypot(corrected), effective_pixels: effective })
    }

    /// Holds the error with this probability.
    pub fn interval(&self, confidence: f64) -> [f64; 2] {
        let reach = quantile(0.5 + 0.5 * confidence) * self.spread;
        [self.value * (-reach).exp(), self.value * reach.exp()]
    }

    /// The error lies below with this probability.
    pub fn below(&self, confidence: f64) -> f64 {
        self.value * (quantile(confidence) * self.spread).exp()
    }

    /// Whether enough pixels share the noise: where a few bright ones make it all, the next one changes it all.
    pub fn is_established(&self) -> bool {
        self.effective_pixels >= FEWEST
    }
}

/// Whether enough pixels of a picture from a file share its noise, as its channels `StdErr` tell; yes for a picture without noise.
pub fn is_established(image: &Image) -> bool {
    let (Some(floor), Some(errors)) = (floor(image), errors(image)) else { return false };
    let share =
        |(i, x): (usize, [f32; 3])| -> f64 { (0..3).map(|c| f64::from(errors[c][i]).powi(2) / (f64::from(x[c]).powi(2) + floor)).sum() };
    let add = |(sum, square): (f64, f64), share: f64| (sum + share, square + share * share);
    let (sum, square) = image.pixels().enumerate().map(share).fold((0.0, 0.0), add);
    sum * sum >= FEWEST * square
}

/// ε of a reference, above 0.
pub fn floor(image: &Image) -> Option<f64> {
    let mean = image.pixels().flatten().map(f64::from).sum::<f64>() / (3.0 * image.pixels().count() as f64);
    floor_at(mean)
}

/// ε of a picture of this mean, above 0.
pub(super) fn floor_at(mean: f64) -> Option<f64> {
    Some(EPSILON * mean * mean).filter(|floor| floor.is_normal())
}

/// The standard errors of the colours.
pub fn errors(image: &Image) -> Option<[&[f32]; 3]> {
    let channels: Vec<&[f32]> = ["StdErr.R", "StdErr.G", "StdErr.B"].iter().filter_map(|name| image.channel(name)).collect();
    channels.try_into().ok()
}

/// A picture as sure of itself as its neighbourhoods allow: the denominators of relMSE.
///
/// In the place of r stands the mean of the pixels around that differ from their median by no more than noise does. The
/// pixel alone would not do: a bright sample makes it bright as well as uncertain, and would excuse itself.
struct Smoothed {
    width: usize,
    /// Value and variance of each colour.
    pixels: Vec<Estimate>,
    /// The same of their mean.
    gray: Vec<(f64, f64)>,
    /// κ₃/v of their mean: by how much a brighter pixel looks noisier than it is.
    pull: Vec<f64>,
}

/// Neighbours this far away count (pixels).
const REACH: usize = 1;
const AROUND: usize = (2 * REACH + 1) * (2 * REACH + 1);

impl Smoothed {
    /// - `samples`: of pixel i
    fn new(block: &Block, samples: impl Fn(usize) -> u64, width: usize) -> Smoothed {
        let pixels: Vec<Estimate> = block.pixels().enumerate().map(|(i, pixel)| estimate(block.spread(), pixel, samples(i))).collect();
        let pull = block.pixels().enumerate().map(|(i, pixel)| pull(block.spread(), pixel, samples(i))).collect();
        let gray = pixels.iter().map(gray).collect();
        Smoothed { width, pixels, gray, pull }
    }

    /// ε, above 0.
    fn floor(&self) -> Option<f64> {
        let mean = self.gray.iter().map(|(x, _)| x).sum::<f64>() / self.gray.len() as f64;
        floor_at(mean)
    }

    /// The pixels within reach of pixel i.
    fn around(&self, i: usize) -> impl Iterator<Item = usize> {
        around(i, REACH, self.width, self.pixels.len()).filter(move |q| *q != i)
    }

    /// What each pixel adds to relMSE, the mean of its colours.
    fn shares(&self, floor: f64) -> Vec<f64> {
        let share = |i: usize| {
            let typical = self.typical(i);
            let others: f64 = self.around(i).map(|q| self.likeness(q, typical)).sum();
            // Where the pixel is of another kind than most around it, it stands for itself.
            let own = if others > 0.0 { 1.0 - self.likeness(i, typical) } else { 1.0 };
            let weight = |q: usize| (1.0 - own) * self.likeness(q, typical) / others;
            // A colour is as skewed as the mean of the colours, in the measure of its own noise.
            let noise = self.gray[i].1.sqrt();
            let pull = if noise > 0.0 { self.pull[i] / noise } else { 0.0 };
            let color = |c: usize| {
                let (x, v) = self.pixels[i][c];
                let mean = (own * x, own * own * v);
                let mean = self.around(i).filter(|_| own < 1.0).fold(mean, |(sum, spread), q| {
                    let (weight, (x, v)) = (weight(q), self.pixels[q][c]);
                    (sum + weight * x, spread + weight * weight * v)
                });
                share(v, mean, own * pull * v.sqrt(), floor)
            };
            (color(0) + color(1) + color(2)) / 3.0
        };
        (0..self.pixels.len()).into_par_iter().map(share).collect()
    }

    /// relMSE · P, had each pixel been its own reference.
    fn uncorrected(&self, floor: f64) -> f64 {
        self.pixels.iter().flatten().map(|(x, v)| v / (3.0 * (x * x + floor))).sum()
    }

    /// The medians of value and variance around a pixel: neither a bright sample nor an edge moves them far.
    fn typical(&self, i: usize) -> (f64, f64) {
        let median = |f: fn(&(f64, f64)) -> f64| {
            let mut values: ArrayVec<f64, AROUND> = self.around(i).chain([i]).map(|q| f(&self.gray[q])).collect();
            let middle = values.len() / 2;
            *values.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        (median(|gray| gray.0), median(|gray| gray.1))
    }

    /// 1 where a pixel differs from what is typical by no more than noise does, falling to 0.
    fn likeness(&self, q: usize, (x, v): (f64, f64)) -> f64 {
        let (y, w) = self.gray[q];
        let (distance, noise) = ((x - y).powi(2), v + w);
        if distance <= noise { 1.0 } else { (0.5 * (1.0 - distance / noise)).exp() }
    }
}

/// Value and variance of the mean of the colours. They move together: their errors add, not their variances.
fn gray(pixel: &Estimate) -> (f64, f64) {
    let mean = |f: fn(&(f64, f64)) -> f64| pixel.iter().map(f).sum::<f64>() / 3.0;
    (mean(|c| c.0), mean(|c| c.1.sqrt()).powi(2))
}

/// What one colour of a pixel adds to relMSE: v/(r² + ε), of which x = r + noise of variance w is known.
///
/// The mean of v g(x), with g(x) = 1/(x² + ε), is not v g(r): g is curved, and where noise is skewed, x is large
/// together with v.
///
/// ```text
/// E[v g(x)] = v g(r) (1 + ½ w g″/g + κ g′/g),   g″/g = (6x² − 2ε)/(x² + ε)²,  g′/g = −2x/(x² + ε)
/// ```
///
/// - `pull`: κ, the covariance of v and x over v
fn share(v: f64, (x, w): (f64, f64), pull: f64, floor: f64) -> f64 {
    let below = x * x + floor;
    let correction = 0.5 * w * (6.0 * x * x - 2.0 * floor) / (below * below) - 2.0 * x * pull / below;
    // First order is as far as this goes; it must not reach a factor of 0 or ∞.
    let factor = if correction > 0.0 { 1.0 / (1.0 + correction) } else { 1.0 - correction.max(-1.0) };
    v / below * factor
}

fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}
