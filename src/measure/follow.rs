//! Renders with an eye on the error: to a number of samples, to a time, to an accuracy.

use std::time::Duration;

use super::{Checkpoint, Course, RelativeError, checkpoints};
use crate::film::{Film, MomentFilm};
use crate::render::{Observer, Render, Report, Silent};

/// When to stop: at whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// Per pixel.
    pub samples: u64,
    pub time: Option<Duration>,
    pub target: Option<Target>,
}

impl Until {
    /// A look costs as much as a fraction of a sample: without a target a few late ones tell the slope.
    fn is_looked_at(&self, samples: u64) -> bool {
        let late = samples.saturating_mul(16) >= self.samples || self.time.is_some();
        self.target.is_some() || samples == self.samples || late && samples.is_power_of_two()
    }

    /// How many samples per pixel it will take, as the course so far tells.
    fn expected(&self, course: &Course) -> u64 {
        let samples = |target: &Target| {
            let (price, last) = (course.price(target.error, target.confidence)?, course.last()?);
            Some((last.samples as f64 * (price.seconds / last.seconds).max(1.0)) as u64)
        };
        self.target.as_ref().and_then(samples).map_or(self.samples, |expected| expected.min(self.samples))
    }
}

/// A relative error, and how sure it is to be that one has reached it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    pub error: f64,
    /// Below 1.
    pub confidence: f64,
}

/// What became of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Met,
    NotMet,
    /// A few pixels hold all the noise: what is seen of the error says little about the rest.
    NotEstablished,
}

/// A film whose error can be told.
pub trait Followed: Film {
    fn moments(&self) -> &MomentFilm;
}

impl Followed for MomentFilm {
    fn moments(&self) -> &MomentFilm {
        self
    }
}

/// Told how a render that is followed goes on.
pub trait Watcher: Observer {
    /// The error was looked at; `expected` is how many samples per pixel the render will take, as far as one can tell.
    fn looked(&self, _course: &Course, _expected: u64) {}

    /// Between two waves; outside of the render's time.
    fn stepped(&self, _report: &Report, _film: &MomentFilm, _course: &Course) {}
}

impl Watcher for Silent {}

/// Takes a render on until it may stop, noting the error at each checkpoint.
pub fn follow(render: &mut Render, film: &mut impl Followed, until: &Until, watcher: &dyn Watcher) -> Course {
    follow_on(Course::default(), render, film, until, watcher)
}

/// As [`follow`], for a render that has been followed before: it looks and stops as if it had never paused.
pub fn follow_on(mut course: Course, render: &mut Render, film: &mut impl Followed, until: &Until, watcher: &dyn Watcher) -> Course {
    let mut looks = Looks::default();
    let is_met = until.target.is_some_and(|target| course.checkpoints.iter().any(|before| looks.meet(target, Some(before))));
    let (seen, done) = (course.last().map_or(0, |last| last.samples), film.moments().samples());
    if is_met {
        // By an earlier look; what is told of the picture is told of all its samples.
        course.checkpoints.extend((done > seen).then(|| look(render, film)));
        return course;
    }
    let is_ahead = |samples: &u64| *samples > seen && *samples >= done;
    for samples in checkpoints(until.samples).filter(|samples| is_ahead(samples) && until.is_looked_at(*samples)) {
        while render.step(samples, until.time, film, watcher) {
            watcher.stepped(render.report(), film.moments(), &course);
        }
        let reached = film.moments().samples();
        if reached > course.last().map_or(0, |last| last.samples) {
            course.checkpoints.push(look(render, film));
            watcher.looked(&course, until.expected(&course));
        }
        // Cancelled, or out of time: an unplanned moment, at which nothing is decided.
        if reached < samples || until.target.is_some_and(|target| looks.meet(target, course.last())) {
            break;
        }
    }
    course
}

fn look(render: &Render, film: &impl Followed) -> Checkpoint {
    let (film, seconds) = (film.moments(), render.report().elapsed.as_secs_f64());
    Checkpoint { samples: film.samples(), seconds, error: RelativeError::of(film) }
}

/// Looks at an error that stop a render: each has a share of the risk, so that all together keep it.
///
/// αⱼ = α / (j (j + 1)),  Σ αⱼ = α
#[derive(Default)]
struct Looks {
    taken: u32,
}

impl Looks {
    /// Whether the error lies below the target.
    fn meet(&mut self, target: Target, at: Option<&Checkpoint>) -> bool {
        let Some(error) = at.and_then(|checkpoint| checkpoint.error).filter(RelativeError::is_established) else { return false };
        self.taken += 1;
        error.below(1.0 - share(target, self.taken)) <= target.error
    }
}

/// The risk of look j.
fn share(target: Target, look: u32) -> f64 {
    (1.0 - target.confidence) / (f64::from(look) * (f64::from(look) + 1.0))
}

impl Target {
    /// What became of it, as the course of the whole render tells.
    pub fn outcome(&self, course: &Course) -> Outcome {
        let mut looks = Looks::default();
        let met = course.checkpoints.iter().any(|checkpoint| looks.meet(*self, Some(checkpoint)));
        match course.checkpoints.iter().rev().find_map(|checkpoint| checkpoint.error) {
            Some(last) if !last.is_established() => Outcome::NotEstablished,
            Some(_) if met => Outcome::Met,
            _ => Outcome::NotMet,
        }
    }
}
