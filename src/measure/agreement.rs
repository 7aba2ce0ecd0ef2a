//! Do two images show the same picture?
//!
//! Four questions, because each finds what the others miss:
//!
//! - pixel: is any pixel off?           seams, a wrong shadow's edge
//! - block: is any block of 8×8 off?    a wrong material in a corner; some per cent of bias
//! - global: is the whole off?          some per mille of bias
//! - spread: Σz² over blocks ~ χ²       many small differences; and errors smaller than claimed
//!
//! Heavy tails: a pixel whose rare bright paths have not come yet looks surer than it is. So a pixel's
//! variance counts as at least the mean of its block, and Σz² is formed of block sums, which are close to
//! normal long before single pixels are.

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::{Mean, Verdict, critical_z, sidak};
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

/// Edge of a block (pixels).
const BLOCK: usize = 8;
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
    let colors: Vec<[Verdict; 4]> = CHANNELS.into_iter().map(|c| Pair::new(a, b, c).map(|pair| pair.test(level))).collect::<Result<_>>()?;
    let worst = |k: usize| {
        let all = colors.iter().map(|verdicts| verdicts[k]);
        let tests = all.clone().map(|v| v.tests).sum();
        let worst = all.fold(None, |worst: Option<Verdict>, v| worst.filter(|w| w.p / w.level <= v.p / v.level).or(Some(v)));
        Verdict { tests, ..worst.unwrap_or(Verdict { p: 1.0, level, tests }) }
    };
    Ok(Agreement { pixel: worst(0), block: worst(1), global: worst(2), spread: worst(3) })
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
        let [a, b] = Pair::new(a, b, name)?.pixels.iter().fold([Mean::default(); 2], add);
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
        let blocks: Vec<[Mean; 2]> = self.blocks().map(|(_, sum)| sum).collect();
        let global = self.pixels.iter().fold([Mean::default(); 2], add);
        [many(self.cautious(), level), many(blocks.iter().copied(), level), many([global].into_iter(), level), spread(&blocks, level)]
    }

    /// The pixels, none surer than its block is in the mean.
    fn cautious(&self) -> impl Iterator<Item = [Mean; 2]> {
        self.blocks().flat_map(|(members, sum)| {
            let count = members.len() as f64;
            let floor = move |m: Mean, k: usize| Mean { variance: m.variance.max(sum[k].variance / count), ..m };
            members.into_iter().map(move |[a, b]| [floor(a, 0), floor(b, 1)])
        })
    }

    /// Blocks of 8×8 pixels, smaller at the far edges: their pixels, and the sums of these.
    fn blocks(&self) -> impl Iterator<Item = (Vec<[Mean; 2]>, [Mean; 2])> {
        let height = self.pixels.len() / self.width.max(1);
        let corners = (0..height).step_by(BLOCK).flat_map(move |y| (0..self.width).step_by(BLOCK).map(move |x| (x, y)));
        corners.map(move |(x, y)| {
            let rows = y..(y + BLOCK).min(height);
            let members: Vec<[Mean; 2]> =
                rows.flat_map(|row| &self.pixels[row * self.width + x..row * self.width + (x + BLOCK).min(self.width)]).copied().collect();
            let sum = members.iter().fold([Mean::default(); 2], add);
            (members, sum)
        })
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

/// Sums of independent estimates: values and variances add, and so do samples.
fn add(sum: [Mean; 2], next: &[Mean; 2]) -> [Mean; 2] {
    let add = |k: usize| Mean {
        value: sum[k].value + next[k].value,
        variance: sum[k].variance + next[k].variance,
        samples: sum[k].samples + next[k].samples,
    };
    [add(0), add(1)]
}

/// (2⁻²⁰·value)²: what the rounding of f32 images and of the light's own arithmetic may add to a variance.
fn rounding(mean: &Mean) -> f64 {
    (mean.value * 2f64.powi(-20)).powi(2)
}

fn rounded(mean: Mean) -> Mean {
    Mean { variance: mean.variance + rounding(&mean), ..mean }
}

/// Welch's test of each pair.
fn many(pairs: impl Iterator<Item = [Mean; 2]>, level: f64) -> Verdict {
    let (mut p, mut tests) = (1.0f64, 0);
    for [a, b] in pairs {
        // NaN is no agreement.
        p = p.min(Some(rounded(a).welch(&rounded(b)).p()).filter(|p| !p.is_nan()).unwrap_or(0.0));
        tests += 1;
    }
    Verdict { p, level: sidak(level, tests), tests }
}

/// Σz² of n blocks follows χ² with n degrees of freedom: too large where they differ, too small where
/// errors are overstated or the images share their random numbers.
///
/// Blocks of less spread than rounding may bring claim nothing and do not count.
fn spread(blocks: &[[Mean; 2]], level: f64) -> Verdict {
    let noisy = blocks.iter().filter(|[a, b]| a.variance + b.variance > rounding(a) + rounding(b));
    let z2: Vec<f64> = noisy.map(|[a, b]| a.welch(b).t.powi(2)).collect();
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
