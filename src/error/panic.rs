//! Panics, as errors.

use std::any::Any;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::sync::{Mutex, PoisonError};

use super::text::one_line;
use super::{Error, Result};

/// What a panic says, and where it comes from.
pub struct Panic {
    pub said: String,
    trace: Backtrace,
}

/// The panic under way; of several the first.
static SAID: Mutex<Option<Panic>> = Mutex::new(None);

/// Makes panics silent, for a program that reports what it [`caught`].
pub fn silence() {
    set_hook(Box::new(|info| {
        let place = info.location().map_or(String::new(), |at| format!(" at {}:{}", within_crate(at.file()), at.line()));
        let said = words(info.payload()) + &place;
        let mut first = SAID.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert_with(|| Panic { said, trace: Backtrace::capture() });
    }));
}

/// Does some work; a panic in it, on any thread that it waits for, is an error. With RUST_BACKTRACE set it shows where it comes from.
///
/// - `file`: what was worked on, if it is a file
///
/// # Errors
/// `Internal` for a panic, and whatever the work returns.
pub fn caught<T>(file: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    unwound(work).unwrap_or_else(|Panic { said, trace }| {
        if trace.status() == BacktraceStatus::Captured {
            let _ = write!(std::io::stderr(), "{trace}");
        }
        let name = if file.is_empty() { String::new() } else { format!("{file}: ") };
        Err(Error::Internal(name + &one_line(&said)))
    })
}

/// What some work returns, or its panic.
pub fn unwound<T>(work: impl FnOnce() -> T) -> Result<T, Panic> {
    // Whoever reports the panic uses nothing of what the work left behind.
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let first = SAID.lock().unwrap_or_else(PoisonError::into_inner).take();
        first.unwrap_or_else(|| Panic { said: words(&*payload), trace: Backtrace::disabled() })
    })
}

/// The file of a crate, without the folders that hold the crate.
fn within_crate(file: &str) -> &str {
    let folders = file.rfind("/src/").and_then(|src| file[..src].rfind('/'));
    folders.map_or(file, |at| &file[at + 1..])
}

fn words(payload: &(dyn Any + Send)) -> String {
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
        let said = error.to_string();
        assert!(said.starts_with("a.json: no luck") && said.ends_with("(this is a bug in pt, please report it)"), "{said}");
    }

    #[test]
    fn a_panic_on_another_thread_is_caught_too() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
        let work = || pool.install(|| (0..100).into_par_iter().map(|i| if i == 77 { panic!("tile {i}") } else { i }).sum::<i32>());
        assert!(unwound(work).is_err_and(|panic| panic.said.starts_with("tile 77")));
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
