//! How far a picture is from the truth, told by its own error bars.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::film::Image;

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
    /// From the channels `R`, `G`, `B` and `StdErr.R`, `StdErr.G`, `StdErr.B`. `None` without them, and for a black picture.
    ///
    /// - `freedom`: ν of the standard errors
    pub fn of(image: &Image, freedom: f64) -> Option<RelativeError> {
        let floor = floor(image).filter(|_| freedom > 0.0)?;
        let smoothed = Smoothed::of(image)?;
        let shares = smoothed.shares(floor);
        let (count, sum, square) = shares.fold((0.0, 0.0, 0.0), |(n, s, q), share| (n + 1.0, s + share, q + share * share));
        // Both the estimate of v, of relative variance 2/ν, and the noise itself, of 2, the colours moving together:
        // Σ c² (2 + 2/ν), where the squares of the estimates are (1 + 2/ν) times too large.
        let effective = if square > 0.0 { sum * sum / square } else { count };
        let variance = 2.0 * (freedom + 1.0) / (freedom + 2.0) / effective;
        Some(RelativeError { value: (sum / count).sqrt(), spread: 0.5 * variance.sqrt(), effective_pixels: effective })
    }

    /// √relMSE of a picture, measured: its distance from a reference, less what the reference's own standard errors add to it.
    ///
    /// relMSE = 1/3P Σ ((x − r)² − v_r) / (r² + ε)
    ///
    /// 0 where the picture is closer to the reference than that is to the truth. `None` for different sizes or a black reference.
    pub fn measured(image: &Image, reference: &Image) -> Option<f64> {
        let floor = floor(reference)?;
        let errors = errors(reference);
        let at = |i: usize, c: usize| errors.map_or(0.0, |channels| f64::from(channels[c][i]).powi(2));
        let pixel = |(i, (x, r)): (usize, ([f32; 3], [f32; 3]))| -> f64 {
            let color = |c: usize| {
                let (x, r) = (f64::from(x[c]), f64::from(r[c]));
                ((x - r).powi(2) - at(i, c)) / (r * r + floor)
            };
            color(0) + color(1) + color(2)
        };
        let sum: f64 = image.pixels().zip(reference.pixels()).enumerate().map(pixel).sum();
        let count = 3.0 * reference.pixels().count() as f64;
        (image.size == reference.size).then(|| (sum / count).max(0.0).sqrt())
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

/// ε, above 0.
fn floor(image: &Image) -> Option<f64> {
    let mean = image.pixels().flatten().map(f64::from).sum::<f64>() / (3.0 * image.pixels().count() as f64);
    Some(EPSILON * mean * mean).filter(|floor| floor.is_normal())
}

fn errors(image: &Image) -> Option<[&[f32]; 3]> {
    let channels: Vec<&[f32]> = ["StdErr.R", "StdErr.G", "StdErr.B"].iter().filter_map(|name| image.channel(name)).collect();
    channels.try_into().ok()
}

/// A picture as sure of itself as its neighbourhoods allow: the denominators of relMSE.
///
/// In the place of r stands the mean of the pixels around that differ by no more than noise does. The pixel alone
/// would not do: a bright sample makes it bright as well as uncertain, and would excuse itself.
///
/// Source of the weights: Rousselle, Knaus, Zwicker, *Adaptive Rendering with Non-Local Means Filtering* (2012).
struct Smoothed {
    width: usize,
    /// Value and variance of each colour.
    pixels: Vec<[(f64, f64); 3]>,
    /// The same of their mean, the variance as it is around the pixel.
    gray: Vec<(f64, f64)>,
}

/// Neighbours this far away count (pixels).
const REACH: usize = 2;

impl Smoothed {
    fn of(image: &Image) -> Option<Smoothed> {
        let [red, green, blue] = errors(image)?;
        let variance = |error: f32| f64::from(error).powi(2);
        let errors = red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| [r, g, b]);
        let pixels: Vec<[(f64, f64); 3]> =
            image.pixels().zip(errors).map(|(x, e)| std::array::from_fn(|c| (f64::from(x[c]), variance(e[c])))).collect();
        let mut smoothed = Smoothed { width: image.size.x as usize, pixels, gray: vec![] };
        // The colours of a sample move together: their errors add, not their variances.
        let gray = |pixel: &[(f64, f64); 3]| {
            let mean = |f: fn(&(f64, f64)) -> f64| pixel.iter().map(f).sum::<f64>() / 3.0;
            (mean(|c| c.0), mean(|c| c.1.sqrt()).powi(2))
        };
        let each: Vec<(f64, f64)> = smoothed.pixels.iter().map(gray).collect();
        let around = |i: usize| {
            let (sum, count) = smoothed.around(i, 1).fold((0.0, 0.0), |(sum, count), q| (sum + each[q].1, count + 1.0));
            (each[i].0, sum / count)
        };
        smoothed.gray = (0..each.len()).map(around).collect();
        Some(smoothed)
    }

    /// The pixels within `reach` of pixel i, and itself.
    fn around(&self, i: usize, reach: usize) -> impl Iterator<Item = usize> {
        let (width, height) = (self.width, self.pixels.len() / self.width.max(1));
        let (x, y) = (i % width, i / width);
        let span = move |at: usize, end: usize| at.saturating_sub(reach)..(at + reach + 1).min(end);
        span(y, height).flat_map(move |y| span(x, width).map(move |x| y * width + x))
    }

    /// What each pixel adds to relMSE, the mean of its colours.
    fn shares(&self, floor: f64) -> impl Iterator<Item = f64> {
        (0..self.pixels.len()).map(move |i| {
            let weights: f64 = self.around(i, REACH).map(|q| self.weight(i, q)).sum();
            let color = |c: usize| {
                let sum = self.around(i, REACH).fold((0.0, 0.0), |(x, v), q| {
                    let (weight, (value, variance)) = (self.weight(i, q) / weights, self.pixels[q][c]);
                    (x + weight * value, v + weight * weight * variance)
                });
                share(self.pixels[i][c].1, sum, floor)
            };
            (color(0) + color(1) + color(2)) / 3.0
        })
    }

    /// 1 where two pixels differ by no more than their noise, falling to 0.
    fn weight(&self, p: usize, q: usize) -> f64 {
        let ((x, v), (y, w)) = (self.gray[p], self.gray[q]);
        let noise = v + w;
        match (x - y).powi(2) {
            0.0 => 1.0,
            distance if distance <= noise => 1.0,
            distance => (0.5 * (1.0 - distance / noise)).exp(),
        }
    }
}

/// What one colour of a pixel adds to relMSE: v/(r² + ε), of which x = r + noise of variance w is known.
///
/// The mean of g(x) = 1/(x² + ε) is g(r) + ½ g″ w and not g(r):
///
/// ```text
/// share = v g(x) / (1 + ½ w g″/g),   g″/g = (6x² − 2ε) / (x² + ε)²
/// ```
fn share(v: f64, (x, w): (f64, f64), floor: f64) -> f64 {
    let below = x * x + floor;
    let correction = 0.5 * w * (6.0 * x * x - 2.0 * floor) / (below * below);
    // First order is as far as this goes; a negative correction must not reach −1.
    let factor = if correction > 0.0 { 1.0 / (1.0 + correction) } else { 1.0 - correction.max(-1.0) };
    v / below * factor
}

fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}
