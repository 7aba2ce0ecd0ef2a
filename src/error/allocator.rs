//! The allocator that ends the program with an error where memory runs out.
#![allow(unsafe_code, reason = "an allocator is an unsafe trait; every call is the system allocator's own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::OnceLock;

use super::memory::may_fail;

/// The exit code of [`Error::Limit`](super::Error::Limit).
const LIMIT: i32 = 4;

/// The system's allocator; where it has no more, the program says so and ends with exit code 4.
///
/// Otherwise a Rust program aborts. Programs make it their `#[global_allocator]`, the library does not: it has no say in that.
pub struct Memory;

/// The line that tells of the end: it is made while there is memory for it.
static MESSAGE: OnceLock<String> = OnceLock::new();

/// Sets the line that is written where [`Memory`] ends the program.
pub fn set_message(line: String) {
    let _ = MESSAGE.set(line + "\n");
}

fn checked(pointer: *mut u8) -> *mut u8 {
    if pointer.is_null() && !may_fail() {
        let line = MESSAGE.get().map_or("error: out of memory\n", String::as_str);
        let _ = std::io::stderr().write_all(line.as_bytes());
        // At once, because what else happens at an exit may allocate.
        signal_hook::low_level::exit(LIMIT);
    }
    pointer
}

// SAFETY: every call is the system allocator's own, with the caller's arguments; what it returns is returned, or nothing is.
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
