//! What can go wrong, in one type: a sentence for the reader, an exit code for the caller.

pub mod memory;
pub mod panic;
pub mod text;

use std::fmt;
use std::path::{Path, PathBuf};

use text::{bounded, one_line};

pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Everything `pt` can fail with; each variant has its own exit code.
///
/// After a scene is built nothing can fail: rendering knows `Option`, not `Result`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// A scene or an asset is wrong; all faults found, in file order, at most [`MAX_FAULTS`].
    #[error("{}", Lines(.0))]
    Invalid(Vec<Fault>),
    /// The scene asks for more than this machine, or pt, can hold.
    #[error("{0}")]
    Limit(Fault),
    /// The operating system said no.
    #[error("{}: {source}", one_line(&path.to_string_lossy()))]
    Io { path: PathBuf, source: std::io::Error },
    /// A bug of ours.
    #[error("{0} (this is a bug in pt, please report it)")]
    Internal(String),
    /// A signal ended the run; the number is the signal's.
    #[error("interrupted")]
    Interrupted(i32),
}

/// How many faults of one file are listed at once.
pub const MAX_FAULTS: usize = 20;

impl Error {
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Error {
        Error::Io { path: path.as_ref().to_owned(), source }
    }

    /// One fault of a scene or asset.
    pub fn invalid(fault: Fault) -> Error {
        Error::Invalid(vec![fault])
    }

    /// The process's exit code: 2 usage, 3 scene or asset, 4 limit, 5 I/O, 6 internal, 128 + signal.
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

    /// The faults as a tool reads them: one entry per line that a person would see.
    pub fn faults(&self) -> Vec<Fault> {
        match self {
            Error::Invalid(faults) => faults.iter().map(Fault::bounded).collect(),
            Error::Limit(fault) => vec![fault.bounded()],
            other => other.to_string().lines().map(Fault::new).collect(),
        }
    }
}

/// One thing that is wrong, and where: `cornell.json:41:17: /materials/glass/eta: expected …, found …`.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Fault {
    /// The file as the user named it; empty where there is none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub file: String,
    /// From 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// From 1, in characters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<usize>,
    /// JSON pointer (RFC 6901); empty where there is none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub pointer: String,
    pub message: String,
}

impl Fault {
    pub fn new(message: impl Into<String>) -> Fault {
        Fault { message: message.into(), ..Fault::default() }
    }

    pub fn in_file(mut self, file: impl AsRef<Path>) -> Fault {
        self.file = file.as_ref().display().to_string();
        self
    }

    pub fn at(mut self, line: usize, column: usize) -> Fault {
        (self.line, self.column) = (Some(line), Some(column));
        self
    }

    pub fn at_line(mut self, line: usize) -> Fault {
        self.line = Some(line);
        self
    }

    pub fn pointing(mut self, pointer: impl Into<String>) -> Fault {
        self.pointer = pointer.into();
        self
    }

    /// The fault, with no text so long that a reader would lose the place in it.
    fn bounded(&self) -> Fault {
        let [file, pointer, message] = [&self.file, &self.pointer, &self.message].map(|text| bounded(text).into_owned());
        Fault { file, pointer, message, ..*self }
    }
}

/// One line, whatever the file holds: control characters are written as escapes.
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
