//! Errors: one type with a message for the user and an exit code.

#[cfg(feature = "cli")]
pub mod allocator;
pub mod memory;
#[cfg_attr(not(feature = "cli"), allow(dead_code, reason = "only a program catches every panic in its main function"))]
pub mod panic;
pub mod text;

use std::fmt;
use std::path::{Path, PathBuf};

use text::{bounded, one_line};

/// Result with [`Error`] as the default error.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Error of `pt`. Each variant has its own exit code.
///
/// Nothing can fail after a scene is built: rendering returns `Option`, never `Result`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// A scene or an asset has faults: all that were found, in file order, at most [`MAX_FAULTS`].
    #[error("{}", Lines(.0))]
    Invalid(Vec<Fault>),
    /// The scene exceeds a limit of this machine or of pt.
    #[error("{0}")]
    Limit(Fault),
    /// An operation of the operating system failed.
    #[error("{}: {source}", one_line(&path.to_string_lossy()))]
    Io {
        /// File that the operation was for.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A bug in pt.
    #[error("{0} (this is a bug in pt, please report it)")]
    Internal(String),
    /// A signal ended the run; the number is the signal's.
    #[error("interrupted")]
    Interrupted(i32),
}

/// Greatest number of faults that are listed at once.
pub const MAX_FAULTS: usize = 20;

impl Error {
    /// Error of an operation on a file.
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Error {
        Error::Io { path: path.as_ref().to_owned(), source }
    }

    /// Error of a scene or asset with one fault.
    pub fn invalid(fault: Fault) -> Error {
        Error::Invalid(vec![fault])
    }

    /// Exit code of the process: 2 usage, 3 scene or asset, 4 limit, 5 I/O, 6 internal, 128 + signal.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Usage(_) => 2,
            Error::Invalid(_) => 3,
            Error::Limit(_) => 4,
            Error::Io { .. } => 5,
            Error::Internal(_) => 6,
            Error::Interrupted(signal) => 128u8.saturating_add(*signal as u8),
        }
    }

    /// Faults in a form for tools: one entry per line of the message.
    pub fn faults(&self) -> Vec<Fault> {
        match self {
            Error::Invalid(faults) => faults.iter().map(Fault::bounded).collect(),
            Error::Limit(fault) => vec![fault.bounded()],
            other => other.to_string().lines().map(Fault::new).collect(),
        }
    }
}

/// One fault and its location: `cornell.json:41:17: /materials/glass/eta: expected …, found …`.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Fault {
    /// File as the user named it; empty if there is none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub file: String,
    /// Line, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Column in characters, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<usize>,
    /// JSON pointer (RFC 6901) to the faulty value; empty if there is none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub pointer: String,
    /// Description of the fault.
    pub message: String,
}

impl Fault {
    /// A fault without a location.
    pub fn new(message: impl Into<String>) -> Fault {
        Fault { message: message.into(), ..Fault::default() }
    }

    /// The fault in a file.
    pub fn in_file(mut self, file: impl AsRef<Path>) -> Fault {
        self.file = file.as_ref().display().to_string();
        self
    }

    /// The fault at a line and column.
    pub fn at(mut self, line: usize, column: usize) -> Fault {
        (self.line, self.column) = (Some(line), Some(column));
        self
    }

    /// The fault at a line.
    pub fn at_line(mut self, line: usize) -> Fault {
        self.line = Some(line);
        self
    }

    /// The fault with a JSON pointer to the faulty value.
    pub fn pointing(mut self, pointer: impl Into<String>) -> Fault {
        self.pointer = pointer.into();
        self
    }

    /// The fault with overlong texts shortened.
    fn bounded(&self) -> Fault {
        let [file, pointer, message] = [&self.file, &self.pointer, &self.message].map(|text| bounded(text).into_owned());
        Fault { file, pointer, message, ..*self }
    }
}

/// Writes the fault on one line, with control characters as escapes.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let file = one_line(&self.file);
        let place =
            [Some(file.into_owned()).filter(|s| !s.is_empty()), self.line.map(|n| n.to_string()), self.column.map(|n| n.to_string())];
        let place: Vec<String> = place.into_iter().flatten().collect();
        if !place.is_empty() {
            write!(f, "{}: ", place.join(":"))?;
        }
        if !self.pointer.is_empty() {
            write!(f, "{}: ", one_line(&self.pointer))?;
        }
        f.write_str(&one_line(&self.message))
    }
}

struct Lines<'a>(&'a [Fault]);

impl fmt::Display for Lines<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{fault}")?;
        }
        Ok(())
    }
}
