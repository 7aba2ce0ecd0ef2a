//! JSON with positions: all faults of a file are reported at once, each with line, column and pointer.
//!
//! ```text
//! bytes ─ parse ─▶ Node ─ set (-D) ─▶ Node ─ read ─▶ any `Deserialize` type, and Faults
//! ```
//!
//! Derived types need no changes. Two more forms, which neither buffer nor lose positions, come from `by_type!` (`{"type":
//! "sphere", …}`) and `by_kind!` (a number, or an array, or an object).
//!
//! A fault does not end the reading: it is recorded, a placeholder replaces the value, and reading goes on. Placeholders leave the
//! reader only together with the fault.

mod cursor;
mod de;
mod faults;
mod forms;
mod node;
mod number;
mod parse;
mod read_error;
mod set;
mod suggest;
mod synonyms;
mod write;

pub use cursor::{UnknownKeys, from_json, read, read_options};
pub use faults::{Faults, locate};
pub(crate) use forms::{by_kind, by_type, first_needs_no_type};
pub(crate) use node::escaped;
pub use node::{Location, Member, Node, Value};
pub use parse::{MAX_DEPTH, parse};
pub use suggest::{closest, unknown};
pub use synonyms::SYNONYMS;
