//! Picture files to textures: PNG, JPEG and OpenEXR, by content.

use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use glam::UVec2;
use image::{ColorType, DynamicImage, ImageFormat, ImageReader};

use super::color::decoded;
use super::file::open;
use super::texture::{Channel, Encoding};
use crate::output::decode::{Undecoded, decode};
use crate::texture::image::Pixels;
use crate::{Error, Fault, Result};

/// Reads the picture in a file; returns it with warnings, sentences that begin with `name`.
///
/// The content decides the format.
///
/// - `channel`: all three values of each pixel are this one; of colours, transparency is left out
///
/// # Errors
/// `Invalid` where the file is missing, no regular file, of another format, malformed, or holds anything but shares of
/// light from 0 to 1; `Limit` where it would take more than 4 GiB; `Io` where it cannot be read.
pub fn load(path: &Path, name: &str, encoding: Encoding, channel: Option<Channel>) -> Result<(Pixels, Vec<String>)> {
    read(BufReader::new(open(path, name)?), name, encoding, channel)
}

/// As [`load`], from any source (bytes in memory: `io::Cursor`).
pub fn read(source: impl BufRead + Seek, name: &str, encoding: Encoding, channel: Option<Channel>) -> Result<(Pixels, Vec<String>)> {
    let reader = ImageReader::new(source).with_guessed_format().map_err(|e| Error::io(name, e))?;
    let known = |format: &ImageFormat| matches!(format, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::OpenExr);
    let format = reader.format().filter(known).ok_or_else(|| invalid(name, "unknown picture format: expected PNG, JPEG or OpenEXR"))?;
    let mut warnings = vec![];
    if ImageFormat::from_path(name).ok() != Some(format) {
        warnings.push(format!("{name}: read as {}, which its first bytes say it is", title(format)));
    }
    let picture = decode(reader).map_err(|refusal| match refusal {
        Undecoded::TooLarge => Error::Limit(Fault::new("the picture would take more than 4 GiB").in_file(name)),
        Undecoded::Unread(error) => Error::io(name, error),
        Undecoded::Invalid(why) => invalid(name, &format!("not a usable {} picture: {why}", title(format))),
    })?;
    Ok((pixels(picture, encoding, channel, name)?, warnings))
}

fn invalid(name: &str, message: &str) -> Error {
    Error::invalid(Fault::new(message).in_file(name))
}

fn title(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        _ => "OpenEXR",
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
    let is_share = |v: &f32| (0.0..=1.0).contains(v);
    if let Some(wrong) = values.iter().position(|v| !v.iter().all(is_share)) {
        let (x, y) = (wrong % size.x as usize, wrong / size.x as usize);
        let found = values[wrong].map(|v| v.to_string()).join(", ");
        return Err(invalid(name, &format!("pixel ({x}, {y}): expected shares of light from 0 to 1, found {found}")));
    }
    Pixels::new(size, values).ok_or_else(|| invalid(name, "the picture is empty"))
}
