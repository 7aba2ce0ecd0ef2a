//! Long work that the interpreter watches: Ctrl-C ends it, and a callable is told how far it is.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use pt::film::MomentFilm;
use pt::measure::{ErrorHistory, ErrorObserver};
use pt::render::{Observer, RenderReport};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::error::{caught, raised, value};
use crate::integrator::Failure;

/// Time after which the interpreter is asked for signals again.
const POLL: Duration = Duration::from_millis(50);

/// State of a render between two waves.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    samples: u64,
    seconds: f64,
    error: Option<f64>,
    expected: Option<u64>,
}

/// Observer of a render. It is on the thread that renders and its workers, and never takes the interpreter lock.
pub struct Watch {
    cancelled: AtomicBool,
    /// Exceptions in methods that are written in Python, which end the work.
    failures: Vec<Arc<Failure>>,
    events: Sender<Progress>,
}

impl Watch {
    /// Whether the work is to end.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || self.failures.iter().any(|failure| failure.happened())
    }

    /// Ends the work.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    fn send(&self, progress: Progress) {
        // Nobody listens after an exception.
        let _ = self.events.send(progress);
    }
}

impl Observer for Watch {
    fn cancelled(&self) -> bool {
        self.is_cancelled()
    }
}

impl ErrorObserver for Watch {
    fn error_measured(&self, history: &ErrorHistory, expected: u64) {
        if let Some(last) = history.last() {
            let error = last.error.filter(|error| error.refusal().is_none()).map(|error| error.value);
            self.send(Progress { samples: last.samples, seconds: last.seconds, error, expected: Some(expected) });
        }
    }

    fn wave_finished(&self, report: &RenderReport, _: &MomentFilm, history: &ErrorHistory) {
        let error = history.last().and_then(|last| last.error).filter(|error| error.refusal().is_none()).map(|error| error.value);
        self.send(Progress { samples: report.samples, seconds: report.elapsed.as_secs_f64(), error, expected: None });
    }
}

/// Result of work that was watched.
pub struct Watched<T> {
    /// What the work returned.
    pub result: T,
    /// The exception of Ctrl-C, if it ended the work.
    pub interrupt: Option<PyErr>,
}

/// Runs work on a thread of its own, without the interpreter lock. Meanwhile this thread looks for signals and calls `progress`.
///
/// # Errors
/// The errors of the work, and exceptions of `progress`, of `failures` and of signal handlers, which end it. Ctrl-C is no error here.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
    failures: Vec<Arc<Failure>>,
    work: impl FnOnce(&Watch) -> pt::Result<T> + Send,
) -> PyResult<Watched<T>> {
    let (events, received) = channel();
    let watch = Watch { cancelled: AtomicBool::new(false), failures, events };
    let (shared, callable) = (&watch, progress.as_ref());
    let (result, stopped) = py.detach(move || {
        thread::scope(|scope| {
            let (done, finished) = channel::<()>();
            let worker = scope.spawn(move || {
                let result = caught(|| in_pool(threads, || work(shared)));
                drop(done);
                result
            });
            let mut stopped = None;
            loop {
                let ended = matches!(finished.recv_timeout(POLL), Err(RecvTimeoutError::Disconnected));
                let latest = received.try_iter().fold(None, |before: Option<Progress>, now| {
                    let expected = now.expected.or(before.and_then(|before| before.expected));
                    Some(Progress { expected, ..now })
                });
                if stopped.is_none() {
                    stopped = Python::attach(|py| told(py, callable, latest).and_then(|()| py.check_signals()).err());
                    if stopped.is_some() {
                        shared.cancel();
                    }
                }
                if ended {
                    return (worker.join(), stopped);
                }
            }
        })
    });
    let result = result.unwrap_or_else(|_| Err(pt::Error::Internal("the thread that renders ended".into())));
    if let Some(failure) = watch.failures.iter().find_map(|failure| failure.take()) {
        return Err(failure);
    }
    match stopped {
        Some(stopped) if stopped.is_instance_of::<PyKeyboardInterrupt>(py) => {
            result.map(|result| Watched { result, interrupt: Some(stopped) }).map_err(|error| raised(py, &error))
        }
        Some(stopped) => Err(stopped),
        None => result.map(|result| Watched { result, interrupt: None }).map_err(|error| raised(py, &error)),
    }
}

/// Calls the callable with the state of the render, if both are there.
fn told(py: Python<'_>, progress: Option<&Py<PyAny>>, latest: Option<Progress>) -> PyResult<()> {
    let (Some(callable), Some(Progress { samples, seconds, error, expected })) = (progress, latest) else { return Ok(()) };
    let state = value(py, "Progress")?.call1((samples, seconds, error, expected))?;
    callable.call1(py, (state,)).map(drop)
}

/// Runs work on a number of threads of its own, or on those that all renders share.
fn in_pool<T: Send>(threads: Option<usize>, work: impl FnOnce() -> pt::Result<T> + Send) -> pt::Result<T> {
    let Some(threads) = threads else { return work() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let refused = |refusal| pt::Error::Limit(pt::Fault::new(format!("cannot start {threads} threads: {refusal}")));
    pool.map_err(refused)?.install(work)
}
