//! Progress of a render, for a person at a terminal, for a log, or for a program.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::parse::threads;
use super::{is_quiet, note, print_stderr, signals};
use crate::film::{Film, FilmSpec};
use crate::measure::{ErrorHistory, ErrorObserver};
use crate::render::{Observer, RenderReport};
use clap::ValueEnum;

/// Threads and progress.
#[derive(clap::Args, Clone, Debug)]
pub struct WorkArgs {
    /// Number of threads. Default: all cores. The picture does not depend on it.
    #[arg(short, long, env = "PT_THREADS", alias = "nthreads", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
    /// Form of the progress on stderr; `auto` is a bar on a terminal and a line every few seconds elsewhere.
    #[arg(long, value_enum, default_value_t = ProgressForm::Auto)]
    pub progress: ProgressForm,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressForm {
    Auto,
    Bar,
    /// One JSON object per line.
    Json,
    None,
}

/// Observer that shows progress and passes interrupts on to the render.
pub struct Progress {
    style: Style,
    start: Instant,
    /// Expected number of camera samples, all pixels together.
    total: AtomicU64,
    /// Render time, if time ends the render.
    limit: Option<Duration>,
    done: AtomicU64,
    /// Rounds of samples that the picture has so far.
    whole: AtomicU64,
    pixels: u64,
    /// Camera samples of one round.
    round: u64,
    last: Mutex<Instant>,
}

enum Style {
    Bar(ProgressBar),
    Lines(Duration),
    Json(Duration),
    Silent,
}

impl Progress {
    /// Starts the display.
    ///
    /// - `rounds`: expected number of rounds; a round is one sample per pixel unless the film's allocation says otherwise
    pub fn new(choice: ProgressForm, film: &FilmSpec, rounds: u64, limit: Option<Duration>) -> Progress {
        let style = match choice {
            ProgressForm::Auto if is_quiet() => Style::Silent,
            ProgressForm::Auto if std::io::stderr().is_terminal() => Style::Bar(bar()),
            ProgressForm::Auto => Style::Lines(Duration::from_secs(3)),
            ProgressForm::Bar => Style::Bar(bar()),
            ProgressForm::Json => Style::Json(Duration::from_millis(250)),
            ProgressForm::None => Style::Silent,
        };
        let pixels = film.crop.pixel_count();
        let round = (film.allocation.mean() * pixels as f64).round() as u64;
        let (start, total) = (Instant::now(), round.saturating_mul(rounds));
        let progress =
            Progress { style, start, total: total.into(), limit, done: 0.into(), whole: 0.into(), pixels, round, last: Mutex::new(start) };
        if let Style::Bar(bar) = &progress.style {
            bar.set_length(1000);
        }
        progress
    }

    /// Adds the work of a previous run.
    pub fn resumed(self, before: &RenderReport) -> Progress {
        let start = self.start.checked_sub(before.elapsed).unwrap_or(self.start);
        Progress { start, done: before.samples.saturating_mul(self.pixels).into(), ..self }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        match &self.style {
            Style::Bar(bar) => bar.finish_and_clear(),
            Style::Json(_) => print_stderr(&self.json()),
            Style::Lines(_) | Style::Silent => {}
        }
    }

    /// Prints lines on stderr, above the bar.
    pub fn note(&self, text: &str) {
        match &self.style {
            Style::Bar(bar) => bar.suspend(|| note(text)),
            Style::Lines(_) | Style::Json(_) | Style::Silent => note(text),
        }
    }

    /// Share of the work that is done, by samples or by time.
    pub fn share(&self) -> f64 {
        let by_samples = self.done.load(Ordering::Relaxed) as f64 / self.total.load(Ordering::Relaxed).max(1) as f64;
        let by_time = self.limit.map_or(0.0, |limit| self.start.elapsed().as_secs_f64() / limit.as_secs_f64());
        by_samples.max(by_time).min(1.0)
    }

    /// Whether there is a picture: this run has at least one sample of each pixel.
    pub fn shows(&self) -> bool {
        self.whole.load(Ordering::Relaxed) > 0
    }

    /// Estimated remaining time (seconds).
    pub fn remaining(&self) -> Option<f64> {
        let share = self.share();
        (share > 0.0).then(|| self.start.elapsed().as_secs_f64() * (1.0 - share) / share)
    }

    /// Samples per pixel so far.
    pub fn samples(&self) -> f64 {
        self.done.load(Ordering::Relaxed) as f64 / self.pixels.max(1) as f64
    }

    /// Expected number of samples per pixel.
    pub fn planned(&self) -> f64 {
        self.total.load(Ordering::Relaxed) as f64 / self.pixels.max(1) as f64
    }

    /// Time since the beginning.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    fn words(&self) -> String {
        let spp = self.samples();
        let eta = self.remaining().map_or("?".into(), |s| format!("{s:.1} s"));
        format!("{spp:.1} spp, {:.1} s elapsed, {eta} left", self.start.elapsed().as_secs_f64())
    }

    fn json(&self) -> String {
        serde_json::json!({
            "spp": self.whole.load(Ordering::Relaxed) * self.round / self.pixels.max(1),
            "camera_samples": self.done.load(Ordering::Relaxed),
            "share": self.share(),
            "elapsed": self.start.elapsed().as_secs_f64(),
            "remaining": self.remaining(),
        })
        .to_string()
    }

    /// Returns whether to show progress now: true for at most one thread, and at most this often.
    fn due(&self, every: Duration) -> bool {
        let Ok(mut last) = self.last.try_lock() else { return false };
        let due = last.elapsed() >= every;
        if due {
            *last = Instant::now();
        }
        due
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template("[{bar:32}] {msg}").unwrap_or(ProgressStyle::default_bar());
    bar.with_style(style.progress_chars("=> "))
}

impl ErrorObserver for Progress {
    fn error_measured(&self, _: &ErrorHistory, expected: u64) {
        self.total.store(self.round.saturating_mul(expected), Ordering::Relaxed);
    }
}

impl Observer for Progress {
    fn tile_done(&self, camera_samples: u64) {
        self.done.fetch_add(camera_samples, Ordering::Relaxed);
        match &self.style {
            Style::Bar(bar) if self.due(Duration::from_millis(100)) => {
                bar.set_position((1000.0 * self.share()) as u64);
                bar.set_message(self.words());
            }
            Style::Lines(every) if self.due(*every) => note(&format!("{:3.0} %  {}", 100.0 * self.share(), self.words())),
            Style::Json(every) if self.due(*every) => print_stderr(&self.json()),
            _ => {}
        }
    }

    fn wave_done(&self, samples: u64, _: &dyn Film) {
        self.whole.store(samples, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        signals::caught().is_some()
    }
}
