//! Portable float map: the simplest format that keeps linear f32.

use glam::UVec2;

use super::decode_error::DecodeError;
use super::rgb_image::rgb_image;
use crate::film::Image;

/// Encodes a picture: little-endian (scale −1), rows from the bottom.
pub fn encode(image: &Image) -> Vec<u8> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", image.size.x, image.size.y).into_bytes();
    let pixels: Vec<[f32; 3]> = image.pixels().collect();
    for row in pixels.chunks(image.size.x.max(1) as usize).rev() {
        bytes.extend(row.iter().flatten().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}

/// Decodes the bytes of a file: three values per pixel after `PF`, one after `Pf`, which is a grey. Only the sign of the scale is
/// used.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, DecodeError> {
    let (header, data) = header(bytes).ok_or_else(|| invalid("its header is not PF or Pf, width, height and scale"))?;
    let Header { colours, size, little_endian } = header;
    let [width, height] = size.to_array().map(|n| n as usize);
    let expected = width as u128 * height as u128 * colours as u128 * 4;
    if data.len() as u128 != expected {
        return Err(invalid(&format!("expected {expected} bytes of pixels, found {}", data.len())));
    }
    let value = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if little_endian { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let values: Vec<f32> = data.chunks_exact(4).map(value).collect();
    let pixel = |v: &[f32]| [v[0], v[colours / 2], v[colours - 1]];
    let pixels: Vec<[f32; 3]> = values.chunks(width * colours).rev().flat_map(|row| row.chunks(colours).map(pixel)).collect();
    Ok(rgb_image(size, &pixels))
}

fn invalid(message: &str) -> DecodeError {
    DecodeError::Invalid(format!("not a readable PFM picture: {message}"))
}

struct Header {
    /// Number of channels: 3 or 1.
    colours: usize,
    size: UVec2,
    little_endian: bool,
}

/// Reads the header: four words, one white space after the last; then the data.
fn header(bytes: &[u8]) -> Option<(Header, &[u8])> {
    let mut rest = bytes;
    let mut word = || {
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let end = start + rest[start..].iter().position(u8::is_ascii_whitespace)?;
        let text = std::str::from_utf8(&rest[start..end]).ok()?;
        rest = &rest[end + 1..];
        Some(text)
    };
    let colours = match word()? {
        "PF" => 3,
        "Pf" => 1,
        _ => return None,
    };
    let size = UVec2::new(word()?.parse().ok()?, word()?.parse().ok()?);
    let scale: f32 = word()?.parse().ok().filter(|scale: &f32| scale.is_finite() && *scale != 0.0)?;
    (size.x > 0 && size.y > 0).then_some((Header { colours, size, little_endian: scale < 0.0 }, rest))
}
