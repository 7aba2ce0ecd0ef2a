//! Decoding of common picture formats.

use std::io::Cursor;

use image::error::DecodingError;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use crate::error::panic::unwound;

/// Most memory that a decoded picture and its values as floats may take (bytes). Textures take as much again for the smaller copies by which
/// they are averaged.
pub const MOST_MEMORY: u64 = 4 << 30;

/// Memory of a pixel as floats (bytes).
const FLOATS: u64 = 12;

/// Most pixels that a byte of a JPEG can hold, of the kinds that the decoder reads: the first scan of a grey picture takes at least one bit for
/// a block of 8 × 8 pixels.
///
/// Source: ITU-T T.81, annexes F and G (Huffman coding).
const MOST_PIXELS_PER_BYTE: u64 = 8 * 64;

/// Reason why bytes cannot be decoded.
#[derive(Debug)]
pub enum Undecoded {
    /// The picture needs more than [`MOST_MEMORY`].
    TooLarge,
    /// The bytes are not a valid picture.
    Invalid(String),
}

/// Decodes the bytes of a picture whose format is known.
///
/// It takes bytes, not any reader, so that the decoders are compiled once. The size is checked before decoding. A panic of the decoder
/// means that the bytes are not a valid picture.
///
/// # Errors
/// See [`Undecoded`].
pub fn decode(bytes: &[u8], format: ImageFormat) -> Result<DynamicImage, Undecoded> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_MEMORY);
    reader.limits(limits);
    let decoded = || {
        let decoder = reader.into_decoder()?;
        let (width, height) = decoder.dimensions();
        let pixels = u64::from(width) * u64::from(height);
        if format == ImageFormat::Jpeg && pixels > MOST_PIXELS_PER_BYTE * bytes.len() as u64 {
            let message = format!("{} bytes cannot hold {width} × {height} pixels", bytes.len());
            return Err(ImageError::Decoding(DecodingError::new(format.into(), message)));
        }
        let floats = FLOATS * pixels;
        let fits = decoder.total_bytes().checked_add(floats).is_some_and(|bytes| bytes <= MOST_MEMORY);
        if fits { DynamicImage::from_decoder(decoder).map(Some) } else { Ok(None) }
    };
    match unwound(decoded) {
        Ok(Ok(Some(picture))) if picture.width() == 0 || picture.height() == 0 => {
            Err(Undecoded::Invalid(format!("it has {} × {} pixels", picture.width(), picture.height())))
        }
        Ok(Ok(Some(picture))) => Ok(picture),
        Ok(Ok(None) | Err(ImageError::Limits(_))) => Err(Undecoded::TooLarge),
        Ok(Err(other)) => Err(Undecoded::Invalid(other.to_string())),
        Err(panic) => Err(Undecoded::Invalid(format!("its decoder failed: {}", panic.message))),
    }
}
