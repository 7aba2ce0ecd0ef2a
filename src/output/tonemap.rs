//! Tone mapping from linear radiance to display values, with the same bytes on every platform. It is for 8-bit files only; EXR
//! keeps the linear values.

use super::agx::agx;
use crate::film::Image;
use crate::math::float::{exp_f64, ln_f64, powf};

/// Exposure, tone curve and quantisation to 8 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tonemap {
    /// Exposure (stops): radiance is multiplied by 2^exposure.
    pub exposure: f32,
    /// Tone curve.
    pub curve: Curve,
}

/// Tone curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// Clip at 1, sRGB.
    #[default]
    None,
    /// Curve with a shoulder like that of film, sRGB. Source: Narkowicz's fit of the ACES reference curve (2016).
    Filmic,
    /// Bright and saturated colours fade to white. Source: Sobotka's AgX (2022).
    Agx,
    /// Divide by the brightest value of the picture, without a transfer curve.
    Normalize,
    /// x/(x + 1) after a small lift, without a transfer curve: the curve of the postcard path tracer.
    Postcard,
}

impl Tonemap {
    /// Red, green and blue in 8 bits, row by row.
    pub fn apply(&self, image: &Image) -> Vec<u8> {
        self.display(image).into_iter().flatten().map(quantise).collect()
    }

    /// Display values, 0 to 1, before quantisation to 8 bits; a NaN stays.
    pub fn display(&self, image: &Image) -> Vec<[f32; 3]> {
        let gain = powf(2.0, self.exposure);
        let brightest = image.pixels().flatten().filter(|v| v.is_finite()).fold(0.0, f32::max) * gain;
        image.pixels().map(|rgb| self.curve.map(rgb.map(|v| v * gain), brightest).map(|v| v.clamp(0.0, 1.0))).collect()
    }
}

impl Curve {
    /// Maps a linear colour to display values, in [0, 1] for values in range.
    ///
    /// - `brightest`: the largest value of the picture
    fn map(self, rgb: [f32; 3], brightest: f32) -> [f32; 3] {
        // Outside of this range the rational curves have poles (below 0) or overflow (far above white).
        let tame = rgb.map(|v| v.clamp(0.0, 1e9));
        match self {
            Curve::None => rgb.map(srgb),
            Curve::Filmic => tame.map(|v| srgb(v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14))),
            Curve::Agx => agx(tame),
            Curve::Normalize => rgb.map(|v| if brightest > 0.0 { v / brightest } else { 0.0 }),
            Curve::Postcard => tame.map(|v| {
                let lifted = v + 14.0 / 241.0;
                lifted / (lifted + 1.0)
            }),
        }
    }
}

/// The sRGB transfer curve. Source: IEC 61966-2-1.
pub fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * powf(linear, 1.0 / 2.4) - 0.055 }
}

/// Inverse of the sRGB transfer curve, with the same bits on every platform. Source: IEC 61966-2-1.
pub fn linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { exp_f64(2.4 * ln_f64((encoded + 0.055) / 1.055)) }
}

/// Rounds to the nearest of 256 levels; NaN becomes black.
fn quantise(x: f32) -> u8 {
    (x * 255.0 + 0.5) as u8
}
