//! Reason why bytes are not a picture.

use std::path::Path;

use crate::error::{Error, Fault};

/// Reason why bytes are not a picture. [`DecodeError::of`] adds the name of the file.
#[derive(Debug)]
pub(super) enum DecodeError {
    /// The bytes are not a valid picture.
    Invalid(String),
    /// The picture is too large.
    TooLarge,
}

impl DecodeError {
    pub(super) fn of(self, path: &Path) -> Error {
        match self {
            DecodeError::Invalid(message) => Error::invalid(Fault::new(message).in_file(path)),
            DecodeError::TooLarge => Error::Limit(Fault::new("the picture would take more than 4 GiB").in_file(path)),
        }
    }
}
