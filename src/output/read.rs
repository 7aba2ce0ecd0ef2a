//! Reading of EXR, Radiance HDR, PNG, JPEG, PPM and PFM files, recognised by their content.

use std::path::Path;

use image::ImageFormat;

use super::decode_error::DecodeError;
use super::open::bytes;
use super::{Attributes, exr, hdr, pfm, png};
use crate::error::Result;
use crate::film::Image;

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
        Kind::Hdr => hdr::decode(bytes).map(plain),
        Kind::Pfm => pfm::decode(bytes).map(plain),
        Kind::Encoded(format) => png::decode(bytes, format).map(plain),
    }
}

fn unknown() -> DecodeError {
    DecodeError::Invalid("unknown picture format: expected EXR, HDR, PNG, JPEG, PPM or PFM".into())
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Exr,
    Hdr,
    Pfm,
    Encoded(ImageFormat),
}

impl Kind {
    fn of(bytes: &[u8]) -> Option<Kind> {
        match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => Some(Kind::Exr),
            [b'#', b'?', ..] => Some(Kind::Hdr),
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
            Kind::Hdr => "Radiance HDR",
            Kind::Pfm => "PFM",
            Kind::Encoded(ImageFormat::Png) => "PNG",
            Kind::Encoded(ImageFormat::Jpeg) => "JPEG",
            Kind::Encoded(_) => "PPM",
        }
    }
}
