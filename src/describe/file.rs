//! Opening what a user named.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::Path;

use crate::{Error, Fault, Result};

/// Opens a regular file, which messages call `name`; a pipe or a device would block or never end, so its kind is asked first.
///
/// # Errors
/// `Invalid` for what is missing or no regular file, `Io` for what may not be read.
pub(super) fn open(path: &Path, name: &str) -> Result<File> {
    let invalid = |message: &str| Error::invalid(Fault::new(message).in_file(name));
    let refused = |error: io::Error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => invalid("no such file"),
        ErrorKind::InvalidInput | ErrorKind::InvalidFilename => invalid("not a file name"),
        _ => Error::io(name, error),
    };
    if !path.metadata().map_err(refused)?.is_file() {
        return Err(invalid("not a regular file"));
    }
    File::open(path).map_err(refused)
}
