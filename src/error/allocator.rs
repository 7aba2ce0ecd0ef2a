//! The allocator that ends the program with an error where memory runs out.
#![allow(unsafe_code, reason = "an allocator is an unsafe trait; every call is the system allocator's own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use super::memory::may_fail;

/// The exit code of [`Error::Limit`](super::Error::Limit).
const LIMIT: i32 = 4;

/// The system's allocator. When no memory is left, it prints a message and ends the program with exit code 4.
///
/// Without it a Rust program aborts. A program makes it its `#[global_allocator]`; a library must not make that choice.
pub struct Memory;

/// The message that no memory is left. It is made in advance, while there is memory for it.
static MESSAGE: OnceLock<String> = OnceLock::new();

/// Sets the line that [`Memory`] writes when it ends the program.
pub fn set_message(line: String) {
    let _ = MESSAGE.set(line + "\n");
}

/// Whether a thread is ending the program.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

fn checked(pointer: *mut u8) -> *mut u8 {
    if pointer.is_null() && !may_fail() {
        // Memory often ends for several threads at once. One of them tells it, and the others wait for the end.
        while IS_ENDING.swap(true, Ordering::AcqRel) {
            std::thread::yield_now();
        }
        let line = MESSAGE.get().map_or("error: out of memory\n", String::as_str);
        let _ = std::io::stderr().write_all(line.as_bytes());
        // `_exit` and not `exit`, because the cleanup of an ordinary exit may allocate.
        signal_hook::low_level::exit(LIMIT);
    }
    pointer
}

// SAFETY: every call is the system allocator's own, with the caller's arguments, and its pointer is returned.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        checked(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        checked(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        checked(unsafe { System.realloc(pointer, layout, size) })
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}
