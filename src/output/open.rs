//! Opening of files that are read as a whole or piece by piece.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::decode::MOST_MEMORY;
use super::decode_error::DecodeError;
use crate::error::{Error, Fault, Result};

/// Reads a whole file.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>> {
    let mut file = regular(path)?;
    let length = file.metadata().map_err(|e| Error::io(path, e))?.len();
    if length > MOST_MEMORY {
        return Err(DecodeError::TooLarge.of(path));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    file.read_to_end(&mut bytes).map_err(|e| Error::io(path, e))?;
    Ok(bytes)
}

/// Opens a regular file. A pipe or a device would block or never end, so the kind of the file is checked first.
///
/// # Errors
/// `Invalid` for a missing file or one that is not regular, `Io` for a file that may not be read.
pub fn regular(path: &Path) -> Result<File> {
    let invalid = |message: &str| Error::invalid(Fault::new(message).in_file(path));
    let refused = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => invalid("no such file"),
        ErrorKind::InvalidInput | ErrorKind::InvalidFilename => invalid("not a file name"),
        _ => Error::io(path, error),
    };
    if !path.metadata().map_err(refused)?.is_file() {
        return Err(invalid("not a regular file"));
    }
    File::open(path).map_err(refused)
}
