//! Renders that stop at a number of samples, at a time, or at an accuracy.

use std::time::Duration;

use super::error_history::{is_coarse, is_planned};
use super::{Checkpoint, ErrorHistory, Refusal, Scope, checkpoints};
use crate::film::{Film, MomentFilm};
use crate::render::{Observer, Render, RenderReport, Silent};

/// [`StopCondition::patience`] of a render that has no limit but a target. It is chosen, not derived: far more samples than pictures take until
/// their error is established, and seconds for a picture of a few pixels.
const PATIENCE: u64 = 1 << 14;

/// Condition at which a render stops: the first of these limits that is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopCondition {
    /// Samples per pixel.
    pub samples: u64,
    /// Render time.
    pub time: Option<Duration>,
    /// Accuracy.
    pub target: Option<ErrorTarget>,
    /// Samples per pixel from which on the render ends if no error could be established while their number grew by a factor of 64: where the
    /// picture is black, or a few dozen pixels have all the noise, the target may never be reached. `None` for a render that has another limit.
    pub patience: Option<u64>,
}

impl StopCondition {
    /// Condition with the limits that are asked for. If only a time or an accuracy is, the planned number of samples is not a limit.
    ///
    /// - `asked`: samples per pixel that are asked for
    /// - `planned`: samples per pixel that the scene plans
    pub fn new(asked: Option<u64>, planned: u64, time: Option<Duration>, target: Option<ErrorTarget>) -> StopCondition {
        let is_free = (time.is_some() || target.is_some()) && asked.is_none();
        let samples = if is_free { u32::MAX.into() } else { asked.unwrap_or(planned) };
        StopCondition { samples, time, target, patience: Some(PATIENCE).filter(|_| is_free && time.is_none()) }
    }

    /// Pixels whose error the history of the render tells.
    pub fn scope(&self) -> Scope {
        self.target.map_or(Scope::Picture, |target| target.scope)
    }

    /// Returns whether the error is measured at a checkpoint. A measurement costs as much as a fraction of a sample, so without a
    /// target only a few late ones are made, which give the slope. With a target every checkpoint counts from where the target may be
    /// reached.
    fn measures_error_at(&self, samples: u64, history: &ErrorHistory) -> bool {
        let late = samples.saturating_mul(16) >= self.samples || self.time.is_some();
        match self.target {
            _ if samples == self.samples => true,
            Some(_) => is_coarse(samples) || self.may_be_met_at(samples, history),
            None => late && samples.is_power_of_two(),
        }
    }

    /// Returns whether the target, if there is one, is probably reached after so many samples.
    fn may_be_met_at(&self, samples: u64, history: &ErrorHistory) -> bool {
        self.target.is_some_and(|target| history.error_at(samples).is_some_and(|error| error <= target.error))
    }

    /// Returns whether the target is given up: see [`StopCondition::patience`].
    pub fn is_given_up(&self, history: &ErrorHistory) -> bool {
        let (Some(patience), Some(last)) = (self.patience, history.last()) else { return false };
        let mut recent = history.checkpoints.iter().filter(|checkpoint| checkpoint.samples >= last.samples / 64);
        last.samples >= patience && recent.all(|checkpoint| !checkpoint.is_established())
    }

    /// The history without the checkpoints that a render which never paused would not have: those at which it was paused.
    fn without_pauses(&self, history: ErrorHistory) -> ErrorHistory {
        let mut kept = ErrorHistory { checkpoints: vec![], ..history };
        for checkpoint in history.checkpoints {
            if is_planned(checkpoint.samples) && self.measures_error_at(checkpoint.samples, &kept) {
                kept.checkpoints.push(checkpoint);
            }
        }
        kept
    }

    /// Expected number of samples per pixel, extrapolated from the history.
    fn expected(&self, history: &ErrorHistory) -> u64 {
        let samples = |target: &ErrorTarget| {
            let (forecast, last) = (history.samples_for(target.error, target.confidence)?, history.last()?);
            Some(forecast.value.max(last.samples as f64) as u64)
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
    /// Pixels whose error counts.
    pub scope: Scope,
}

/// Samples per pixel from which on every render tells an error, unless its picture is black: two for each of the most scramblings.
const ENOUGH: u64 = 128;

/// Outcome of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The error is at most the target.
    Met,
    /// The error is not known to be at most the target.
    NotMet,
    /// A few pixels hold all the noise, so that the estimated error says little.
    HeavyTail,
    /// No sample has found light.
    Black,
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
    history: ErrorHistory,
    render: &mut Render,
    film: &mut impl HasMoments,
    until: &StopCondition,
    observer: &dyn ErrorObserver,
) -> ErrorHistory {
    let mut history = until.without_pauses(ErrorHistory { sampler: render.sampler().kind, ..history });
    let mut tests = SequentialTest::default();
    let is_met = until.target.is_some_and(|target| history.checkpoints.iter().any(|before| tests.is_met(target, Some(before))));
    let (seen, done) = (history.last().map_or(0, |last| last.samples), film.moments().samples());
    if is_met || until.is_given_up(&history) {
        // The target was met or given up earlier. The last error that is reported must be that of all samples.
        history.checkpoints.extend((done > seen).then(|| measure_error(render, film, until)));
        return history;
    }
    let is_ahead = |samples: &u64| *samples > seen && *samples >= done;
    for samples in checkpoints(until.samples).filter(is_ahead) {
        if !until.measures_error_at(samples, &history) {
            continue;
        }
        while render.step(samples, until.time, film, observer) {
            observer.wave_finished(render.report(), film.moments(), &history);
        }
        let reached = film.moments().samples();
        if reached > history.last().map_or(0, |last| last.samples) {
            history.checkpoints.push(measure_error(render, film, until));
            observer.error_measured(&history, until.expected(&history));
        }
        // The render was cancelled or ran out of time. That moment was not planned, but it does not depend on the error, so that its test
        // counts in `ErrorTarget::outcome` like the others.
        let is_met = until.target.is_some_and(|target| tests.is_met(target, history.last()));
        if reached < samples || is_met || until.is_given_up(&history) {
            break;
        }
    }
    history
}

fn measure_error(render: &Render, film: &impl HasMoments, until: &StopCondition) -> Checkpoint {
    let (film, seconds) = (film.moments(), render.report().elapsed.as_secs_f64());
    Checkpoint { samples: film.samples(), seconds, error: until.scope().error(film) }
}

/// Sequence of tests of whether the error is below a target. Each test takes a share of the risk, so that all together keep the
/// level.
///
/// αⱼ = α / (j (j + 1)),  Σ αⱼ = α
///
/// A test at which the estimate itself is above the target cannot succeed. It takes no risk and is not counted.
#[derive(Default)]
struct SequentialTest {
    taken: u32,
}

impl SequentialTest {
    /// Tests whether the error lies below the target.
    fn is_met(&mut self, target: ErrorTarget, at: Option<&Checkpoint>) -> bool {
        let Some(error) = at.and_then(|checkpoint| checkpoint.error).filter(|error| error.value <= target.error) else { return false };
        self.taken += 1;
        error.below(1.0 - risk(target, self.taken)).is_ok_and(|below| below <= target.error)
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
            Some(last) if last.refusal() == Some(Refusal::HeavyTail) => Outcome::HeavyTail,
            Some(_) if met => Outcome::Met,
            None if history.last().is_some_and(|last| last.samples >= ENOUGH) => Outcome::Black,
            _ => Outcome::NotMet,
        }
    }
}
