//! Interrupts: the first ends the render and keeps its picture, the second ends the program.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown, register_usize};

use crate::error::{Error, Result};

/// The number of the signal that came; 0 for none.
static CAUGHT: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// From here on.
///
/// # Errors
/// `Internal` where the system does not let us.
pub fn catch() -> Result<()> {
    let caught = CAUGHT.get_or_init(Arc::default);
    let again = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal sets the flag that makes the second one final.
        register_conditional_shutdown(signal, 128 + signal, again.clone())
            .and_then(|_| register(signal, again.clone()))
            .and_then(|_| register_usize(signal, caught.clone(), signal as usize))
            .map_err(|e| Error::Internal(format!("cannot catch signal {signal}: {e}")))?;
    }
    Ok(())
}

/// The signal that came, if one did.
pub fn caught() -> Option<i32> {
    let number = CAUGHT.get()?.load(Ordering::Relaxed);
    (number != 0).then_some(number as i32)
}

/// Makes a file that outgrows the system's limit an error of writing, as a full disk is one, and not the end of the program.
pub fn let_writing_fail() {
    #[cfg(unix)]
    let _ = register(signal_hook::consts::SIGXFSZ, Arc::default());
}
