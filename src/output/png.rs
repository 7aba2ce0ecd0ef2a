//! 8-bit pictures for eyes.

use image::ImageEncoder;
use image::codecs::png::PngEncoder;

use super::Tonemap;
use crate::error::{Error, Result};
use crate::film::Image;

pub fn encode(image: &Image, tonemap: &Tonemap) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    let encoder = PngEncoder::new(&mut bytes);
    encoder
        .write_image(&tonemap.apply(image), image.size.x, image.size.y, image::ExtendedColorType::Rgb8)
        .map_err(|e| Error::Internal(format!("cannot encode PNG: {e}")))?;
    Ok(bytes)
}

/// Binary PPM, P6.
pub fn encode_ppm(image: &Image, tonemap: &Tonemap) -> Vec<u8> {
    let mut bytes = format!("P6\n{} {}\n255\n", image.size.x, image.size.y).into_bytes();
    bytes.extend(tonemap.apply(image));
    bytes
}
