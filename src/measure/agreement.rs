//! Statistical tests of whether two images are estimates of the same picture.
//!
//! There are four tests, because each finds errors that the others miss:
//!
//! - pixel: does any pixel differ?             finds seams, the wrong edge of a shadow
//! - block: does any block of pixels differ?   finds a wrong material in a corner, a bias of some per cent
//! - global: does the whole image differ?      finds a bias of some per mille
//! - spread: does Σz² over the blocks follow χ²?   finds many small differences, and errors that are smaller than claimed
//!
//! Noise with heavy tails needs care: as long as the rare bright paths are missing, a mean is too dark and its error bar too small.
//! Therefore
//!
//! - a block has at least 8×8 pixels, and as many more as it needs for its noise to be that of fifty samples;
//! - the variance of a pixel counts as at least the mean variance of its block, and of its 8×8 neighbours;
//! - the darker side may be dark only because it lacks rare samples: its statistic is corrected for skewness (Hall);
//! - Σz² is formed of blocks so large that the skewness of a sum is small beside the random deviation of Σz²;
//! - where the noise of a picture is that of fewer than fifty samples in all ([`Agreement::heavy`]), the four tests permit no conclusion.
//!   Then the whole images are different only if a few samples more or less cannot explain it ([`Agreement::rare`]), and never the same.

mod pixel_group;
mod rare_samples;

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use self::pixel_group::{PixelGroup, add, samples, with_surroundings};
use super::error::EPSILON;
use super::{Mean, Verdict, Welch, critical_z, sidak};
use crate::film::{Channel, Image};
use crate::{Error, Fault, Result};

/// An image of independent samples, with the number of samples per pixel.
#[derive(Clone, Copy, Debug)]
pub struct SampledImage<'a> {
    /// Image with channels `R`, `G`, `B` and `StdErr.R`, `StdErr.G`, `StdErr.B`.
    pub image: &'a Image,
    /// Samples per pixel.
    pub samples: u64,
}

/// Verdicts of the four tests, over all colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Verdict of the test of single pixels.
    pub pixel: Verdict,
    /// Verdict of the test of blocks of pixels.
    pub block: Verdict,
    /// Verdict of the test of the whole image.
    pub global: Verdict,
    /// Verdict of the test of Σz² over the blocks.
    pub spread: Verdict,
    /// Verdict of the test of the whole image where a few samples hold all the noise.
    pub rare: Verdict,
    /// For each image, whether a few samples hold all its noise (relative to its light), or the image is black. More samples could
    /// change such an image in unknown ways.
    pub heavy: [bool; 2],
}

/// Conclusion from all tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// No difference was found.
    Same,
    /// The images are not estimates of the same picture.
    Different,
    /// A few samples hold all the noise of an image, and could explain the difference.
    Inconclusive,
}

impl Agreement {
    /// Returns whether all four tests accept.
    pub fn accepts(&self) -> bool {
        self.all().iter().all(|(_, verdict)| verdict.accepts())
    }

    /// The conclusion from all tests.
    pub fn conclusion(&self) -> Conclusion {
        match (self.heavy.contains(&true), self.accepts(), self.rare.accepts()) {
            (false, true, _) => Conclusion::Same,
            (false, false, _) | (true, _, false) => Conclusion::Different,
            (true, _, true) => Conclusion::Inconclusive,
        }
    }

    fn all(&self) -> [(&'static str, Verdict); 4] {
        [("pixel", self.pixel), ("block", self.block), ("global", self.global), ("spread", self.spread)]
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let parts = self.all().map(|(name, verdict)| format!("{name}: {verdict}"));
        f.write_str(&parts.join("; "))
    }
}

/// Edge of the smallest block (pixels).
const BLOCK: usize = 8;
/// Smallest number of samples that the noise of a block must come from. It is nearly one for each of the 8×8 pixels, as σ² is only
/// estimated.
const MIN_SAMPLES: f64 = 50.0;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Tests whether two images are estimates of the same picture.
///
/// The level `alpha` is shared among the four tests, the colours, and the pixels or blocks of each (Šidák).
///
/// # Errors
/// `Invalid` where the images differ in size, have no standard errors, or fewer than two samples.
///
/// Source: Šidák (1967), Welch (1947); the four questions: Subr and Arvo, *Statistical Hypothesis Testing
/// for Assessing Monte Carlo Estimators* (2007), widened. Tests: false alarms, bias, a local fault, too small errors.
pub fn agreement(a: SampledImage, b: SampledImage, alpha: f64) -> Result<Agreement> {
    let level = sidak(alpha, 4 * CHANNELS.len());
    let pairs: Vec<ChannelPair> = CHANNELS.into_iter().map(|channel| ChannelPair::new(a, b, channel)).collect::<Result<_>>()?;
    // Where it decides, this test is the only one.
    let rare = test_level(pairs.iter().map(ChannelPair::rare_p), sidak(alpha, CHANNELS.len()));
    let colors: Vec<[Verdict; 4]> = pairs.iter().map(|pair| pair.test(level)).collect();
    let heavy = [0, 1].map(|k| pairs.iter().any(|pair| pair.is_heavy(k)) || pairs.iter().all(|pair| pair.is_black(k)));
    let worst = |k: usize| {
        let all = colors.iter().map(|verdicts| verdicts[k]);
        let tests = all.clone().map(|v| v.tests).sum();
        let worst = all.fold(None, |worst: Option<Verdict>, v| worst.filter(|w| w.p / w.level <= v.p / v.level).or(Some(v)));
        Verdict { tests, ..worst.unwrap_or(Verdict { p: 1.0, level, tests }) }
    };
    Ok(Agreement { pixel: worst(0), block: worst(1), global: worst(2), spread: worst(3), rare, heavy })
}

/// Returns an image of p-values: for each pixel and colour, the probability that chance alone makes so large a difference. It is
/// near 0 where the images differ.
///
/// # Errors
/// Those of [`agreement`].
pub fn p_values(a: SampledImage, b: SampledImage) -> Result<Image> {
    let channel = |name: &str| -> Result<Channel> {
        let pair = ChannelPair::new(a, b, name)?;
        let p = |[a, b]: &[Mean; 2]| rounded(*a).welch(&rounded(*b)).p() as f32;
        Ok(Channel { name: name.into(), values: pair.pixels.iter().map(p).collect() })
    };
    Ok(Image { channels: CHANNELS.into_iter().map(channel).collect::<Result<_>>()?, ..a.image.clone() })
}

/// Returns the smallest relative difference between the whole images that [`agreement`] would detect with a probability of 90 %.
///
/// (z_α + z_90 %) √(Σ v₁ + v₂) / Σ m, for the colour in which it is smallest
///
/// # Errors
/// Those of [`agreement`].
pub fn smallest_bias(a: SampledImage, b: SampledImage, alpha: f64) -> Result<f64> {
    const Z_90: f64 = 1.281_551_565_5;
    let z = critical_z(alpha, 4 * CHANNELS.len()) + Z_90;
    let of = |name: &str| -> Result<f64> {
        let pair = ChannelPair::new(a, b, name)?;
        let [a, b] = [0, 1].map(|k| pair.pixels.iter().map(|pixel| &pixel[k]).fold(Mean::default(), add));
        Ok(z * (a.variance + b.variance).sqrt() / (0.5 * (a.value + b.value)).abs())
    };
    let all: Vec<f64> = CHANNELS.into_iter().map(of).collect::<Result<_>>()?;
    Ok(all.into_iter().filter(|bias| !bias.is_nan()).fold(f64::INFINITY, f64::min))
}

/// One colour channel of both images.
struct ChannelPair {
    width: usize,
    pixels: Vec<[Mean; 2]>,
}

impl ChannelPair {
    fn new(a: SampledImage, b: SampledImage, channel: &str) -> Result<ChannelPair> {
        if a.image.size != b.image.size {
            let text = format!("images of {} and {} pixels cannot be compared", a.image.size, b.image.size);
            return Err(Error::invalid(Fault::new(text)));
        }
        let (a, b) = (means(a, channel)?, means(b, channel)?);
        Ok(ChannelPair { width: a.0, pixels: a.1.into_iter().zip(b.1).map(|(a, b)| [a, b]).collect() })
    }

    /// Returns the verdicts of the pixel, block, global and spread tests.
    fn test(&self, level: f64) -> [Verdict; 4] {
        let blocks = self.blocks(MIN_SAMPLES);
        let pixels = blocks.iter().flat_map(|block| &block.pixels).map(MeanTest::pixel);
        let whole = PixelGroup::joined(self.blocks(0.0));
        // For a sum of n samples, E(z²) exceeds 1 by about 2/n. The mean of z² over N blocks has a standard deviation of √(2/N).
        // With n = 2.5 √N the excess is half of that deviation.
        let smallest = self.width.div_ceil(BLOCK) * self.height().div_ceil(BLOCK);
        let coarse = self.blocks(MIN_SAMPLES.max(2.5 * (smallest as f64).sqrt()));
        [
            test_all(pixels, level),
            test_all(blocks.iter().map(MeanTest::sum), level),
            test_all([MeanTest::sum(&whole)].into_iter(), level),
            spread(&coarse, level),
        ]
    }

    /// Returns the p-value of the test of whole images whose noise comes from a few samples.
    fn rare_p(&self) -> f64 {
        // A black picture says nothing: light may be missing that no sample has met.
        if self.is_black(0) || self.is_black(1) {
            return 1.0;
        }
        let [a, b] = PixelGroup::joined(self.blocks(0.0)).sums;
        rare_samples::p([&a, &b])
    }

    /// Returns whether the relative error √(Σ v/(s² + ε)) comes from fewer than [`MIN_SAMPLES`] samples. s is the light of the
    /// surroundings; with the light of the pixel itself, an outlier would hide.
    fn is_heavy(&self, side: usize) -> bool {
        let mean = self.pixels.iter().map(|pixel| pixel[side].value).sum::<f64>() / self.pixels.len() as f64;
        let floor = EPSILON * mean * mean;
        let tiles = (0..self.height()).step_by(BLOCK).flat_map(|y| (0..self.width).step_by(BLOCK).map(move |x| (x, y)));
        let noise = tiles.flat_map(|(x, y)| with_surroundings(self.tile(x, y).map(|pixel| pixel[side])));
        let (sum, fourth) = noise.fold((0.0, 0.0), |(sum, fourth), (mean, around)| {
            let share = mean.variance / (around * around + floor);
            (sum + share, fourth + share * share / samples(mean, around))
        });
        sum * sum < MIN_SAMPLES * fourth
    }

    fn is_black(&self, side: usize) -> bool {
        self.pixels.iter().all(|pixel| pixel[side].value == 0.0)
    }

    /// Pixels of a square of 8×8; fewer at the right and lower edges.
    fn tile(&self, x: usize, y: usize) -> impl Iterator<Item = [Mean; 2]> {
        let rows = y..(y + BLOCK).min(self.height());
        rows.flat_map(move |row| &self.pixels[row * self.width + x..row * self.width + (x + BLOCK).min(self.width)]).copied()
    }

    fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }

    /// Divides the picture into squares of 8×8 pixels, smaller at the right and lower edges. Squares are larger, by a power of two,
    /// where the noise of one of the pictures does not come from `min_samples` samples; the largest is the whole picture.
    fn blocks(&self, min_samples: f64) -> Vec<PixelGroup> {
        let edge = self.width.max(self.height()).div_ceil(BLOCK).next_power_of_two() * BLOCK;
        self.split(0, 0, edge, min_samples)
    }

    /// Divides a square into four if each part has enough samples, and returns the undivided square otherwise.
    fn split(&self, x: usize, y: usize, edge: usize, min_samples: f64) -> Vec<PixelGroup> {
        if x >= self.width || y >= self.height() {
            return vec![];
        }
        if edge == BLOCK {
            return vec![PixelGroup::of(self.tile(x, y).collect())];
        }
        let half = edge / 2;
        let corners = [(0, 0), (half, 0), (0, half), (half, half)];
        let parts: Vec<PixelGroup> = corners.iter().flat_map(|(i, j)| self.split(x + i, y + j, half, min_samples)).collect();
        match parts.iter().all(|part| part.has_samples(min_samples)) {
            true => parts,
            false => vec![PixelGroup::joined(parts)],
        }
    }
}

/// Input of one test: two means, and the third cumulants of their noise.
struct MeanTest {
    means: [Mean; 2],
    third: [f64; 2],
}

impl MeanTest {
    /// Input for a single pixel. Its skewness is unknown and counts as 0.
    fn pixel(means: &[Mean; 2]) -> MeanTest {
        MeanTest { means: *means, third: [0.0; 2] }
    }

    fn sum(block: &PixelGroup) -> MeanTest {
        MeanTest { means: block.sums.map(|sum| sum.mean), third: block.sums.map(|sum| sum.third) }
    }

    /// Returns the p-value of Welch's test, with the statistic corrected for skewness: the darker side may lack its brightest
    /// samples.
    ///
    /// t' = t + γ t²/3 + γ² t³/27 + γ/6,    γ = κ₃ / (v₁ + v₂)^1.5 of the darker side, t below 0
    ///
    /// Source: Hall, *On the Removal of Skewness by Transformation* (1992).
    fn p(&self) -> f64 {
        let [a, b] = self.means.map(rounded);
        let welch = a.welch(&b);
        let darker = usize::from(welch.t > 0.0);
        let gamma = self.third[darker] / (a.variance + b.variance).powf(1.5);
        let t = -welch.t.abs();
        let back = t + gamma * t * t / 3.0 + gamma * gamma * t.powi(3) / 27.0 + gamma / 6.0;
        // The skewness is only a bound, so it must never make a difference more significant.
        Welch { t: if back.is_finite() { back.clamp(t, 0.0) } else { t }, ..welch }.p()
    }
}

/// Returns the width of the image, and the estimate of each pixel for one channel.
fn means(render: SampledImage, channel: &str) -> Result<(usize, Vec<Mean>)> {
    let find =
        |name: &str| render.image.channel(name).ok_or_else(|| Error::invalid(Fault::new(format!("the image has no channel {name}"))));
    let (values, errors) = (find(channel)?, find(&format!("StdErr.{channel}"))?);
    if render.samples < 2 {
        return Err(Error::invalid(Fault::new("a standard error takes at least two samples per pixel")));
    }
    let mean =
        |(&value, &error): (&f32, &f32)| Mean { value: value as f64, variance: (error as f64).powi(2), samples: render.samples as f64 };
    Ok((render.image.size.x as usize, values.iter().zip(errors).map(mean).collect()))
}

/// Variance (2⁻²⁰·value)² that rounding may add: of the f32 images, and of the arithmetic of light transport.
fn rounding(mean: &Mean) -> f64 {
    (mean.value * 2f64.powi(-20)).powi(2)
}

fn rounded(mean: Mean) -> Mean {
    Mean { variance: mean.variance + rounding(&mean), ..mean }
}

/// Tests each input, and returns the smallest p-value with the number of tests.
fn test_all(tested: impl Iterator<Item = MeanTest>, level: f64) -> Verdict {
    let verdict = test_level(tested.map(|one| one.p()), 0.0);
    Verdict { level: sidak(level, verdict.tests), ..verdict }
}

/// Smallest of some p-values, of which each has this level.
fn test_level(all: impl Iterator<Item = f64>, level: f64) -> Verdict {
    let (mut p, mut tests) = (1.0f64, 0);
    for one in all {
        // A NaN counts as disagreement.
        p = p.min(Some(one).filter(|p| !p.is_nan()).unwrap_or(0.0));
        tests += 1;
    }
    Verdict { p, level, tests }
}

/// Tests whether Σz² of n blocks follows χ² with n degrees of freedom. It is too large where the images differ, and too small where
/// errors are overstated or the images share random numbers.
///
/// Blocks whose noise is below that of rounding are not counted.
fn spread(blocks: &[PixelGroup], level: f64) -> Verdict {
    let noisy =
        blocks.iter().map(|block| block.sums.map(|sum| sum.mean)).filter(|[a, b]| a.variance + b.variance > rounding(a) + rounding(b));
    let z2: Vec<f64> = noisy.map(|[a, b]| a.welch(&b).t.powi(2)).collect();
    let lower = ChiSquared::new(z2.len() as f64).map(|chi| chi.cdf(z2.iter().sum()));
    let upper = ChiSquared::new(z2.len() as f64).map(|chi| chi.sf(z2.iter().sum()));
    let p = match (lower, upper) {
        _ if z2.is_empty() => 1.0,
        (Ok(lower), Ok(upper)) => (2.0 * lower.min(upper)).min(1.0),
        _ => 0.0,
    };
    Verdict { p: if p.is_nan() { 0.0 } else { p }, level, tests: 1 }
}

#[cfg(test)]
mod tests;
