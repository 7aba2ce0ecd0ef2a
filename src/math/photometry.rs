//! What light is to the eye: lumens from watts.
//!
//! ```text
//! Φv = 683 lm/W · (0.2126 R + 0.7152 G + 0.0722 B)
//! ```
//!
//! The three colours tell no wavelengths, so that watts have no luminous efficacy of their own. pt uses the same convention everywhere, for
//! glTF files, exposures of cameras and meters: one watt of white light (R = G = B) is 683 lm, the number of 555 nm.
//!
//! Source: ITU-R BT.709 (the luminance of its primaries); glTF 2.0, KHR_lights_punctual (683).

/// Luminous efficacy of white light (lm·W⁻¹).
pub const LUMENS_PER_WATT: f64 = 683.0;

/// Luminance of linear Rec. 709, in the unit of the colours; the value itself, but for rounding, where all three are equal.
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::colorimetry::TO_REC_709;

    /// The luminance of the colour of XYZ is Y.
    #[test]
    fn luminance_is_y() {
        for (k, y) in [0.0, 1.0, 0.0].into_iter().enumerate() {
            let color = TO_REC_709.map(|row| row[k]);
            // The weights have four digits and are up to 7.3e-5 off; the colours are up to 3.24.
            assert!((luminance(color) - y).abs() < 3e-4, "{k}: {}", luminance(color));
        }
    }
}
