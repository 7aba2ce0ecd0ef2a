//! Observer of a render: shows progress, writes checkpoints, and tells after the first seconds what a smaller error would take.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::plan::RenderPlan;
use crate::cli::progress::Progress;
use crate::cli::watch::Watch;
use crate::film::{Film, MomentFilm};
use crate::measure::{ErrorHistory, ErrorObserver, Refusal, format};
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
    /// Confidence of the price that is printed once; `None` where no price is to be printed, or after it was printed.
    price: Mutex<Option<f64>>,
    /// Page of the render.
    watch: Option<&'a Watch>,
}

/// Render time after which the render's own samples serve as a pilot for the price of a smaller error.
const PILOT: Duration = Duration::from_secs(5);
/// Remaining time from which the price is worth printing.
const LONG: Duration = Duration::from_secs(60);

/// Smallest limit for the time of the first sample of each pixel; the limit is twice the time of the render.
const MIN_DEADLINE: Duration = Duration::from_secs(10);

impl<'a> CheckpointObserver<'a> {
    /// Observer that prints no price.
    ///
    /// - `time`: time limit of the render, if it starts from the beginning
    pub fn new(progress: &'a Progress, plan: &'a RenderPlan, time: Option<Duration>) -> CheckpointObserver<'a> {
        let now = Instant::now();
        let deadline = time.and_then(|time| now.checked_add(time.saturating_mul(2).max(MIN_DEADLINE)));
        CheckpointObserver { progress, plan, last: Mutex::new(now), deadline, price: Mutex::new(None), watch: None }
    }

    /// Makes the observer of a long render print, after the first seconds, what a smaller error would take.
    pub fn with_price(self, confidence: f64) -> CheckpointObserver<'a> {
        CheckpointObserver { price: Mutex::new(Some(confidence)), ..self }
    }

    /// Makes the observer keep a page up to date.
    pub fn watched(self, watch: Option<&'a Watch>) -> CheckpointObserver<'a> {
        CheckpointObserver { watch, ..self }
    }

    fn print_price(&self, report: &RenderReport, film: &MomentFilm, history: &ErrorHistory) {
        let Ok(mut price) = self.price.lock() else { return };
        let Some(confidence) = *price else { return };
        let is_long = report.elapsed >= PILOT && self.progress.remaining().is_some_and(|seconds| seconds >= LONG.as_secs_f64());
        let Some(history) = is_long.then(|| history.and_now(film, report.elapsed)) else { return };
        let Some(error) = history.last().and_then(|now| now.error) else { return };
        // A pilot with few samples gives no prices yet, however long it took.
        if error.refusal() == Some(Refusal::TooNoisy) {
            return;
        }
        *price = None;
        if let Some(next) = format::next_price(&history, confidence) {
            self.progress.note(&next);
        }
    }

    fn write_checkpoint(&self, report: &RenderReport, film: &MomentFilm, history: &ErrorHistory) {
        let (Some(every), Some(path), Ok(mut last)) = (self.plan.checkpoint_interval, &self.plan.checkpoint, self.last.lock()) else {
            return;
        };
        if last.elapsed() < every {
            return;
        }
        // The render is worth more than its checkpoint. The next checkpoint may succeed, and an error of the last is reported.
        if let Err(error) = part::write(path, &self.plan.about, film, report, history) {
            self.progress.note(&format!("warning: no checkpoint: {error}"));
        }
        *last = Instant::now();
    }
}

impl Observer for CheckpointObserver<'_> {
    fn tile_done(&self, camera_samples: u64) {
        self.progress.tile_done(camera_samples);
        self.watch.iter().for_each(|watch| watch.progress(self.progress));
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
        self.print_price(report, film, history);
        self.write_checkpoint(report, film, history);
        self.watch.iter().for_each(|watch| watch.wave(report, film, history));
    }
}
