//! Reading of EXR, PNG, JPEG, PPM and PFM files, recognised by their content.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use glam::UVec2;
use image::ImageFormat;

use super::decode::MOST_MEMORY;
use super::{Attributes, exr, pfm, png};
use crate::error::{Error, Fault, Result};
use crate::film::{Channel, Image};

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

/// Reads a picture as linear values, and the attributes that an EXR carries. The format is found from the first bytes, not from the
/// name.
///
/// - PNG, JPEG and PPM are decoded from sRGB
/// - of an EXR with several parts the first is read
///
/// # Errors
/// `Invalid` for a missing file or one that is not a picture, `Limit` for more than 4 GiB, `Io` for a file that may not be read.
pub fn read(path: &Path) -> Result<(Image, Attributes)> {
    decode(&bytes(path)?).map_err(|refusal| refusal.of(path))
}

/// Facts about how a file stores a picture, as names and values for people: format, size, and the whole header of an EXR.
///
/// # Errors
/// The errors of [`read`].
pub fn facts(path: &Path) -> Result<Vec<(String, String)>> {
    let bytes = bytes(path)?;
    let kind = Kind::of(&bytes).ok_or_else(|| unknown().of(path))?;
    let mut facts = vec![("file".to_owned(), format!("{}, {} bytes", kind.title(), bytes.len()))];
    if kind == Kind::Exr {
        facts.extend(exr::facts(&bytes));
    }
    Ok(facts)
}

fn decode(bytes: &[u8]) -> Result<(Image, Attributes), DecodeError> {
    let plain = |image| (image, vec![]);
    match Kind::of(bytes).ok_or_else(unknown)? {
        Kind::Exr => exr::decode(bytes),
        Kind::Pfm => pfm::decode(bytes).map(plain),
        Kind::Encoded(format) => png::decode(bytes, format).map(plain),
    }
}

fn unknown() -> DecodeError {
    DecodeError::Invalid("unknown picture format: expected EXR, PNG, JPEG, PPM or PFM".into())
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Exr,
    Pfm,
    Encoded(ImageFormat),
}

impl Kind {
    fn of(bytes: &[u8]) -> Option<Kind> {
        match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => Some(Kind::Exr),
            [b'P', b'F' | b'f', ..] => Some(Kind::Pfm),
            [0x89, b'P', b'N', b'G', ..] => Some(Kind::Encoded(ImageFormat::Png)),
            [0xff, 0xd8, 0xff, ..] => Some(Kind::Encoded(ImageFormat::Jpeg)),
            [b'P', b'1'..=b'6', ..] => Some(Kind::Encoded(ImageFormat::Pnm)),
            _ => None,
        }
    }

    fn title(self) -> &'static str {
        match self {
            Kind::Exr => "OpenEXR",
            Kind::Pfm => "PFM",
            Kind::Encoded(ImageFormat::Png) => "PNG",
            Kind::Encoded(ImageFormat::Jpeg) => "JPEG",
            Kind::Encoded(_) => "PPM",
        }
    }
}

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

/// Whole picture with `R`, `G`, `B`.
pub(super) fn rgb_image(size: UVec2, pixels: &[[f32; 3]]) -> Image {
    let channel = |(c, name): (usize, &str)| Channel { name: name.into(), values: pixels.iter().map(|p| p[c]).collect() };
    Image { full_size: size, origin: UVec2::ZERO, size, channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
}
