//! `--checkpoint`: the state of a render, written from time to time.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::note;
use super::plan::Plan;
use super::progress::Progress;
use crate::film::{Film, MomentFilm};
use crate::measure::{Course, Watcher};
use crate::part;
use crate::render::{Observer, Report};

/// Watches a render for its user: shows its progress, and keeps its state.
pub struct Keeper<'a> {
    pub progress: &'a Progress,
    plan: &'a Plan,
    /// How often, and when last.
    every: Option<Duration>,
    last: Mutex<Instant>,
}

impl<'a> Keeper<'a> {
    pub fn new(progress: &'a Progress, plan: &'a Plan, every: Option<Duration>) -> Keeper<'a> {
        Keeper { progress, plan, every, last: Mutex::new(Instant::now()) }
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
        self.progress.cancelled()
    }
}

impl Watcher for Keeper<'_> {
    fn looked(&self, course: &Course, expected: u64) {
        self.progress.looked(course, expected);
    }

    fn stepped(&self, report: &Report, film: &MomentFilm, course: &Course) {
        let (Some(every), Some(path), Ok(mut last)) = (self.every, &self.plan.checkpoint, self.last.lock()) else { return };
        if last.elapsed() < every {
            return;
        }
        // The render is worth more than its checkpoint: the next may succeed, and the last is told of.
        if let Err(error) = part::write(path, &self.plan.about, &[film], report, course) {
            note(&format!("warning: no checkpoint: {error}"));
        }
        *last = Instant::now();
    }
}
