//! A page that is made anew from time to time: a report that grows while the work for it goes on.
//!
//! | request | answer |
//! |---|---|
//! | `GET /` | the latest version of the page |
//! | `GET /events` | server-sent events: the [`ReportStatus`] whenever it changes |
//! | `POST /stop` | ends the work soon |

use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use axum::Router;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use tokio::sync::watch;

use super::ReportStatus;
use super::events;
use super::host::Host;
use super::shared::lock;
use crate::output::pace::Pace;

/// Largest share of the time that making pages may take. Comparisons do not measure this time.
const SHARE: f64 = 0.02;

/// What a browser may ask the work to do.
type Stop = Box<dyn Fn() + Send + Sync>;

/// Server of a report that grows.
pub struct ReportServer {
    shared: Arc<Shared>,
    host: Host,
}

/// What the work and the thread of the server share.
struct Shared {
    page: Mutex<Arc<str>>,
    status: watch::Sender<ReportStatus>,
    stop: Stop,
    /// When the next page is made.
    pace: Mutex<Pace>,
    /// How often the latest page was taken.
    taken: AtomicUsize,
}

impl ReportServer {
    /// Starts the server.
    ///
    /// - `address`: where it listens; port 0 is any free one
    /// - `host`: name or number by which the user named the address
    /// - `page`: what is shown before the first report
    /// - `stop`: asks the work to end; it returns at once
    ///
    /// # Errors
    /// Those of the system, such as for a port that is in use.
    pub fn start(address: SocketAddr, host: &str, page: String, stop: Stop) -> io::Result<ReportServer> {
        let shared = Arc::new(Shared {
            page: Mutex::new(page.into()),
            status: watch::Sender::new(ReportStatus::default()),
            stop,
            pace: Mutex::new(Pace::new(SHARE)),
            taken: AtomicUsize::new(0),
        });
        let answers = Router::new().route("/", get(page_now)).route("/events", get(events_from_now)).route("/stop", post(stopped));
        Ok(ReportServer { host: Host::start(address, host, answers.with_state(shared.clone()))?, shared })
    }

    /// The address of the page, with its token.
    pub fn url(&self) -> String {
        self.host.url()
    }

    /// Tells how far the work is.
    ///
    /// - `doing`: what is being done
    /// - `share`: share of it that is done
    /// - `elapsed`, `remaining`: time since its beginning, and estimated time to its end (s)
    pub fn tell(&self, doing: &str, share: f64, elapsed: f64, remaining: Option<f64>) {
        self.shared.status.send_modify(|status| {
            if status.doing != doing {
                status.doing = doing.to_owned();
            }
            (status.share, status.elapsed, status.remaining) = (share, elapsed, remaining);
        });
    }

    /// Shows the next version of the report, unless it is too early, or nobody watches and there is one already. The work waits for it to
    /// be made, which takes at most a fiftieth of the time but for the first and the last version.
    ///
    /// - `page`: makes the page of a version, of which the first is 1
    pub fn offer(&self, page: impl FnOnce(u64) -> Option<String>) {
        let start = Instant::now();
        let is_watched = self.shared.status.receiver_count() > 0;
        let version = self.shared.status.borrow().version;
        if (version > 0 && !is_watched) || lock(&self.shared.pace).is_early(start) {
            return;
        }
        page(version + 1).into_iter().for_each(|page| self.show(page));
        lock(&self.shared.pace).postpone(start.elapsed());
    }

    /// Shows the last version and the words that close the work, and ends the server. It waits a moment for browsers to take them.
    ///
    /// - `page`: makes the page of a version
    pub fn finish(self, page: impl FnOnce(u64) -> Option<String>, closing: String) {
        let watchers = self.shared.status.receiver_count();
        let version = self.shared.status.borrow().version;
        let last = if watchers > 0 { page(version + 1) } else { None };
        let has_page = last.is_some();
        last.into_iter().for_each(|page| self.show(page));
        self.shared.status.send_modify(|status| status.closing = Some(closing));
        let shared = self.shared;
        self.host.end(|| has_page && shared.taken.load(Ordering::Relaxed) < watchers);
    }

    fn show(&self, page: String) {
        *lock(&self.shared.page) = page.into();
        self.shared.taken.store(0, Ordering::Relaxed);
        self.shared.status.send_modify(|status| status.version += 1);
    }
}

async fn page_now(State(shared): State<Arc<Shared>>) -> Response {
    let page = lock(&shared.page).clone();
    shared.taken.fetch_add(1, Ordering::Relaxed);
    ([(CONTENT_TYPE, "text/html; charset=utf-8")], page.to_string()).into_response()
}

async fn events_from_now(State(shared): State<Arc<Shared>>) -> Response {
    events::events(shared.status.subscribe())
}

async fn stopped(State(shared): State<Arc<Shared>>) -> StatusCode {
    (shared.stop)();
    shared.status.send_modify(|status| status.is_stopping = true);
    StatusCode::ACCEPTED
}
