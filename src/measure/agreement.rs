//! Do two images show the same picture?
//!
//! Four questions, because each finds what the others miss:
//!
//! - pixel: is any pixel off?           seams, a wrong shadow's edge
//! - block: is any block off?           a wrong material in a corner; some per cent of bias
//! - global: is the whole off?          some per mille of bias
//! - spread: Σz² over blocks ~ χ²       many small differences; and errors smaller than claimed
//!
//! Heavy tails: where the rare bright paths have not come yet, a mean is too dark and looks surer than it is. So
//!
//! - a block has at least 8×8 pixels, and as many more as it takes for its noise to be that of fifty samples;
//! - a pixel's variance counts as at least the mean of its block, and of its 8×8 neighbours;
//! - the side that is darker may be so by what it lacks: its statistic is taken back by that (Hall);
//! - Σz² is formed of blocks so large that the skewness of a sum is lost in what chance does to Σz²;
//! - a picture whose noise is that of fewer than fifty samples in all concludes nothing ([`Agreement::heavy`]).

mod block;

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use self::block::{Block, add, samples, with_surroundings};
use super::relative::EPSILON;
use super::{Mean, Verdict, Welch, critical_z, sidak};
use crate::film::{Channel, Image};
use crate::{Error, Fault, Result};

/// An image of independent samples, and how many there are per pixel.
#[derive(Clone, Copy, Debug)]
pub struct Render<'a> {
    /// With channels `R`, `G`, `B` and `StdErr.R`, `StdErr.G`, `StdErr.B`.
    pub image: &'a Image,
    pub samples: u64,
}

/// What the four tests say, over all colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    pub pixel: Verdict,
    pub block: Verdict,
    pub global: Verdict,
    pub spread: Verdict,
    /// Of each image, whether a few samples hold all its noise (relative to its light), or it shows nothing at all: what more of them
    /// would bring is unknown, and so the tests conclude nothing.
    pub heavy: [bool; 2],
}

impl Agreement {
    pub fn accepts(&self) -> bool {
        self.all().iter().all(|(_, verdict)| verdict.accepts())
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
/// How many samples make a block's noise, at least: nearly one for each of its 8×8 pixels, as σ² is only estimated.
const SHARED: f64 = 50.0;
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
pub fn agreement(a: Render, b: Render, alpha: f64) -> Result<Agreement> {
    let level = sidak(alpha, 4 * CHANNELS.len());
    let pairs: Vec<Pair> = CHANNELS.into_iter().map(|channel| Pair::new(a, b, channel)).collect::<Result<_>>()?;
    let colors: Vec<[Verdict; 4]> = pairs.iter().map(|pair| pair.test(level)).collect();
    let heavy = [0, 1].map(|k| pairs.iter().any(|pair| pair.is_heavy(k)) || pairs.iter().all(|pair| pair.is_black(k)));
    let worst = |k: usize| {
        let all = colors.iter().map(|verdicts| verdicts[k]);
        let tests = all.clone().map(|v| v.tests).sum();
        let worst = all.fold(None, |worst: Option<Verdict>, v| worst.filter(|w| w.p / w.level <= v.p / v.level).or(Some(v)));
        Verdict { tests, ..worst.unwrap_or(Verdict { p: 1.0, level, tests }) }
    };
    Ok(Agreement { pixel: worst(0), block: worst(1), global: worst(2), spread: worst(3), heavy })
}

/// The probability of so large a difference by chance, of each pixel and colour: near 0 where the images differ.
///
/// # Errors
/// Those of [`agreement`].
pub fn p_values(a: Render, b: Render) -> Result<Image> {
    let channel = |name: &str| -> Result<Channel> {
        let pair = Pair::new(a, b, name)?;
        let p = |[a, b]: &[Mean; 2]| rounded(*a).welch(&rounded(*b)).p() as f32;
        Ok(Channel { name: name.into(), values: pair.pixels.iter().map(p).collect() })
    };
    Ok(Image { channels: CHANNELS.into_iter().map(channel).collect::<Result<_>>()?, ..a.image.clone() })
}

/// The least relative difference of the whole images that [`agreement`] would refuse with a probability of 90 %.
///
/// (z_α + z_90 %) √(Σ v₁ + v₂) / Σ m, of the colour that shows it best
///
/// # Errors
/// Those of [`agreement`].
pub fn smallest_bias(a: Render, b: Render, alpha: f64) -> Result<f64> {
    const Z_90: f64 = 1.281_551_565_5;
    let z = critical_z(alpha, 4 * CHANNELS.len()) + Z_90;
    let of = |name: &str| -> Result<f64> {
        let pair = Pair::new(a, b, name)?;
        let [a, b] = [0, 1].map(|k| pair.pixels.iter().map(|pixel| &pixel[k]).fold(Mean::default(), add));
        Ok(z * (a.variance + b.variance).sqrt() / (0.5 * (a.value + b.value)).abs())
    };
    let all: Vec<f64> = CHANNELS.into_iter().map(of).collect::<Result<_>>()?;
    Ok(all.into_iter().filter(|bias| !bias.is_nan()).fold(f64::INFINITY, f64::min))
}

/// One colour of both images.
struct Pair {
    width: usize,
    pixels: Vec<[Mean; 2]>,
}

impl Pair {
    fn new(a: Render, b: Render, channel: &str) -> Result<Pair> {
        if a.image.size != b.image.size {
            let text = format!("images of {} and {} pixels cannot be compared", a.image.size, b.image.size);
            return Err(Error::invalid(Fault::new(text)));
        }
        let (a, b) = (means(a, channel)?, means(b, channel)?);
        Ok(Pair { width: a.0, pixels: a.1.into_iter().zip(b.1).map(|(a, b)| [a, b]).collect() })
    }

    /// Pixel, block, global, spread.
    fn test(&self, level: f64) -> [Verdict; 4] {
        let blocks = self.blocks(SHARED);
        let pixels = blocks.iter().flat_map(|block| &block.pixels).map(Tested::pixel);
        let whole = Block::joined(self.blocks(0.0));
        // E(z²) of a sum that n samples make exceeds 1 by 2/n; of N blocks chance makes the mean ±√(2/N), and n = 2.5 √N keeps the one
        // at half of the other.
        let smallest = self.width.div_ceil(BLOCK) * self.height().div_ceil(BLOCK);
        let coarse = self.blocks(SHARED.max(2.5 * (smallest as f64).sqrt()));
        [
            many(pixels, level),
            many(blocks.iter().map(Tested::sum), level),
            many([Tested::sum(&whole)].into_iter(), level),
            spread(&coarse, level),
        ]
    }

    /// Whether fewer than [`SHARED`] samples make the relative error √(Σ v/(s² + ε)), with s the surroundings: behind its own light an
    /// outlier would hide.
    fn is_heavy(&self, side: usize) -> bool {
        let mean = self.pixels.iter().map(|pixel| pixel[side].value).sum::<f64>() / self.pixels.len() as f64;
        let floor = EPSILON * mean * mean;
        let tiles = (0..self.height()).step_by(BLOCK).flat_map(|y| (0..self.width).step_by(BLOCK).map(move |x| (x, y)));
        let noise = tiles.flat_map(|(x, y)| with_surroundings(self.tile(x, y).map(|pixel| pixel[side])));
        let (sum, fourth) = noise.fold((0.0, 0.0), |(sum, fourth), (mean, around)| {
            let share = mean.variance / (around * around + floor);
            (sum + share, fourth + share * share / samples(mean, around))
        });
        sum * sum < SHARED * fourth
    }

    fn is_black(&self, side: usize) -> bool {
        self.pixels.iter().all(|pixel| pixel[side].value == 0.0)
    }

    /// The pixels of a square of 8×8, fewer at the far edges.
    fn tile(&self, x: usize, y: usize) -> impl Iterator<Item = [Mean; 2]> {
        let rows = y..(y + BLOCK).min(self.height());
        rows.flat_map(move |row| &self.pixels[row * self.width + x..row * self.width + (x + BLOCK).min(self.width)]).copied()
    }

    fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }

    /// Squares of 8×8 pixels, smaller at the far edges, or of twice, four times… that edge where the noise of either picture is not yet
    /// shared among so many samples; the whole picture at most.
    fn blocks(&self, shared: f64) -> Vec<Block> {
        let edge = self.width.max(self.height()).div_ceil(BLOCK).next_power_of_two() * BLOCK;
        self.split(0, 0, edge, shared)
    }

    /// The blocks of a square, or else the square as one: it is only divided where each part can stand alone.
    fn split(&self, x: usize, y: usize, edge: usize, shared: f64) -> Vec<Block> {
        if x >= self.width || y >= self.height() {
            return vec![];
        }
        if edge == BLOCK {
            return vec![Block::of(self.tile(x, y).collect())];
        }
        let half = edge / 2;
        let corners = [(0, 0), (half, 0), (0, half), (half, half)];
        let parts: Vec<Block> = corners.iter().flat_map(|(i, j)| self.split(x + i, y + j, half, shared)).collect();
        match parts.iter().all(|part| part.is_shared(shared)) {
            true => parts,
            false => vec![Block::joined(parts)],
        }
    }
}

/// What a test is made of: two means, and the third cumulants of their noise.
struct Tested {
    means: [Mean; 2],
    third: [f64; 2],
}

impl Tested {
    /// A pixel's skewness is not known.
    fn pixel(means: &[Mean; 2]) -> Tested {
        Tested { means: *means, third: [0.0; 2] }
    }

    fn sum(block: &Block) -> Tested {
        Tested { means: block.sums.map(|sum| sum.mean), third: block.sums.map(|sum| sum.third) }
    }

    /// Welch's test, with the statistic of skewed sums taken back where the darker side may lack its brightest samples.
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
        // A bound of the skewness must not make anything surer.
        Welch { t: if back.is_finite() { back.clamp(t, 0.0) } else { t }, ..welch }.p()
    }
}

/// The estimates of a channel, and the width of its rows.
fn means(render: Render, channel: &str) -> Result<(usize, Vec<Mean>)> {
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

/// (2⁻²⁰·value)²: what the rounding of f32 images and of the light's own arithmetic may add to a variance.
fn rounding(mean: &Mean) -> f64 {
    (mean.value * 2f64.powi(-20)).powi(2)
}

fn rounded(mean: Mean) -> Mean {
    Mean { variance: mean.variance + rounding(&mean), ..mean }
}

/// The test of each.
fn many(tested: impl Iterator<Item = Tested>, level: f64) -> Verdict {
    let (mut p, mut tests) = (1.0f64, 0);
    for one in tested {
        // NaN is no agreement.
        p = p.min(Some(one.p()).filter(|p| !p.is_nan()).unwrap_or(0.0));
        tests += 1;
    }
    Verdict { p, level: sidak(level, tests), tests }
}

/// Σz² of n blocks follows χ² with n degrees of freedom: too large where they differ, too small where
/// errors are overstated or the images share their random numbers.
///
/// Blocks of less spread than rounding may bring claim nothing and do not count.
fn spread(blocks: &[Block], level: f64) -> Verdict {
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
