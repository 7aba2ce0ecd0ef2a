//! What the render and the thread of the server share.

use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{Semaphore, watch};

use super::picture::ServedPicture;
use super::{Status, Watched};
use crate::output::pace::Pace;

/// What the render and the thread of the server share.
pub struct Shared {
    /// The page.
    pub html: String,
    /// The render.
    pub watched: Arc<dyn Watched>,
    /// The latest state. Each browser that follows the events is a receiver.
    pub status: watch::Sender<Status>,
    /// The latest picture.
    pub picture: Mutex<Option<Arc<ServedPicture>>>,
    /// When the next picture is made.
    pub pace: Mutex<Pace>,
    /// When the next picture with errors is made.
    pub error_pace: Mutex<Pace>,
    /// How often the latest picture was taken.
    pub taken: AtomicUsize,
    /// Places for those who wait for an explanation.
    pub explanations: Arc<Semaphore>,
}

/// The value of a mutex, whatever became of other threads.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
