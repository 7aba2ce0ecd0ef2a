//! Interrupts: the first ends the render and keeps its picture; one that comes more than a second later ends the program.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
#[cfg(unix)]
use signal_hook::flag::register;
use signal_hook::flag::{register_conditional_shutdown, register_usize};

use crate::error::{Error, Fault, Result};

/// Number of the caught signal; 0 for none.
static CAUGHT: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// Signals within this time count as one: `timeout` and terminals signal a process and its group.
const SAME_SIGNAL: Duration = Duration::from_secs(1);
/// Time between checks for the first signal.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Catches signals of users, of the system, and of terminals that close, from now on.
///
/// # Errors
/// `Internal` if the system refuses; `Limit` if it has no thread left.
pub fn catch() -> Result<()> {
    if CAUGHT.get().is_some() {
        return Ok(());
    }
    let caught = CAUGHT.get_or_init(Arc::default);
    let is_final = Arc::new(AtomicBool::new(false));
    for signal in signals() {
        // The order matters: the first signal that is caught must not end the program.
        register_conditional_shutdown(signal, 128 + signal, is_final.clone())
            .and_then(|_| register_usize(signal, caught.clone(), signal as usize))
            .map_err(|e| Error::Internal(format!("cannot catch signal {signal}: {e}")))?;
    }
    let wait = move || {
        while self::caught().is_none() {
            thread::sleep(POLL_INTERVAL);
        }
        thread::sleep(SAME_SIGNAL);
        is_final.store(true, Ordering::Relaxed);
    };
    let started = thread::Builder::new().name("signals".into()).spawn(wait);
    started.map(drop).map_err(|e| Error::Limit(Fault::new(format!("cannot start a thread: {e}"))))
}

/// Ends the render as an interrupt by the user does.
pub fn interrupt() {
    CAUGHT.get_or_init(Arc::default).store(SIGINT as usize, Ordering::Relaxed);
}

/// Number of the caught signal, if there was one.
pub fn caught() -> Option<i32> {
    let number = CAUGHT.get()?.load(Ordering::Relaxed);
    (number != 0).then_some(number as i32)
}

/// Makes a file that exceeds the system's limit an error of writing, like a full disk, instead of ending the program.
pub fn let_writing_fail() {
    #[cfg(unix)]
    let _ = register(signal_hook::consts::SIGXFSZ, Arc::default());
}

fn signals() -> impl Iterator<Item = i32> {
    #[cfg(unix)]
    let hangup = Some(signal_hook::consts::SIGHUP).filter(|signal| !is_ignored(*signal));
    #[cfg(not(unix))]
    let hangup = None;
    [SIGINT, SIGTERM].into_iter().chain(hangup)
}

/// Whether pt was started with this signal ignored, as `nohup` does with SIGHUP; `false` if that is unknown.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    (mask >> (signal - 1)) & 1 == 1
}
