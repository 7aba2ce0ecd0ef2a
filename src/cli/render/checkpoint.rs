//! Observer of a render: shows progress, writes checkpoints, and prints the price list of a long render.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::plan::RenderPlan;
use crate::cli::pilot;
use crate::cli::progress::Progress;
use crate::film::{Film, MomentFilm};
use crate::measure::{Checkpoint, ErrorHistory, ErrorObserver, RelativeError};
use crate::part;
use crate::render::{Observer, RenderReport};

/// Observer that shows the progress of a render and saves its state.
pub struct CheckpointObserver<'a> {
    /// Progress display.
    pub progress: &'a Progress,
    plan: &'a RenderPlan,
    last: Mutex<Instant>,
    /// Time at which the render is given up if there is no picture by then.
    deadline: Option<Instant>,
    prices: Option<Prices<'a>>,
}

/// State of the price list, which is printed once.
struct Prices<'a> {
    integrator: &'a str,
    confidence: f64,
    printed: AtomicBool,
}

/// Render time after which the render's own samples serve as a pilot for the price list.
const PILOT: Duration = Duration::from_secs(5);
/// Remaining time from which the price list is worth printing.
const LONG: Duration = Duration::from_secs(60);

/// Smallest limit for the time of the first sample of each pixel; the limit is twice the time of the render.
const MIN_DEADLINE: Duration = Duration::from_secs(10);

impl<'a> CheckpointObserver<'a> {
    /// Observer without a price list.
    ///
    /// - `time`: time limit of the render, if it starts from the beginning
    pub fn new(progress: &'a Progress, plan: &'a RenderPlan, time: Option<Duration>) -> CheckpointObserver<'a> {
        let now = Instant::now();
        let deadline = time.and_then(|time| now.checked_add(time.saturating_mul(2).max(MIN_DEADLINE)));
        CheckpointObserver { progress, plan, last: Mutex::new(now), deadline, prices: None }
    }

    /// Makes the observer print the price list of a long render, from its first seconds.
    pub fn with_prices(self, integrator: &'a str, confidence: f64) -> CheckpointObserver<'a> {
        CheckpointObserver { prices: Some(Prices { integrator, confidence, printed: false.into() }), ..self }
    }

    fn print_prices(&self, report: &RenderReport, film: &MomentFilm, history: &ErrorHistory) {
        let Some(prices) = self.prices.as_ref().filter(|prices| !prices.printed.load(Ordering::Relaxed)) else { return };
        let is_long = report.elapsed >= PILOT && self.progress.remaining().is_some_and(|seconds| seconds >= LONG.as_secs_f64());
        let Some(error) = is_long.then(|| RelativeError::of(film)).flatten() else { return };
        // A pilot with few samples gives no prices yet, however long it took.
        if error.is_established() && error.is_vague() {
            return;
        }
        prices.printed.store(true, Ordering::Relaxed);
        let now = Checkpoint { samples: film.samples(), seconds: report.elapsed.as_secs_f64(), error: Some(error) };
        let checkpoints = history.checkpoints.iter().copied().chain([now]).collect();
        self.progress.note(&pilot::print(&[(prices.integrator, ErrorHistory { checkpoints })], prices.confidence));
    }

    fn write_checkpoint(&self, report: &RenderReport, film: &MomentFilm, history: &ErrorHistory) {
        let (Some(every), Some(path), Ok(mut last)) = (self.plan.checkpoint_interval, &self.plan.checkpoint, self.last.lock()) else {
            return;
        };
        if last.elapsed() < every {
            return;
        }
        // The render is worth more than its checkpoint. The next checkpoint may succeed, and an error of the last is reported.
        if let Err(error) = part::write(path, &self.plan.about, &[film], report, history) {
            self.progress.note(&format!("warning: no checkpoint: {error}"));
        }
        *last = Instant::now();
    }
}

impl Observer for CheckpointObserver<'_> {
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

impl ErrorObserver for CheckpointObserver<'_> {
    fn error_measured(&self, history: &ErrorHistory, expected: u64) {
        self.progress.error_measured(history, expected);
    }

    fn wave_finished(&self, report: &RenderReport, film: &MomentFilm, history: &ErrorHistory) {
        self.print_prices(report, film, history);
        self.write_checkpoint(report, film, history);
    }
}
