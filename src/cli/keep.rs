//! What is done for the user while a render goes on: its state is kept from time to time, a long one tells what accuracy will cost.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::pilot;
use super::plan::Plan;
use super::progress::Progress;
use crate::film::{Film, MomentFilm};
use crate::measure::{Checkpoint, Course, RelativeError, Watcher};
use crate::part;
use crate::render::{Observer, Report};

/// Watches a render for its user: shows its progress, and keeps its state.
pub struct Keeper<'a> {
    pub progress: &'a Progress,
    plan: &'a Plan,
    /// How often, and when last.
    every: Option<Duration>,
    last: Mutex<Instant>,
    /// When it is given up where there is no picture at all by then.
    deadline: Option<Instant>,
    prices: Option<Prices<'a>>,
}

/// What is told of a long render, once.
struct Prices<'a> {
    integrator: &'a str,
    confidence: f64,
    told: AtomicBool,
}

/// When a render has gone on for so long, and has so many samples that its error is known, its own samples are a pilot;
const PILOT: Duration = Duration::from_secs(5);
/// their prices are told where there is so much to come that one would rather know what for.
const LONG: Duration = Duration::from_secs(60);

/// The first sample of each pixel may take twice the time that is given to the render, and this at least.
const PATIENCE: Duration = Duration::from_secs(10);

impl<'a> Keeper<'a> {
    /// - `every`: how often the state is kept
    /// - `time`: that is given to a render that begins
    pub fn new(progress: &'a Progress, plan: &'a Plan, every: Option<Duration>, time: Option<Duration>) -> Keeper<'a> {
        let now = Instant::now();
        let deadline = time.and_then(|time| now.checked_add(time.saturating_mul(2).max(PATIENCE)));
        Keeper { progress, plan, every, last: Mutex::new(now), deadline, prices: None }
    }

    /// Tells the price list of a long render, as its first seconds have it.
    pub fn with_prices(self, integrator: &'a str, confidence: f64) -> Keeper<'a> {
        Keeper { prices: Some(Prices { integrator, confidence, told: false.into() }), ..self }
    }

    fn tell_prices(&self, report: &Report, film: &MomentFilm, course: &Course) {
        let Some(prices) = self.prices.as_ref().filter(|prices| !prices.told.load(Ordering::Relaxed)) else { return };
        let is_long = report.elapsed >= PILOT && self.progress.remaining().is_some_and(|seconds| seconds >= LONG.as_secs_f64());
        let Some(error) = is_long.then(|| RelativeError::of(film)).flatten() else { return };
        // However long it took, a pilot of few samples knows no price yet.
        if error.is_established() && error.is_vague() {
            return;
        }
        prices.told.store(true, Ordering::Relaxed);
        let now = Checkpoint { samples: film.samples(), seconds: report.elapsed.as_secs_f64(), error: Some(error) };
        let checkpoints = course.checkpoints.iter().copied().chain([now]).collect();
        self.progress.tell(&pilot::print(&[(prices.integrator, Course { checkpoints })], prices.confidence));
    }

    fn keep(&self, report: &Report, film: &MomentFilm, course: &Course) {
        let (Some(every), Some(path), Ok(mut last)) = (self.every, &self.plan.checkpoint, self.last.lock()) else { return };
        if last.elapsed() < every {
            return;
        }
        // The render is worth more than its checkpoint: the next may succeed, and the last is told of.
        if let Err(error) = part::write(path, &self.plan.about, &[film], report, course) {
            self.progress.tell(&format!("warning: no checkpoint: {error}"));
        }
        *last = Instant::now();
    }
}

impl Observer for Keeper<'_> {
    fn tile_done(&self, camera_samples: u64) {
        self.progress.tile_done(camera_samples);
    }

    fn wave_done(&self, samples: u64, film: &dyn Film) {
        self.progress.wave_done(samples, film);
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled() || self.deadline.is_some_and(|deadline| !self.progress.shows() && Instant::now() >= deadline)
    }
}

impl Watcher for Keeper<'_> {
    fn looked(&self, course: &Course, expected: u64) {
        self.progress.looked(course, expected);
    }

    fn stepped(&self, report: &Report, film: &MomentFilm, course: &Course) {
        self.tell_prices(report, film, course);
        self.keep(report, film, course);
    }
}
