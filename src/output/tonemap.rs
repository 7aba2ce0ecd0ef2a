//! From linear radiance to what a screen shows, the same bytes on every platform. For 8-bit files only: EXR keeps what was measured.

use crate::film::Image;
use crate::math::float::{exp_f64, ln_f64, powf};

/// Exposure, then a curve, then 8 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tonemap {
    /// Stops: radiance is multiplied by 2^exposure.
    pub exposure: f32,
    pub curve: Curve,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// Clipped at 1, sRGB.
    #[default]
    None,
    /// A shoulder like film's, sRGB. Source: Narkowicz's fit of the ACES reference curve (2016).
    Filmic,
    /// Divided by the brightest value of the picture, no transfer curve: what the ancestor wrote.
    Normalize,
    /// x/(x + 1) after a small lift, no transfer curve: the curve of the postcard path tracer.
    Postcard,
}

impl Tonemap {
    /// Red, green, blue in 8 bits, row by row.
    pub fn apply(&self, image: &Image) -> Vec<u8> {
        self.display(image).into_iter().flatten().map(quantise).collect()
    }

    /// What a screen is to show, 0 to 1, before it is cut to 8 bits; NaN stays.
    pub fn display(&self, image: &Image) -> Vec<[f32; 3]> {
        let gain = powf(2.0, self.exposure);
        let brightest = image.pixels().flatten().filter(|v| v.is_finite()).fold(0.0, f32::max) * gain;
        image.pixels().map(|rgb| rgb.map(|v| self.curve.map(v * gain, brightest).clamp(0.0, 1.0))).collect()
    }
}

impl Curve {
    /// Linear radiance to display value, [0, 1] where it is in range.
    fn map(self, x: f32, brightest: f32) -> f32 {
        // Outside, the rational curves have poles (below 0) or overflow (far above white).
        let tame = x.clamp(0.0, 1e9);
        match self {
            Curve::None => srgb(x),
            Curve::Filmic => srgb(tame * (2.51 * tame + 0.03) / (tame * (2.43 * tame + 0.59) + 0.14)),
            Curve::Normalize => {
                if brightest > 0.0 {
                    x / brightest
                } else {
                    0.0
                }
            }
            Curve::Postcard => {
                let lifted = tame + 14.0 / 241.0;
                lifted / (lifted + 1.0)
            }
        }
    }
}

/// The sRGB transfer curve. Source: IEC 61966-2-1.
pub fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * powf(linear, 1.0 / 2.4) - 0.055 }
}

/// The inverse of the sRGB transfer curve, the same bits on every platform. Source: IEC 61966-2-1.
pub fn linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { exp_f64(2.4 * ln_f64((encoded + 0.055) / 1.055)) }
}

/// To the nearest of 256 levels; NaN is black.
fn quantise(x: f32) -> u8 {
    (x * 255.0 + 0.5) as u8
}
