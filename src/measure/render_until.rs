//! Renders that stop at a number of samples, at a time, or at an accuracy.

use std::time::Duration;

use super::{Checkpoint, ErrorHistory, RelativeError, checkpoints};
use crate::film::{Film, MomentFilm};
use crate::render::{Observer, Render, RenderReport, Silent};

/// Condition at which a render stops: the first of these limits that is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopCondition {
    /// Samples per pixel.
    pub samples: u64,
    /// Render time.
    pub time: Option<Duration>,
    /// Accuracy.
    pub target: Option<ErrorTarget>,
}

impl StopCondition {
    /// Returns whether the error is measured after so many samples. A measurement costs as much as a fraction of a sample, so
    /// without a target only a few late ones are made, which give the slope.
    fn measures_error_at(&self, samples: u64) -> bool {
        let late = samples.saturating_mul(16) >= self.samples || self.time.is_some();
        self.target.is_some() || samples == self.samples || late && samples.is_power_of_two()
    }

    /// Expected number of samples per pixel, extrapolated from the history.
    fn expected(&self, history: &ErrorHistory) -> u64 {
        let samples = |target: &ErrorTarget| {
            let (price, last) = (history.price(target.error, target.confidence)?, history.last()?);
            Some((last.samples as f64 * (price.seconds / last.seconds).max(1.0)) as u64)
        };
        self.target.as_ref().and_then(samples).map_or(self.samples, |expected| expected.min(self.samples))
    }
}

/// A relative error, and the required certainty that it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorTarget {
    /// Largest relative error.
    pub error: f64,
    /// Probability that the error is reached, below 1.
    pub confidence: f64,
}

/// Outcome of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The error is at most the target.
    Met,
    /// The error is not known to be at most the target.
    NotMet,
    /// A few pixels hold all the noise, so that the estimated error says little.
    NotEstablished,
}

/// A film whose moments can be read.
pub trait HasMoments: Film {
    /// The moments.
    fn moments(&self) -> &MomentFilm;
}

impl HasMoments for MomentFilm {
    fn moments(&self) -> &MomentFilm {
        self
    }
}

/// Observer of a render whose error is measured from time to time.
pub trait ErrorObserver: Observer {
    /// Called after a measurement of the error; `expected` is the number of samples per pixel that the render will probably take.
    fn error_measured(&self, _history: &ErrorHistory, _expected: u64) {}

    /// Called between two waves, outside of the render's time.
    fn wave_finished(&self, _report: &RenderReport, _film: &MomentFilm, _history: &ErrorHistory) {}
}

impl ErrorObserver for Silent {}

/// Renders until a limit is reached, and measures the error at each checkpoint.
pub fn render_until(render: &mut Render, film: &mut impl HasMoments, until: &StopCondition, observer: &dyn ErrorObserver) -> ErrorHistory {
    resume_until(ErrorHistory::default(), render, film, until, observer)
}

/// Continues a render that [`render_until`] began. It measures and stops as if the render had never paused.
pub fn resume_until(
    mut history: ErrorHistory,
    render: &mut Render,
    film: &mut impl HasMoments,
    until: &StopCondition,
    observer: &dyn ErrorObserver,
) -> ErrorHistory {
    let mut tests = SequentialTest::default();
    let is_met = until.target.is_some_and(|target| history.checkpoints.iter().any(|before| tests.is_met(target, Some(before))));
    let (seen, done) = (history.last().map_or(0, |last| last.samples), film.moments().samples());
    if is_met {
        // The target was met earlier. The last error that is reported must be that of all samples.
        history.checkpoints.extend((done > seen).then(|| measure_error(render, film)));
        return history;
    }
    let is_ahead = |samples: &u64| *samples > seen && *samples >= done;
    for samples in checkpoints(until.samples).filter(|samples| is_ahead(samples) && until.measures_error_at(*samples)) {
        while render.step(samples, until.time, film, observer) {
            observer.wave_finished(render.report(), film.moments(), &history);
        }
        let reached = film.moments().samples();
        if reached > history.last().map_or(0, |last| last.samples) {
            history.checkpoints.push(measure_error(render, film));
            observer.error_measured(&history, until.expected(&history));
        }
        // The render was cancelled or ran out of time. That moment was not planned, so no decision is made at it.
        if reached < samples || until.target.is_some_and(|target| tests.is_met(target, history.last())) {
            break;
        }
    }
    history
}

fn measure_error(render: &Render, film: &impl HasMoments) -> Checkpoint {
    let (film, seconds) = (film.moments(), render.report().elapsed.as_secs_f64());
    Checkpoint { samples: film.samples(), seconds, error: RelativeError::of(film) }
}

/// Sequence of tests of whether the error is below a target. Each test takes a share of the risk, so that all together keep the
/// level.
///
/// αⱼ = α / (j (j + 1)),  Σ αⱼ = α
#[derive(Default)]
struct SequentialTest {
    taken: u32,
}

impl SequentialTest {
    /// Tests whether the error lies below the target.
    fn is_met(&mut self, target: ErrorTarget, at: Option<&Checkpoint>) -> bool {
        let Some(error) = at.and_then(|checkpoint| checkpoint.error).filter(RelativeError::is_established) else { return false };
        self.taken += 1;
        error.below(1.0 - risk(target, self.taken)) <= target.error
    }
}

/// αⱼ, the risk of test j.
fn risk(target: ErrorTarget, look: u32) -> f64 {
    (1.0 - target.confidence) / (f64::from(look) * (f64::from(look) + 1.0))
}

impl ErrorTarget {
    /// Outcome of this target for a whole render.
    pub fn outcome(&self, history: &ErrorHistory) -> Outcome {
        let mut tests = SequentialTest::default();
        let met = history.checkpoints.iter().any(|checkpoint| tests.is_met(*self, Some(checkpoint)));
        match history.checkpoints.iter().rev().find_map(|checkpoint| checkpoint.error) {
            Some(last) if !last.is_established() => Outcome::NotEstablished,
            Some(_) if met => Outcome::Met,
            _ => Outcome::NotMet,
        }
    }
}
