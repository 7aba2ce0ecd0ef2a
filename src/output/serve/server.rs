//! The server, as the render sees it.

use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::sync::{Semaphore, watch};

use super::host::Host;
use super::picture::ServedPicture;
use super::shared::{Shared, lock};
use super::{Accuracy, PictureVersion, Progress, Snapshot, Status, Watched, WorstPixel, page, routes};
use crate::film::Image;
use crate::output::pace::Pace;

/// Largest share of the time that pictures may take, and again that those with errors may take. With the first and the last picture, and
/// with sending, a page then costs about 1 %: `cargo bench --bench viewer -- page`.
const SHARE: f64 = 0.003;
/// Time before the first picture with errors, so that a short render does not pay for it.
const FIRST_ERRORS: Duration = Duration::from_secs(10);
/// Explanations of pixels that may wait for the one thread that makes them.
const WAITING: usize = 4;

/// Server of the page of a render.
pub struct Server {
    shared: Arc<Shared>,
    host: Host,
}

impl Server {
    /// Starts the server.
    ///
    /// - `address`: where it listens; port 0 is any free one
    /// - `host`: name or number by which the user named the address
    /// - `title`: name of the picture
    /// - `epsilon`: ε of relative errors, √(σ²/(r² + ε·mean²))
    ///
    /// # Errors
    /// Those of the system, such as for a port that is in use.
    pub fn start(address: SocketAddr, host: &str, title: &str, epsilon: f64, watched: Arc<dyn Watched>) -> io::Result<Server> {
        let shared = Arc::new(Shared {
            html: page::html(title, epsilon),
            watched,
            status: watch::Sender::new(Status::default()),
            picture: Mutex::default(),
            pace: Mutex::new(Pace::new(SHARE)),
            error_pace: Mutex::new(Pace::new(SHARE).after(FIRST_ERRORS)),
            taken: AtomicUsize::new(0),
            explanations: Arc::new(Semaphore::new(WAITING)),
        });
        Ok(Server { host: Host::start(address, host, routes::router(shared.clone()))?, shared })
    }

    /// The address of the page, with its token.
    pub fn url(&self) -> String {
        self.host.url()
    }

    /// Tells how far the render is.
    pub fn tell(&self, progress: Progress) {
        self.shared.status.send_modify(|status| status.progress = progress);
    }

    /// Tells what is known of the error.
    pub fn tell_accuracy(&self, accuracy: Accuracy) {
        self.shared.status.send_modify(|status| status.accuracy = accuracy);
    }

    /// Shows a picture, unless it is too early, or nobody watches and there is one already that has half of the samples or more. Making it
    /// (in real time, since a render waits for it) and sending it take at most about 0.6 % of the time: one half for
    /// pictures alone, which are quickly made, and one half for those with errors, which are made more seldom.
    ///
    /// - `samples`: samples per pixel
    /// - `colors`: makes the picture alone
    /// - `snapshot`: makes the picture with the errors of its pixels, if these are known
    pub fn offer(&self, samples: f64, colors: impl FnOnce() -> Image, snapshot: Option<impl FnOnce() -> Snapshot>) {
        let start = Instant::now();
        let is_watched = self.shared.status.receiver_count() > 0;
        let is_doubled = self.shared.status.borrow().picture.as_ref().is_none_or(|shown| samples >= 2.0 * shown.samples);
        if !(is_watched || is_doubled) {
            return;
        }
        let snapshot = snapshot.filter(|_| !lock(&self.shared.error_pace).is_early(start));
        if let Some(snapshot) = snapshot {
            let snapshot = snapshot();
            lock(&self.shared.error_pace).postpone(start.elapsed());
            self.show(samples, snapshot.image, Some(snapshot.worst));
        } else if !lock(&self.shared.pace).is_early(start) {
            let image = colors();
            lock(&self.shared.pace).postpone(start.elapsed());
            self.show(samples, image, None);
        }
    }

    /// Shows a picture.
    ///
    /// - `worst`: the worst pixels, if they are known anew
    fn show(&self, samples: f64, image: Image, worst: Option<Vec<WorstPixel>>) {
        let number = self.shared.status.borrow().picture.as_ref().map_or(0, |shown| shown.number) + 1;
        let version = PictureVersion { number, samples, origin: image.origin.to_array(), size: image.size.to_array() };
        let forgotten = lock(&self.shared.picture).replace(Arc::new(ServedPicture::new(number, image)));
        self.shared.taken.store(0, Ordering::Relaxed);
        self.shared.status.send_modify(|status| {
            status.picture = Some(version);
            status.worst = worst.unwrap_or_else(|| std::mem::take(&mut status.worst));
        });
        // Dropped outside of the lock, as it may be large.
        drop(forgotten);
    }

    /// Shows the last picture and the words that close the render, and ends the server. It waits a moment for browsers to take them.
    ///
    /// - `last`: the last picture, if there is one
    pub fn finish(self, last: Option<Snapshot>, closing: String) {
        let watchers = self.shared.status.receiver_count();
        let has_picture = last.is_some();
        last.into_iter().for_each(|last| self.show(last.samples, last.image, Some(last.worst)));
        self.shared.status.send_modify(|status| status.closing = Some(closing));
        let shared = self.shared;
        self.host.end(|| has_picture && shared.taken.load(Ordering::Relaxed) < watchers);
    }
}
