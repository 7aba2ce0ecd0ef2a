//! Radiance HDR: linear values with 8 bits each and one exponent for a pixel, the usual format of environment maps.

use glam::UVec2;
use image::codecs::hdr::HdrEncoder;
use image::{ImageFormat, Rgb};

use super::decode_error::DecodeError;
use super::png::decoded;
use super::rgb_image::rgb_image;
use crate::error::{Error, Result};
use crate::film::Image;

/// Largest value that is written.
const MAX: f32 = 1e38;

/// Encodes red, green and blue. Values are rounded to the nearest that the format has: by less than 1/255 of the largest in their pixel.
///
/// What the format cannot have is written as the nearest value: negative values and NaN as 0, those above 10³⁸ as 10³⁸.
pub fn encode(image: &Image) -> Result<Vec<u8>> {
    let pixels = image.pixels().map(|pixel| pixel.map(|value| if value > 0.0 { value.min(MAX) } else { 0.0 }));
    let rounded: Vec<Rgb<f32>> = pixels.map(rounded).collect();
    let mut bytes = vec![];
    HdrEncoder::new(&mut bytes)
        .encode(&rounded, image.size.x as usize, image.size.y as usize)
        .map_err(|e| Error::Internal(format!("cannot encode HDR: {e}")))?;
    Ok(bytes)
}

/// The nearest values with 8 bits and the exponent of the largest one; the encoder rounds down.
fn rounded(pixel: [f32; 3]) -> Rgb<f32> {
    let largest = f64::from(pixel[0].max(pixel[1]).max(pixel[2]));
    if largest < f64::from(f32::MIN_POSITIVE) {
        return Rgb([0.0; 3]);
    }
    // The power of two below the largest value, without its fraction, is 128 units.
    let unit = f64::from_bits(largest.to_bits() & !((1 << 52) - 1)) / 128.0;
    let unit = if (largest / unit).round() < 256.0 { unit } else { 2.0 * unit };
    Rgb(pixel.map(|value| ((f64::from(value) / unit).round() * unit) as f32))
}

/// Decodes the bytes of a file.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, DecodeError> {
    let picture = decoded(bytes, ImageFormat::Hdr)?.into_rgb32f();
    let pixels: Vec<[f32; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
    Ok(rgb_image(UVec2::new(picture.width(), picture.height()), &pixels))
}
