//! Differences from the reference inside a page, one byte for each number, as base64.
//!
//! ```text
//! x − r = float8 · 2^exponent          float8: sign, 5 bits of exponent, 2 bits of fraction: the upper half of a half float
//! FLIP  = 10^(DECADES · (byte/255 − 1))    0 stands for anything less
//! ```
//!
//! Differences down to 2⁻²⁹ of the largest are told within one eighth; smaller ones lose digits, and a pixel without error stays without. Noise of 1 % in a picture is so told within
//! 0.13 % of the picture: the eye sees no difference, and a page holds many pictures.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use half::f16;
use serde::Serialize;

use crate::film::Image;
use crate::output::page::exponent;

/// Range of FLIP in decades: that of the colour scale, from 0.1 % to 100 %.
pub const DECADES: f64 = 3.0;

/// Red, green and blue of a picture less those of the reference.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EmbeddedDifference {
    /// Exponent of the common power of two.
    pub exponent: i32,
    /// Bytes as base64.
    pub data: String,
}

impl EmbeddedDifference {
    /// Encodes a picture of the reference's size.
    pub fn between(image: &Image, reference: &Image) -> EmbeddedDifference {
        let pixels = image.pixels().zip(reference.pixels());
        let differences: Vec<f64> = pixels.flat_map(|(x, r)| [0, 1, 2].map(|c| f64::from(x[c]) - f64::from(r[c]))).collect();
        let largest = differences.iter().filter(|d| d.is_finite()).fold(0.0, |max: f64, d| max.max(d.abs()));
        // One stop of room, so that rounding cannot overflow.
        let exponent = exponent(largest as f32) + 1;
        let scale = (-f64::from(exponent)).exp2();
        let bytes: Vec<u8> = differences.iter().map(|d| float8(d * scale)).collect();
        EmbeddedDifference { exponent, data: STANDARD.encode(bytes) }
    }
}

/// The upper half of the nearest half float, rounded to even.
fn float8(value: f64) -> u8 {
    let half = f16::from_f64(value);
    if half.is_nan() {
        return (f16::NAN.to_bits() >> 8) as u8;
    }
    let bits = half.to_bits();
    // An infinity has no fraction to round.
    ((bits + 0x7f + ((bits >> 8) & 1)) >> 8) as u8
}

/// Encodes numbers from 0 to 1 by their logarithms.
pub fn logarithms(values: &[f64]) -> String {
    let byte = |value: &f64| (255.0 * (1.0 + value.log10() / DECADES)).round().clamp(0.0, 255.0) as u8;
    STANDARD.encode(values.iter().map(byte).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::super::super::synthetic::image;
    use super::*;

    fn decode(plane: &EmbeddedDifference) -> Vec<f64> {
        let bytes = STANDARD.decode(&plane.data).expect("base64");
        bytes.iter().map(|byte| f16::from_bits(u16::from(*byte) << 8).to_f64() * f64::from(plane.exponent).exp2()).collect()
    }

    /// Two bits of fraction: within 2⁻³, for differences down to 2⁻²⁹ of the largest, in any unit.
    #[test]
    fn differences_return_within_one_eighth() {
        for unit in [1.0, 2f32.powi(50), 3.7e-9] {
            let value = |i: usize| {
                unit * (1.0 + 0.013 * (i % 77) as f32) * 2f32.powi(-((i % 25) as i32)) * if i.is_multiple_of(2) { -1.0 } else { 1.0 }
            };
            let found = decode(&EmbeddedDifference::between(&image(value, 0.0), &image(|_| 0.0, 0.0)));
            for (i, pixel) in found.chunks(3).enumerate() {
                let wanted = f64::from(value(i));
                assert!(pixel.iter().all(|d| (d - wanted).abs() <= wanted.abs() / 8.0), "{pixel:?} for {wanted}");
            }
        }
    }

    /// What is right stays right, and what is broken stays broken.
    #[test]
    fn equal_and_broken_pixels_stay_what_they_are() {
        let broken = |i: usize| [0.7, f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX][i % 5];
        let found = decode(&EmbeddedDifference::between(&image(broken, 0.0), &image(|_| 0.7, 0.0)));
        assert_eq!(found[0], 0.0);
        assert!(found[3].is_nan());
        assert_eq!([found[6], found[9]], [f64::INFINITY, f64::NEG_INFINITY]);
        assert!((found[12] / f64::from(f32::MAX) - 1.0).abs() < 0.125);
    }

    /// 255 steps over three decades: each is a factor of 10^(3/255) = 1.027.
    #[test]
    fn logarithms_are_right_within_half_a_step() {
        let values = [1.0, 0.5, 0.0123, 0.0011];
        let bytes = STANDARD.decode(logarithms(&[&values[..], &[0.0, 1e-9]].concat())).expect("base64");
        for (byte, value) in bytes.iter().zip(values) {
            let found = 10f64.powf(3.0 * (f64::from(*byte) / 255.0 - 1.0));
            assert!((found / value).log10().abs() <= 1.5 / 255.0 + 1e-12, "{found} for {value}");
        }
        assert_eq!(bytes[4..], [0, 0]);
    }
}
