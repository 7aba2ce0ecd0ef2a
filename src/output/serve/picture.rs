//! A picture on its way to browsers: one file of half floats.
//!
//! ```text
//! 4 bytes   length of the header, little-endian
//! header    JSON, filled up with spaces so that what follows begins at a multiple of 4
//! colour    red, green and blue of each pixel, in rows from the top: half floats, little-endian; value = half · 2^exponent
//! error     standard error of each pixel, likewise, if `error` is not null
//! ```

use std::sync::OnceLock;
use std::time::Duration;

use axum::body::Bytes;
use cpu_time::ThreadTime;
use serde_json::json;

use crate::film::Image;
use crate::output::page::HalfFloats;

/// A picture, which becomes bytes when the first browser asks for it.
pub struct ServedPicture {
    /// Number of the picture, from 1.
    pub number: u64,
    image: Image,
    bytes: OnceLock<Bytes>,
}

impl ServedPicture {
    /// A picture that nobody has asked for.
    pub fn new(number: u64, image: Image) -> ServedPicture {
        ServedPicture { number, image, bytes: OnceLock::new() }
    }

    /// The bytes, which all browsers share, and the processor time that making them took now.
    pub fn bytes(&self) -> (Bytes, Duration) {
        let start = ThreadTime::now();
        let bytes = self.bytes.get_or_init(|| encoded(self.number, &self.image).into()).clone();
        (bytes, start.elapsed())
    }
}

fn encoded(number: u64, image: &Image) -> Vec<u8> {
    let (color, error) = (HalfFloats::color(image), HalfFloats::error(image));
    let header = json!({
        "number": number,
        "size": image.size.to_array(),
        "origin": image.origin.to_array(),
        "color": { "exponent": color.exponent },
        "error": error.as_ref().map(|error| json!({ "exponent": error.exponent })),
    });
    let mut header = header.to_string().into_bytes();
    header.resize(header.len().next_multiple_of(4), b' ');
    let length = (header.len() as u32).to_le_bytes();
    [&length[..], &header, &color.bytes, error.as_ref().map_or(&[], |error| &error.bytes)].concat()
}
