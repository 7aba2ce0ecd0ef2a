//! Reason why reading a value ended.

use std::fmt::{self, Display};

use serde::de::{self, Expected, Unexpected};

/// Reason why reading a value ended. The location is known one level up, so the fault is reported there.
#[derive(Debug)]
pub(super) enum ReadError {
    /// The fault has been reported.
    Reported,
    /// A fault with this message.
    Because(String),
    /// This key is missing.
    Missing(&'static str),
}

impl std::error::Error for ReadError {}

impl Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ReadError::Reported => f.write_str("already reported"),
            ReadError::Because(message) => f.write_str(message),
            ReadError::Missing(key) => write!(f, "missing key {key:?}"),
        }
    }
}

impl de::Error for ReadError {
    fn custom<T: Display>(message: T) -> ReadError {
        ReadError::Because(message.to_string())
    }

    fn missing_field(key: &'static str) -> ReadError {
        ReadError::Missing(key)
    }

    fn invalid_type(found: Unexpected, expected: &dyn Expected) -> ReadError {
        ReadError::Because(format!("expected {expected}, found {found}"))
    }
}
