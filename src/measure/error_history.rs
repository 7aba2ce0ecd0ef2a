//! Error of a render over time.

use std::time::Duration;

use super::{Refusal, RelativeError};
use crate::film::MomentFilm;
use crate::sampler::Kind;

/// State of a render at one of its checkpoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkpoint {
    /// Samples per pixel.
    pub samples: u64,
    /// Render time.
    pub seconds: f64,
    /// Estimated error of the picture; `None` if the samples tell none, or the picture is black.
    pub error: Option<RelativeError>,
}

impl Checkpoint {
    /// Returns whether there is an error that is not refused as a heavy tail. One of a picture that is too noisy counts.
    pub(super) fn is_established(&self) -> bool {
        self.error.is_some_and(|error| error.refusal() != Some(Refusal::HeavyTail))
    }
}

/// Checkpoints of one render, in order.
#[derive(Clone, Debug, Default)]
pub struct ErrorHistory {
    /// Checkpoints, in order of samples.
    pub checkpoints: Vec<Checkpoint>,
    /// Sampler, which decides how relMSE falls with more samples.
    pub sampler: Kind,
}

/// Numbers of samples per pixel at which the error of a render may be measured: all from 2 to 64, then 66, 68, … 128, 132, … below
/// `total`, and `total`.
///
/// The checkpoints are planned ahead. A render that measured its error at any time and stopped when the error seems small would stop at
/// lucky moments, and its error would be underestimated.
pub fn checkpoints(total: u64) -> impl Iterator<Item = u64> {
    let above = (0..58).flat_map(|k: u32| (32u64..64).map(move |n| n << k));
    (2..32).chain(above).take_while(move |samples| *samples < total).chain([total])
}

/// Whether a number of samples is one of [`checkpoints`] without an end.
pub(super) fn is_planned(samples: u64) -> bool {
    samples >= 2 && samples.trailing_zeros() + 6 >= u64::BITS - samples.leading_zeros()
}

/// Whether a number of samples is one of 2, 3, 4, 6, 8, 12, …, at which a render with a target measures its error in any case.
pub(super) fn is_coarse(samples: u64) -> bool {
    samples >= 2 && samples.trailing_zeros() + 2 >= u64::BITS - samples.leading_zeros()
}

impl ErrorHistory {
    /// The latest checkpoint.
    pub fn last(&self) -> Option<&Checkpoint> {
        self.checkpoints.last()
    }

    /// The history with the error of a film as it is now.
    ///
    /// - `elapsed`: time of rendering
    pub fn and_now(&self, film: &MomentFilm, elapsed: Duration) -> ErrorHistory {
        let now = Checkpoint { samples: film.samples(), seconds: elapsed.as_secs_f64(), error: RelativeError::of(film) };
        ErrorHistory { checkpoints: self.checkpoints.iter().copied().chain([now]).collect(), ..*self }
    }

    /// Checkpoints at planned numbers of samples, which a longer render measures too.
    pub fn planned(&self) -> impl Iterator<Item = &Checkpoint> {
        self.checkpoints.iter().filter(|checkpoint| is_planned(checkpoint.samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checkpoints_are_planned() {
        assert_eq!(checkpoints(33).filter(|n| *n > 28).collect::<Vec<_>>(), [29, 30, 31, 32, 33]);
        assert!(checkpoints(69).filter(|n| *n > 61).eq([62, 63, 64, 66, 68, 69]) && checkpoints(1 << 62).take(1500).all(is_planned));
        assert!(!is_planned(65) && is_planned(66 << 9) && (1..20).filter(|n| is_coarse(*n)).eq([2, 3, 4, 6, 8, 12, 16]));
        assert_eq!(checkpoints(16).last(), Some(16));
        assert_eq!(checkpoints(1).collect::<Vec<_>>(), [1]);
        assert_eq!(checkpoints(u64::MAX).last(), Some(u64::MAX));
    }
}
