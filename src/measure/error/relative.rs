//! Relative error of a picture, estimated from the picture's own error bars.

use statrs::distribution::{ContinuousCDF, Normal};

use super::contribution::residual_variance;
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
/// to second order only.
const UNSURE: f64 = 0.25;

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
        let sum: f64 = contributions.iter().map(|contribution| contribution.value).sum();
        let square: f64 = contributions.iter().map(|contribution| contribution.value * contribution.value).sum();
        let variance_ratio: f64 = contributions.iter().map(|contribution| contribution.value * contribution.variance_ratio).sum();
        let count = contributions.len() as f64;
        if square == 0.0 {
            return Some(RelativeError { value: 0.0, spread: 0.0, effective_pixels: count });
        }
        // σ² g(r) where the error is.
        let noise = variance_ratio / sum / residual_variance(picture.freedom);
        // E[g(x)]/g(r) = 1 + 3s² + 15s⁴ + … for symmetric noise. The fourth order is not corrected, and up to two thirds of it may
        // be left.
        let beyond = 10.0 * noise * noise;
        let corrected = UNSURE * (sum / picture.uncorrected()).ln();
        let random = (variance_ratio * correlation(film, picture.floor)).sqrt();
        let spread = 0.5 * (random / sum).hypot(corrected).hypot(beyond);
        Some(RelativeError { value: (sum / count).sqrt(), spread, effective_pixels: sum * sum / square })
    }

    /// Interval that holds the error with this probability.
    pub fn interval(&self, confidence: f64) -> [f64; 2] {
        let reach = quantile(0.5 + 0.5 * confidence) * self.spread;
        [self.value * (-reach).exp(), self.value * reach.exp()]
    }

    /// Bound below which the error lies with this probability.
    pub fn below(&self, confidence: f64) -> f64 {
        self.value * (quantile(confidence) * self.spread).exp()
    }

    /// Returns whether enough pixels share the noise. If a few bright pixels hold all of it, the next one would change the estimate
    /// completely.
    pub fn is_established(&self) -> bool {
        self.effective_pixels >= FEWEST
    }

    /// Returns whether not even the order of magnitude is known, because noise drowns the picture.
    pub fn is_vague(&self) -> bool {
        self.spread > VAGUE
    }
}

/// Standard errors of red, green and blue; `None` if a channel is missing.
pub fn errors(image: &Image) -> Option<[&[f32]; 3]> {
    let channels: Vec<&[f32]> = ["StdErr.R", "StdErr.G", "StdErr.B"].iter().filter_map(|name| image.channel(name)).collect();
    channels.try_into().ok()
}

fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}
