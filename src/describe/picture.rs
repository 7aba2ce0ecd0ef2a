//! Reads the pixels of textures from picture files: PNG, JPEG, WebP, OpenEXR and Radiance HDR, recognised by content.

use std::io::Read;
use std::path::Path;

use glam::UVec2;
use image::{ColorType, DynamicImage, ImageFormat};

use super::file::open;
use crate::format::{Channel, Encoding, decoded};
use crate::output::decode::{MOST_MEMORY, Undecoded, decode};
use crate::texture::image::Pixels;
use crate::{Error, Fault, Result};

/// Reads the picture in a file. Returns it with warnings, which are sentences that begin with `name`.
///
/// The content of the file decides its format.
///
/// - `channel`: the channel that all three values of a pixel are taken from; without one the colour is read and opacity ignored
///
/// # Errors
/// `Invalid` where the file is missing, not regular, of another format or malformed, or has a value that is negative or not finite;
/// `Limit` where the picture would take more than 4 GiB; `Io` where the file cannot be read.
pub fn load(path: &Path, name: &str, encoding: Encoding, channel: Option<Channel>) -> Result<(Pixels, Vec<String>)> {
    let mut file = open(path, name)?;
    let mut bytes = vec![];
    file.by_ref().take(LOOK).read_to_end(&mut bytes).map_err(|e| Error::io(name, e))?;
    // A large file of another format is not read.
    format_of(&bytes, name)?;
    if file.metadata().map_err(|e| Error::io(name, e))?.len() > MOST_MEMORY {
        return Err(too_large(name));
    }
    file.read_to_end(&mut bytes).map_err(|e| Error::io(name, e))?;
    read(&bytes, name, encoding, channel)
}

/// Reads the picture in the bytes of a file as [`load`] does.
///
/// # Errors
/// Those of [`load`].
pub fn read(bytes: &[u8], name: &str, encoding: Encoding, channel: Option<Channel>) -> Result<(Pixels, Vec<String>)> {
    let format = format_of(bytes, name)?;
    let mut warnings = vec![];
    if ImageFormat::from_path(name).ok() != Some(format) {
        warnings.push(format!("{name}: read as {}, which its first bytes say it is", title(format)));
    }
    let picture = decode(bytes, format).map_err(|refusal| match refusal {
        Undecoded::TooLarge => too_large(name),
        Undecoded::Invalid(why) => invalid(name, &format!("not a usable {} picture: {why}", title(format))),
    })?;
    Ok((pixels(picture, encoding, channel, name)?, warnings))
}

/// The number of bytes at the beginning of a file that tell its format.
const LOOK: u64 = 64;

/// The format of a picture that begins with these bytes.
///
/// # Errors
/// `Invalid` for one that is not read.
fn format_of(start: &[u8], name: &str) -> Result<ImageFormat> {
    if is_deep(start) {
        return Err(invalid(name, "a deep OpenEXR picture, with several values in a pixel: flatten it in a compositing program first"));
    }
    let found = image::guess_format(start).ok();
    found.filter(is_read).ok_or_else(|| {
        let found = found.map_or("an unknown format".to_owned(), title);
        invalid(name, &format!("expected a picture in {READ}, found {found}"))
    })
}

/// Whether a file that begins with these bytes is a deep OpenEXR picture, which pt does not read: bit 11 of the version.
///
/// Source: *OpenEXR File Layout*, "Version Field".
fn is_deep(start: &[u8]) -> bool {
    start.starts_with(b"\x76\x2f\x31\x01") && start.get(5).is_some_and(|flags| flags & 0x08 != 0)
}

fn too_large(name: &str) -> Error {
    Error::Limit(Fault::new("the picture would take more than 4 GiB").in_file(name))
}

fn invalid(name: &str, message: &str) -> Error {
    Error::invalid(Fault::new(message).in_file(name))
}

/// The formats that are read, as text for messages.
pub const READ: &str = "PNG, JPEG, WebP, OpenEXR or Radiance HDR";

fn is_read(format: &ImageFormat) -> bool {
    matches!(format, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP | ImageFormat::OpenExr | ImageFormat::Hdr)
}

/// The name of a format, for messages.
fn title(format: ImageFormat) -> String {
    match format {
        ImageFormat::WebP => "WebP".to_owned(),
        ImageFormat::OpenExr => "OpenEXR".to_owned(),
        ImageFormat::Jpeg => "JPEG".to_owned(),
        ImageFormat::Hdr => "Radiance HDR".to_owned(),
        other => other.extensions_str().first().map_or("an unknown format".to_owned(), |extension| extension.to_uppercase()),
    }
}

/// The first bytes of texture formats for graphics cards (Khronos, *KTX File Format*, 1 and 2; Basis Universal), which are not read.
const FOR_CARDS: [(&[u8], &str); 3] = [(b"\xABKTX 20\xBB", "KTX2"), (b"\xABKTX 11\xBB", "KTX"), (b"sB\x13\0", "Basis Universal")];

/// The name of the format of a picture that begins with these bytes; `None` if pt reads it.
pub fn unread_format(start: &[u8]) -> Option<String> {
    if let Some((_, name)) = FOR_CARDS.iter().find(|(magic, _)| start.starts_with(magic)) {
        return Some((*name).to_owned());
    }
    match image::guess_format(start) {
        Ok(format) if is_read(&format) => None,
        Ok(other) => Some(title(other)),
        Err(_) => Some("an unknown format".to_owned()),
    }
}

fn pixels(picture: DynamicImage, encoding: Encoding, channel: Option<Channel>, name: &str) -> Result<Pixels> {
    let size = UVec2::new(picture.width(), picture.height());
    let is_float = matches!(picture.color(), ColorType::Rgb32F | ColorType::Rgba32F);
    let is_srgb = match encoding {
        Encoding::Auto => !is_float,
        Encoding::Srgb => true,
        Encoding::Linear => false,
    };
    let linear = |share: f64| if is_srgb { decoded(share) as f32 } else { share as f32 };
    let picked = |values: Vec<[f32; 3]>, k: usize| values.into_iter().map(|rgb| [rgb[k]; 3]).collect();
    let values: Vec<[f32; 3]> = match picture {
        _ if channel == Some(Channel::A) => picture.into_rgba32f().pixels().map(|p| [p.0[3]; 3]).collect(),
        DynamicImage::ImageLuma8(_) | DynamicImage::ImageLumaA8(_) | DynamicImage::ImageRgb8(_) | DynamicImage::ImageRgba8(_) => {
            let table: Vec<f32> = (0..=255u8).map(|level| linear(f64::from(level) / 255.0)).collect();
            picture.into_rgb8().pixels().map(|p| p.0.map(|level| table[usize::from(level)])).collect()
        }
        _ if !is_float => {
            let table: Vec<f32> = (0..=u16::MAX).map(|level| linear(f64::from(level) / 65535.0)).collect();
            picture.into_rgb16().pixels().map(|p| p.0.map(|level| table[usize::from(level)])).collect()
        }
        _ => picture.into_rgb32f().pixels().map(|p| p.0.map(|share| linear(f64::from(share)))).collect(),
    };
    let values = match channel {
        None | Some(Channel::A) => values,
        Some(Channel::R) => picked(values, 0),
        Some(Channel::G) => picked(values, 1),
        Some(Channel::B) => picked(values, 2),
    };
    if let Some(wrong) = values.iter().position(|v| !v.iter().all(|x| x.is_finite() && *x >= 0.0)) {
        return Err(invalid(name, &at_pixel(wrong, size, values[wrong], "finite amounts of light, from 0")));
    }
    Pixels::new(size, values).ok_or_else(|| invalid(name, "the picture is empty"))
}

const SHARES: &str = "shares of light from 0 to 1";

/// Returns a message about the first pixel above 1, if any: as a reflectance it would return more light than it receives.
pub fn beyond_shares(pixels: &Pixels) -> Option<String> {
    let values = pixels.values();
    if pixels.most() <= 1.0 {
        return None;
    }
    let beyond = values.iter().position(|v| v.iter().any(|x| *x > 1.0))?;
    Some(at_pixel(beyond, pixels.size(), values[beyond], SHARES))
}

fn at_pixel(i: usize, size: UVec2, found: [f32; 3], expected: &str) -> String {
    let (x, y) = (i % size.x as usize, i / size.x as usize);
    format!("pixel ({x}, {y}): expected {expected}, found {}", found.map(|v| v.to_string()).join(", "))
}
