//! 8-bit pictures: PNG and PPM.

use glam::UVec2;
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ImageEncoder, ImageFormat};

use super::Tonemap;
use super::decode::{self, Undecoded};
use super::decode_error::DecodeError;
use super::rgb_image::rgb_image;
use super::tonemap::linear;
use crate::error::{Error, Result};
use crate::film::{Channel, Image};

/// Encodes a picture as PNG.
pub fn encode(image: &Image, tonemap: &Tonemap) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    let encoder = PngEncoder::new(&mut bytes);
    encoder
        .write_image(&tonemap.apply(image), image.size.x, image.size.y, image::ExtendedColorType::Rgb8)
        .map_err(|e| Error::Internal(format!("cannot encode PNG: {e}")))?;
    Ok(bytes)
}

/// Encodes a picture as binary PPM, P6.
pub fn encode_ppm(image: &Image, tonemap: &Tonemap) -> Vec<u8> {
    let mut bytes = format!("P6\n{} {}\n255\n", image.size.x, image.size.y).into_bytes();
    bytes.extend(tonemap.apply(image));
    bytes
}

/// Decodes the bytes of a PNG, JPEG or PPM to linear values, with a channel `A` if there is transparency.
pub(super) fn decode(bytes: &[u8], format: ImageFormat) -> Result<Image, DecodeError> {
    let picture = decoded(bytes, format)?;
    let (size, has_alpha) = (UVec2::new(picture.width(), picture.height()), picture.color().has_alpha());
    let table: Vec<f32> = (0..=u16::MAX).map(|level| linear(f64::from(level) / 65535.0) as f32).collect();
    // 8 bits become 16 by repetition, which keeps their share of the range.
    let levels = picture.into_rgba16();
    let pixels: Vec<[f32; 3]> = levels.pixels().map(|p| [p[0], p[1], p[2]].map(|level| table[usize::from(level)])).collect();
    let mut image = rgb_image(size, &pixels);
    if has_alpha {
        let values = levels.pixels().map(|p| f32::from(p[3]) / 65535.0).collect();
        image.channels.push(Channel { name: "A".into(), values });
    }
    Ok(image)
}

/// Decodes a picture of a format of the image library.
pub(super) fn decoded(bytes: &[u8], format: ImageFormat) -> Result<DynamicImage, DecodeError> {
    let unreadable =
        |why: String| DecodeError::Invalid(format!("not a readable {} picture: {why}", format.extensions_str()[0].to_uppercase()));
    decode::decode(bytes, format).map_err(|refusal| match refusal {
        Undecoded::TooLarge => DecodeError::TooLarge,
        Undecoded::Invalid(why) => unreadable(why),
    })
}
