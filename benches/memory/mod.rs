//! Bytes in use by a benchmark: an allocator that counts them.
#![allow(unsafe_code, reason = "an allocator is an unsafe trait; every call is the system allocator's own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, which counts the bytes that are in use and the most that ever were.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is the system allocator's own, with the caller's arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(now, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Bytes that are in use.
pub fn in_use() -> usize {
    NOW.load(Ordering::Relaxed)
}

/// The most bytes that were in use since the last call.
#[allow(dead_code, reason = "not every benchmark asks for it")]
pub fn most() -> usize {
    MOST.swap(in_use(), Ordering::Relaxed)
}
