//! How far a picture is from the truth, told by its own error bars.

use statrs::distribution::{ContinuousCDF, Normal};

use super::calm::Picture;
use super::share::chance;
use crate::film::{Film, Image, MomentFilm};

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

/// The share of the correction of denominators that may be wrong, as a standard deviation: it is right to second order.
const UNSURE: f64 = 0.25;

/// Fewer than so many equally noisy pixels say nothing about the noise of a picture.
///
/// At 30 the relative standard deviation of relMSE is 21 to 26 %, just where an interval about a logarithm
/// still means something.
const FEWEST: f64 = 30.0;

/// ln 10 / 1.96: an interval of 95 % that reaches from a tenth to ten times the error.
const VAGUE: f64 = 1.175;

impl RelativeError {
    /// Of the picture so far. `None` where its samples tell no error, and for a black picture.
    pub fn of(film: &MomentFilm) -> Option<RelativeError> {
        let picture = Picture::new(film, film.spec().crop.size().x as usize)?;
        let shares = picture.shares();
        let sum: f64 = shares.iter().map(|share| share.value).sum();
        let square: f64 = shares.iter().map(|share| share.value * share.value).sum();
        let doubt: f64 = shares.iter().map(|share| share.value * share.doubt).sum();
        let count = shares.len() as f64;
        if square == 0.0 {
            return Some(RelativeError { value: 0.0, spread: 0.0, effective_pixels: count });
        }
        // σ² g(r), where the error is.
        let noise = doubt / sum / chance(picture.freedom);
        // E[g(x)]/g(r) = 1 + 3s² + 15s⁴ + … for even noise: the fourth order was not corrected, and two thirds of it may be left.
        let beyond = 10.0 * noise * noise;
        let corrected = UNSURE * (sum / picture.uncorrected()).ln();
        let spread = 0.5 * (doubt.sqrt() / sum).hypot(corrected).hypot(beyond);
        Some(RelativeError { value: (sum / count).sqrt(), spread, effective_pixels: sum * sum / square })
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

    /// Whether not even its order of magnitude is known: where the noise drowns the picture, no denominator is.
    pub fn is_vague(&self) -> bool {
        self.spread > VAGUE
    }
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

fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}
