//! Relative error of a picture, estimated from the picture's own error bars.

use std::fmt;

use statrs::distribution::{ContinuousCDF, Normal};

use super::contribution::{Contribution, residual_variance};
use super::correlation::correlation;
use super::local_reference::PixelStatistics;
use crate::film::{Film, Image, MomentFilm};

/// Estimated relative error of a picture, with the uncertainty of the estimate.
///
/// ```text
/// error = √relMSE,   relMSE = 1/3P Σ (x − r)² / (r² + ε),   ε = 0.01 · mean(r)²
/// ```
///
/// The sum runs over P pixels x and three colours; r is the picture that infinitely many samples would give. Scaling the light
/// scales x, r and √ε alike and leaves the error unchanged.
///
/// Only x and its variance v are known of r. So each (x − r)² is replaced by v, and the denominator is corrected for the use of x
/// instead of r. The estimate is that of the error of this very picture, which varies from seed to seed as the noise does.
///
/// Tests: intervals hold the true error as often as they say; scale invariance; heavy tails are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeError {
    /// √relMSE
    pub value: f64,
    /// Standard deviation of ln(value).
    pub spread: f64,
    /// Number of pixels with equal noise that would tell as much about the noise.
    pub effective_pixels: f64,
}

/// Uncertainty of the correction of the denominators, as a standard deviation in units of the correction. The correction is right
/// to second order only. The value is chosen by measurement: with it 96.8 % of the 95 % intervals of `cargo bench --bench accuracy -- coverage`
/// hold, all scenes together (docs/accuracy.md).
const UNSURE: f64 = 0.75;

/// An error, and the ends of the interval that holds it with the requested probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorInterval {
    /// √relMSE
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Reason why no error can be stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A few pixels hold all the noise. If one more bright sample arrived, the estimate would change completely.
    HeavyTail,
    /// Noise drowns the picture, so that not even the order of magnitude of the error is known.
    TooNoisy,
}

impl Refusal {
    /// Name and explanation.
    pub fn words(self) -> (&'static str, &'static str) {
        match self {
            Refusal::HeavyTail => ("heavy tail", "a few pixels hold all the noise"),
            Refusal::TooNoisy => ("too noisy", "more samples are needed"),
        }
    }
}

/// Writes name and explanation: `heavy tail: a few pixels hold all the noise`.
impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (name, explanation) = self.words();
        write!(f, "{name}: {explanation}")
    }
}

/// Smallest number of equally noisy pixels that tells the noise of a picture.
///
/// With 30 pixels the relative standard deviation of relMSE is 21 to 26 %, just where an interval about a logarithm still has a
/// meaning.
const FEWEST: f64 = 30.0;

/// ln 10 / 1.96: spread at which an interval of 95 % reaches from a tenth to ten times the error.
const VAGUE: f64 = 1.175;

impl RelativeError {
    /// Relative error of the picture so far. `None` if its samples tell no error, or it is black.
    pub fn of(film: &MomentFilm) -> Option<RelativeError> {
        let picture = PixelStatistics::new(film, film.spec().crop.size().x as usize)?;
        let contributions = picture.contributions();
        Some(RelativeError::over(&contributions, &picture, correlation(film, picture.floor)))
    }

    /// Relative error of some of the pixels.
    ///
    /// - `contributions`: indices of the pixels, with their contributions to relMSE
    /// - `correlation`: φ of the errors of the pixels
    pub(super) fn over(contributions: &[(usize, Contribution)], picture: &PixelStatistics, correlation: f64) -> RelativeError {
        let total = |of: &dyn Fn(&Contribution) -> f64| contributions.iter().map(|(_, contribution)| of(contribution)).sum::<f64>();
        let (sum, square) = (total(&|c| c.value), total(&|c| c.value * c.value));
        let variance_ratio = total(&|c| c.value * c.variance_ratio);
        let count = contributions.len() as f64;
        if square == 0.0 {
            return RelativeError { value: 0.0, spread: 0.0, effective_pixels: f64::INFINITY };
        }
        // Mean of the relative variance σ² g(r), weighted with the contributions.
        let noise = variance_ratio / sum / residual_variance(picture.freedom);
        // E[g(x)]/g(r) = 1 + 3s² + 15s⁴ + … for symmetric noise. The fourth order is not corrected, and up to two thirds of it may
        // be left.
        let beyond = 10.0 * noise * noise;
        let uncorrected: f64 = contributions.iter().map(|(i, _)| picture.uncorrected(*i)).sum();
        let corrected = UNSURE * (sum / uncorrected).ln();
        let random = (variance_ratio * correlation).sqrt();
        let spread = 0.5 * (random / sum).hypot(corrected).hypot(beyond);
        RelativeError { value: (sum / count).sqrt(), spread, effective_pixels: sum * sum / square }
    }

    /// An error of which nothing is known but the reason why it cannot be stated.
    pub fn refused(refusal: Refusal) -> RelativeError {
        let effective_pixels = if refusal == Refusal::HeavyTail { 0.0 } else { f64::INFINITY };
        RelativeError { value: f64::NAN, spread: f64::INFINITY, effective_pixels }
    }

    /// The error with the interval that holds it with this probability.
    ///
    /// This is the only rule of what is stated: whoever prints, writes, compares or extrapolates an error asks here.
    ///
    /// # Errors
    /// The reason why nothing can be stated.
    pub fn stated(&self, confidence: f64) -> Result<ErrorInterval, Refusal> {
        match self.refusal() {
            Some(refusal) => Err(refusal),
            None => {
                let reach = quantile(0.5 + 0.5 * confidence) * self.spread;
                Ok(ErrorInterval { value: self.value, low: self.value * (-reach).exp(), high: self.value * reach.exp() })
            }
        }
    }

    /// Reason why the error cannot be stated, if there is one.
    pub fn refusal(&self) -> Option<Refusal> {
        match self.effective_pixels < FEWEST {
            true => Some(Refusal::HeavyTail),
            false => Some(Refusal::TooNoisy).filter(|_| self.spread > VAGUE),
        }
    }

    /// Lower confidence bound: the error is above it with this probability. It exists even where the error cannot be stated.
    pub(super) fn above(&self, confidence: f64) -> f64 {
        self.value * (-quantile(confidence) * self.spread).exp()
    }

    /// Upper confidence bound: the error is below it with this probability.
    ///
    /// # Errors
    /// The reason why nothing can be stated.
    pub fn below(&self, confidence: f64) -> Result<f64, Refusal> {
        self.stated(confidence).map(|error| error.value * (quantile(confidence) * self.spread).exp())
    }
}

/// Standard errors of red, green and blue; `None` if a channel is missing.
pub fn errors(image: &Image) -> Option<[&[f32]; 3]> {
    let channels: Vec<&[f32]> = ["StdErr.R", "StdErr.G", "StdErr.B"].iter().filter_map(|name| image.channel(name)).collect();
    channels.try_into().ok()
}

/// Quantile of the standard normal distribution.
pub(super) fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}
