//! `--serve`: the report as a page that grows while the comparison goes on.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::cli::progress::Progress;
use crate::cli::watch::PageAddress;
use crate::cli::{note, print_stderr};
use crate::compare::{Comparison, Follower, Method, report};
use crate::film::Film;
use crate::measure::{ErrorHistory, ErrorObserver};
use crate::output::serve::ReportServer;
use crate::render::Observer;

/// Time between two messages about the progress.
const INTERVAL: Duration = Duration::from_millis(250);

/// The page of a comparison.
pub struct LiveReport {
    server: ReportServer,
    is_stopped: Arc<AtomicBool>,
    /// When the progress was last told.
    last: Mutex<Instant>,
}

impl LiveReport {
    /// Starts the page and prints its address. If that fails there is a warning, and no page.
    pub fn start(address: &PageAddress, scene: &str) -> Option<LiveReport> {
        let is_stopped = Arc::new(AtomicBool::new(false));
        let theirs = is_stopped.clone();
        let stop = move || theirs.store(true, Ordering::Relaxed);
        match ReportServer::start(address.socket, &address.host, report::waiting(scene), Box::new(stop)) {
            Ok(server) => {
                print_stderr(&format!("watch at {}", server.url()));
                Some(LiveReport { server, is_stopped, last: Mutex::new(Instant::now()) })
            }
            Err(error) => {
                note(&format!("warning: no page at {} ({error}); the comparison goes on", address.socket));
                None
            }
        }
    }

    /// Shows the last version and the words that close the comparison, and ends the page.
    pub fn finish(self, comparison: &Comparison, closing: String) {
        self.server.finish(|version| report::live(comparison, version, true).ok(), closing);
    }

    /// Tells how far the work is, some times a second. Called from many threads.
    fn tell(&self, doing: &str, progress: &Progress) {
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() >= INTERVAL {
            *last = Instant::now();
            self.server.tell(doing, progress.share(), progress.elapsed().as_secs_f64(), progress.remaining());
        }
    }
}

/// Progress of a part of the comparison, which the page shows too.
pub struct Told<'a> {
    pub progress: &'a Progress,
    /// What is being done.
    pub doing: &'a str,
    pub live: Option<&'a LiveReport>,
}

impl Observer for Told<'_> {
    fn tile_done(&self, camera_samples: u64) {
        self.progress.tile_done(camera_samples);
        self.live.into_iter().for_each(|live| live.tell(self.doing, self.progress));
    }

    fn wave_done(&self, samples: u64, film: &dyn Film) {
        self.progress.wave_done(samples, film);
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}

impl ErrorObserver for Told<'_> {
    fn error_measured(&self, history: &ErrorHistory, expected: u64) {
        self.progress.error_measured(history, expected);
    }
}

/// Shows the results after each checkpoint.
pub struct Growing<'a, F> {
    pub live: Option<&'a LiveReport>,
    /// The comparison with these results.
    pub comparison: F,
}

impl<F: Fn(Vec<Method>) -> Comparison> Follower for Growing<'_, F> {
    fn checkpoint_done(&self, results: &dyn Fn() -> Vec<Method>) -> bool {
        let Some(live) = self.live else { return true };
        live.server.offer(|version| report::live(&(self.comparison)(results()), version, false).ok());
        !live.is_stopped.load(Ordering::Relaxed)
    }
}
