//! Pictures for pages: half floats with a common exponent.
//!
//! ```text
//! value = half · 2^exponent
//! ```
//!
//! The exponent puts the largest finite value just below the largest half float, so that values down to 29 stops below it keep
//! eleven bits, whatever the units of the scene. A NaN stays a NaN.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use half::f16;
use serde::Serialize;

use crate::film::Image;

/// Interleaved channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HalfFloats {
    /// Exponent of the common power of two.
    pub exponent: i32,
    /// Half floats, little-endian.
    pub bytes: Vec<u8>,
}

impl HalfFloats {
    /// Encodes values.
    pub fn new(values: impl Iterator<Item = f32> + Clone) -> HalfFloats {
        let largest = values.clone().filter(|v| v.is_finite()).fold(0.0, |max: f32, v| max.max(v.abs()));
        let exponent = exponent(largest);
        let scale = (-f64::from(exponent)).exp2();
        let bytes = values.flat_map(|v| f16::from_f64(f64::from(v) * scale).to_le_bytes()).collect();
        HalfFloats { exponent, bytes }
    }

    /// Encodes red, green and blue.
    pub fn color(image: &Image) -> HalfFloats {
        let pixels: Vec<f32> = image.pixels().flatten().collect();
        HalfFloats::new(pixels.iter().copied())
    }

    /// Encodes the standard error of each pixel, √(mean of the squares over the colours). `None` if the picture has none.
    pub fn error(image: &Image) -> Option<HalfFloats> {
        let [r, g, b] = [image.channel("StdErr.R")?, image.channel("StdErr.G")?, image.channel("StdErr.B")?];
        let mean = |((r, g), b): ((&f32, &f32), &f32)| {
            let square = [r, g, b].map(|v| f64::from(*v).powi(2)).iter().sum::<f64>() / 3.0;
            square.sqrt() as f32
        };
        Some(HalfFloats::new(r.iter().zip(g).zip(b).map(mean)))
    }
}

/// Half floats inside a page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EmbeddedImage {
    /// Exponent of the common power of two.
    pub exponent: i32,
    /// Half floats as base64.
    pub data: String,
}

impl From<HalfFloats> for EmbeddedImage {
    fn from(HalfFloats { exponent, bytes }: HalfFloats) -> EmbeddedImage {
        EmbeddedImage { exponent, data: STANDARD.encode(bytes) }
    }
}

/// Smallest k with largest < 2^(15 + k). The largest half float is 65504 < 2^16, so rounding cannot overflow.
pub fn exponent(largest: f32) -> i32 {
    if largest == 0.0 {
        return 0;
    }
    // f64 holds every f32, also subnormal ones, as a normal number, so its exponent bits are ⌊log₂⌋.
    let floor = ((f64::from(largest).to_bits() >> 52) & 0x7ff) as i32 - 1023;
    floor + 1 - 15
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(plane: HalfFloats) -> Vec<f64> {
        let plane = EmbeddedImage::from(plane);
        let bytes = STANDARD.decode(&plane.data).expect("base64");
        let half = |pair: &[u8]| f16::from_le_bytes([pair[0], pair[1]]).to_f64();
        bytes.chunks(2).map(|pair| half(pair) * f64::from(plane.exponent).exp2()).collect()
    }

    /// Half an ulp of eleven bits: relative 2⁻¹¹, for values within 2²⁹ of the largest.
    #[test]
    fn values_return_to_half_precision_in_any_unit() {
        for unit in [1.0, 2f32.powi(60), 2f32.powi(-90), 3.7e-5] {
            let values: Vec<f32> = (0..200).map(|i| unit * (1.0 + 0.37 * i as f32) * 2f32.powi(-(i % 20))).collect();
            let returned = decode(HalfFloats::new(values.iter().copied()));
            for (value, back) in values.iter().map(|v| f64::from(*v)).zip(returned) {
                assert!((back - value).abs() <= value.abs() * 2f64.powi(-11), "{value:e} came back as {back:e}");
            }
        }
    }

    #[test]
    fn brightest_and_broken_pixels_stay_what_they_are() {
        let values = [f32::MAX, -f32::MAX, 0.0, f32::NAN, f32::INFINITY];
        let returned = decode(HalfFloats::new(values.iter().copied()));
        assert!((returned[0] / f64::from(f32::MAX) - 1.0).abs() < 2f64.powi(-11));
        assert_eq!(returned[1], -returned[0]);
        assert_eq!(returned[2], 0.0);
        assert!(returned[3].is_nan() && returned[4] == f64::INFINITY);
        assert!(decode(HalfFloats::new([0.0, f32::NAN].into_iter()))[0] == 0.0);
    }
}
