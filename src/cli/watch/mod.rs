//! `--serve`: a page that shows a render while it goes on.

mod explain;

use std::net::{SocketAddr, ToSocketAddrs};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::progress::Progress;
use super::{note, print_stderr};
use crate::error::{Error, Result};
use crate::film::{Film, Image, MomentFilm};
use crate::measure::{EPSILON, ErrorHistory, format, noisiest_pixels};
use crate::output::serve::{self, Server, Snapshot, WorstPixel};
use crate::render::RenderReport;
use crate::summary::{self, Accuracy};

pub use explain::Explainer;

/// Time between two messages about the progress.
const INTERVAL: Duration = Duration::from_millis(250);
/// Number of pixels in the list of the worst.
const WORST: usize = 8;

/// Where a page is served.
pub struct PageAddress {
    pub socket: SocketAddr,
    /// Name or number that the user gave.
    pub host: String,
}

impl PageAddress {
    /// Address of `--serve`.
    ///
    /// - `is_open`: whether other machines may reach it
    ///
    /// # Errors
    /// `Usage` where pages are not built in, for what is no address, and for one that other machines reach and must not.
    pub fn new(text: &str, is_open: bool) -> Result<PageAddress> {
        if !serve::IS_BUILT {
            return Err(Error::Usage("--serve: this pt is built without it; cargo build --release --features serve has it".into()));
        }
        let expected = |why: String| Error::Usage(format!("--serve {text}: expected HOST:PORT, such as 127.0.0.1:0; {why}"));
        let mut sockets = text.to_socket_addrs().map_err(|e| expected(e.to_string()))?;
        let socket = sockets.next().ok_or_else(|| expected("no such address".into()))?;
        if !socket.ip().is_loopback() && !is_open {
            return Err(Error::Usage(format!("--serve {text}: other machines reach this address; --serve-any allows it")));
        }
        let host = text.rsplit_once(':').map_or(text, |(host, _)| host).to_owned();
        Ok(PageAddress { socket, host })
    }
}

/// The page of a render.
pub struct Watch {
    server: Server,
    explainer: Arc<Explainer>,
    /// Whether the error is that of the picture, and not of a part of its samples.
    tells_error: bool,
    confidence: f64,
    /// When the progress was last told.
    last: Mutex<Instant>,
    /// Number of samples after which the error was last measured.
    measured: AtomicU64,
}

impl Watch {
    /// Starts the page and prints its address. If that fails there is a warning, and no page.
    ///
    /// - `title`: name of the picture
    /// - `tells_error`: whether the error of the samples is that of the picture
    pub fn start(page: &PageAddress, title: &str, explainer: Explainer, tells_error: bool, confidence: f64) -> Option<Watch> {
        let explainer = Arc::new(explainer);
        match Server::start(page.socket, &page.host, title, EPSILON, explainer.clone()) {
            Ok(server) => {
                print_stderr(&format!("watch at {}", server.url()));
                Some(Watch { server, explainer, tells_error, confidence, last: Mutex::new(Instant::now()), measured: AtomicU64::new(0) })
            }
            Err(error) => {
                note(&format!("warning: no page at {} ({error}); the render goes on", page.socket));
                None
            }
        }
    }

    /// Tells how far the render is, some times a second. Called from many threads.
    pub fn progress(&self, progress: &Progress) {
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() >= INTERVAL {
            *last = Instant::now();
            drop(last);
            self.tell(progress);
        }
    }

    fn tell(&self, progress: &Progress) {
        self.server.tell(serve::Progress {
            samples: progress.samples(),
            // Without a number of samples, time or an accuracy ends the render.
            planned: Some(progress.planned()).filter(|planned| *planned < f64::from(u32::MAX)),
            share: progress.share(),
            elapsed: progress.elapsed().as_secs_f64(),
            remaining: progress.remaining(),
        });
    }

    /// Offers the picture after a wave, and tells the error if the render has measured it.
    pub fn wave(&self, report: &RenderReport, film: &MomentFilm, history: &ErrorHistory) {
        self.explainer.takes(film.sample_set());
        if history.last().is_some_and(|last| last.samples > self.measured.load(Ordering::Relaxed)) {
            self.tell_accuracy(film, history);
        }
        let snapshot = || {
            // Between the checkpoints of the render the error is measured where the last one is long ago.
            if self.tells_error && film.samples() >= 2 * self.measured.load(Ordering::Relaxed) {
                self.tell_accuracy(film, &history.and_now(film, report.elapsed));
            }
            self.snapshot(film, film.image())
        };
        self.server.offer(film.mean_samples(), || film.colors(), Some(snapshot).filter(|_| film.freedom() > 0.0));
    }

    /// Shows the last picture and the closing line, and ends the page.
    ///
    /// - `image`: the picture with errors, if it is at hand
    pub fn finish(self, progress: &Progress, film: &MomentFilm, history: &ErrorHistory, image: Option<Image>, closing: String) {
        self.explainer.takes(film.sample_set());
        self.tell(progress);
        self.tell_accuracy(film, history);
        let last = (film.samples() > 0).then(|| self.snapshot(film, image.unwrap_or_else(|| film.image())));
        self.server.finish(last, closing);
    }

    fn snapshot(&self, film: &MomentFilm, image: Image) -> Snapshot {
        let worst = if self.explainer.explains() { noisiest_pixels(film, WORST) } else { vec![] };
        let worst = worst.into_iter().map(|((x, y), share)| WorstPixel { pixel: [x, y], share }).collect();
        Snapshot { samples: film.mean_samples(), image, worst }
    }

    fn tell_accuracy(&self, film: &MomentFilm, history: &ErrorHistory) {
        let samples = history.last().map_or(0, |last| last.samples);
        self.measured.store(samples, Ordering::Relaxed);
        let stated = Accuracy::of(film, history, self.confidence);
        let error = match &stated {
            Accuracy::Stated(error) => Some([error.value, error.low, error.high]),
            Accuracy::Unknown | Accuracy::Untold(_) | Accuracy::Refused(..) => None,
        };
        let words = match &stated {
            _ if !self.tells_error => "these samples are a part of the picture, whose error they do not tell".to_owned(),
            Accuracy::Stated(_) => format::next_price(history, self.confidence).unwrap_or_default(),
            _ => summary::accuracy(&stated, history, self.confidence).trim_start_matches(" · ").to_owned(),
        };
        self.server.tell_accuracy(serve::Accuracy { samples: samples as f64 * film.spec().allocation.mean(), error, words });
    }
}
