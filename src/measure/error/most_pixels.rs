//! A bound of the error of most pixels, where a few hold so much of the noise that the error of the whole picture cannot be established.
//!
//! The pixels with the greatest estimated contributions to relMSE are set aside: one in a thousand, and one in a hundred if that does
//! not suffice. The noise of the others gives a lower bound of their error,
//!
//! ```text
//! √( 1/3Q Σ (x − r)² / (r² + ε) )    over the Q pixels that are left, with ε of the whole picture
//! ```
//!
//! It is no more than a bound: a heavy tail means that some light is found by few samples, and the pixels in which no sample has found it
//! yet lack it without looking noisy.
//!
//! Tests: most_pixels_have_at_least_the_stated_error; `cargo bench --bench accuracy -- coverage` counts on scenes.

use super::contribution::Contribution;
use super::correlation::correlation;
use super::local_reference::PixelStatistics;
use super::relative::RelativeError;
use crate::film::{Film, MomentFilm};

/// Shares of the pixels that are set aside, in the order in which they are tried.
const SET_ASIDE: [f64; 2] = [0.001, 0.01];

/// Noise of all pixels but those with the most.
#[derive(Clone, Debug, PartialEq)]
pub struct MostPixels {
    /// Share of the pixels that are left.
    pub share: f64,
    /// Their error as far as their noise tells it.
    found: RelativeError,
    /// Smallest number of pixels that hold half of the noise of the whole picture.
    pub noisiest: usize,
    /// Share of the noise of the whole picture (of relMSE) that these pixels hold.
    pub noise: f64,
    /// Indices of the pixels that are set aside, in rows over the crop, the noisiest first.
    pub aside: Vec<usize>,
}

impl MostPixels {
    /// Noise of most pixels of a picture; `None` if even that says nothing.
    pub fn of(film: &MomentFilm) -> Option<MostPixels> {
        let picture = PixelStatistics::new(film, film.spec().crop.size().x as usize)?;
        let mut contributions = picture.contributions();
        contributions.sort_by(|(_, a), (_, b)| b.value.total_cmp(&a.value));
        let correlation = correlation(film, picture.floor);
        let count = contributions.len();
        let (noisiest, noise) = noisiest_half(&contributions);
        SET_ASIDE.into_iter().find_map(|share| {
            let (aside, others) = contributions.split_at((share * count as f64) as usize);
            let found = RelativeError::over(others, &picture, correlation);
            let is_stated = !aside.is_empty() && found.refusal().is_none();
            is_stated.then(|| MostPixels { share: 1.0 - share, found, noisiest, noise, aside: aside.iter().map(|(i, _)| *i).collect() })
        })
    }

    /// Bound above which the error of these pixels lies with this probability.
    pub fn at_least(&self, confidence: f64) -> f64 {
        self.found.above(confidence)
    }
}

/// Smallest number of pixels that hold half of the noise, and the share of it that they hold.
///
/// - `contributions`: those of all pixels, in falling order
fn noisiest_half(contributions: &[(usize, Contribution)]) -> (usize, f64) {
    let all: f64 = contributions.iter().map(|(_, contribution)| contribution.value).sum();
    let mut held = 0.0;
    for (count, (_, contribution)) in (1..).zip(contributions) {
        held += contribution.value;
        if held >= 0.5 * all {
            return (count, held / all);
        }
    }
    (contributions.len(), 1.0)
}
