//! Conversion of panics to errors.

use std::any::Any;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::sync::{Mutex, PoisonError};

use super::text::one_line;
use super::{Error, Result};

/// Message and backtrace of a panic.
pub struct Panic {
    /// Message and source location.
    pub message: String,
    trace: Backtrace,
}

/// First panic that has not been reported yet.
static FIRST: Mutex<Option<Panic>> = Mutex::new(None);

/// Silences the default panic message, for a program that reports panics through [`caught`].
pub fn silence() {
    set_hook(Box::new(|info| {
        let place = info.location().map_or(String::new(), |at| format!(" at {}:{}", within_crate(at.file()), at.line()));
        let message = payload_message(info.payload()) + &place;
        let mut first = FIRST.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert_with(|| Panic { message, trace: Backtrace::capture() });
    }));
}

/// Runs `work` and returns a panic in it, or on a thread that it waits for, as an error. The backtrace is printed if RUST_BACKTRACE
/// is set.
///
/// - `file`: file that the work is about; empty if there is none
///
/// # Errors
/// `Internal` for a panic, and the errors of `work`.
pub fn caught<T>(file: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    unwound(work).unwrap_or_else(|Panic { message, trace }| {
        if trace.status() == BacktraceStatus::Captured {
            let _ = write!(std::io::stderr(), "{trace}");
        }
        let name = if file.is_empty() { String::new() } else { format!("{file}: ") };
        Err(Error::Internal(name + &one_line(&message)))
    })
}

/// Runs `work` and returns its result or its panic.
pub fn unwound<T>(work: impl FnOnce() -> T) -> Result<T, Panic> {
    // Unwind safety: the state that `work` leaves behind is not used after a panic.
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let first = FIRST.lock().unwrap_or_else(PoisonError::into_inner).take();
        first.unwrap_or_else(|| Panic { message: payload_message(&*payload), trace: Backtrace::disabled() })
    })
}

/// Path of a source file within its crate, starting with the name of the crate's folder.
fn within_crate(file: &str) -> &str {
    let folders = file.rfind("/src/").and_then(|src| file[..src].rfind('/'));
    folders.map_or(file, |at| &file[at + 1..])
}

/// Message of a panic payload.
fn payload_message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without words").to_owned()
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;

    #[test]
    fn a_panic_is_an_internal_error_that_names_the_file() {
        let error = caught("a.json", || -> Result<()> { panic!("no {}", "luck") }).expect_err("it panics");
        assert_eq!(error.exit_code(), 6);
        let message = error.to_string();
        assert!(message.starts_with("a.json: no luck") && message.ends_with("(this is a bug in pt, please report it)"), "{message}");
    }

    #[test]
    fn a_panic_on_another_thread_is_caught_too() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
        let work = || pool.install(|| (0..100).into_par_iter().map(|i| if i == 77 { panic!("tile {i}") } else { i }).sum::<i32>());
        assert!(unwound(work).is_err_and(|panic| panic.message.starts_with("tile 77")));
    }

    #[test]
    fn places_are_told_within_their_crate() {
        assert_eq!(within_crate("/home/u/.cargo/registry/src/index/png-0.18.1/src/decoder/a.rs"), "png-0.18.1/src/decoder/a.rs");
        assert_eq!(within_crate("src/error/panic.rs"), "src/error/panic.rs");
    }

    #[test]
    fn what_does_not_panic_passes() {
        assert_eq!(caught("", || Ok(3)).expect("no panic"), 3);
        let refused = caught("", || -> Result<()> { Err(Error::Usage("no".into())) }).expect_err("refused");
        assert_eq!(refused.exit_code(), 2);
    }
}
