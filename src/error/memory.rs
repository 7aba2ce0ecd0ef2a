//! Allocations that may fail.

use std::cell::Cell;

thread_local! {
    static FALLIBLE: Cell<bool> = const { Cell::new(false) };
}

/// Does work whose allocations may fail: `try_reserve` returns its error, as it does without [`Memory`](crate::Memory).
pub fn fallible<T>(work: impl FnOnce() -> T) -> T {
    FALLIBLE.set(true);
    let answer = work();
    FALLIBLE.set(false);
    answer
}

/// Whether this number of bytes can be allocated now.
pub fn can_be_had(bytes: u128) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| fallible(|| Vec::<u8>::new().try_reserve_exact(bytes).is_ok()))
}

/// Whether the work at hand expects that an allocation may fail; `false` where the thread is about to end.
#[cfg(feature = "cli")]
pub fn may_fail() -> bool {
    FALLIBLE.try_with(Cell::get).unwrap_or(false)
}
