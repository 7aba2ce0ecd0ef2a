//! Automatic exposure, the exposure of photographic cameras, and warnings about bad exposure.

use super::Tonemap;
use crate::film::Image;
use crate::math::float::ln_f64;
use crate::math::photometry::LUMENS_PER_WATT;

/// Share of the lit pixels that [`automatic`] shows as nearly white or darker.
const SHOWN: f64 = 0.95;

/// Display value, relative to white, of the brightest of the pixels that [`SHOWN`] counts.
const NEARLY_WHITE: f64 = 0.8;

/// Brightness of the brightest parts, relative to white, below which a picture is hardly visible.
const NEARLY_BLACK: f64 = 0.03;

/// Brightness, relative to white, that half of an overexposed picture exceeds.
const BURNT_OUT: f64 = 2.0;

/// Stops of exposure, rounded to a tenth, that show 95 % of the lit pixels below white, the brightest of them at 80 %; 0 for a
/// black picture.
///
/// Exact under scaling: a picture that is 2^k times as bright gets k stops less.
pub fn automatic(image: &Image) -> f32 {
    quantile(image, SHOWN).map_or(0.0, |brightness| (10.0 * ln_f64(NEARLY_WHITE / brightness) / ln_f64(2.0)).round() / 10.0) as f32
}

/// Settings of a photographic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraExposure {
    /// Sensitivity S of the sensor (ISO).
    pub iso: f64,
    /// Time t for which the shutter is open (s).
    pub shutter: f64,
    /// Focal length divided by the diameter of the lens, N.
    pub f_number: f64,
}

impl CameraExposure {
    /// Stops of exposure with which a picture of radiances is as bright as a camera's: radiance that saturates the sensor becomes 1.
    ///
    /// ```text
    /// H = q K L t / N²,  H_sat = 78 / S                  [lx·s], q = 0.65
    /// stops = log₂(H / H_sat) for L = 1 W·m⁻²·sr⁻¹
    /// ```
    ///
    /// K = 683 lm·W⁻¹ turns watts into lumens, as for all light. q is the share of the light that the lens passes to the sensor, for a common lens
    /// and a point 10 degrees off the axis.
    ///
    /// Source: ISO 12232:2019, saturation-based sensitivity; q: ISO 2720:1974, ISO 2721:2013.
    pub fn stops(&self) -> f64 {
        let exposure = LENS_FACTOR * LUMENS_PER_WATT * self.shutter / (self.f_number * self.f_number);
        ln_f64(exposure * self.iso / SATURATION) / ln_f64(2.0)
    }
}

/// q, the exposure of the sensor over that without losses at f-number 1.
const LENS_FACTOR: f64 = 0.65;

/// Exposure that saturates a sensor of the sensitivity 1 [lx·s].
const SATURATION: f64 = 78.0;

/// Warning about a picture that looks too dark or too bright with this exposure; `None` also for a black picture.
pub fn fault(image: &Image, tonemap: &Tonemap) -> Option<&'static str> {
    let gain = f64::from(tonemap.exposure).exp2();
    let at = |share: f64| quantile(image, share).map(|brightness| gain * brightness);
    match (at(SHOWN)?, at(0.5)?) {
        (bright, _) if bright < NEARLY_BLACK => Some("nearly black"),
        (_, middle) if middle > BURNT_OUT => Some("burnt out"),
        _ => None,
    }
}

/// Mean of the colours that this share of the lit pixels does not exceed; `None` if all pixels are black.
fn quantile(image: &Image, share: f64) -> Option<f64> {
    let mean = |[r, g, b]: [f32; 3]| (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0;
    let mut lit: Vec<f64> = image.pixels().map(mean).filter(|value| value.is_finite() && *value > 0.0).collect();
    let place = ((lit.len() as f64 * share).ceil() as usize).clamp(1, lit.len().max(1)) - 1;
    (!lit.is_empty()).then(|| *lit.select_nth_unstable_by(place, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::film::Channel;
    use crate::output::Curve;

    /// 100 pixels: `dark` of them are black, the others have the values 1 to `100 − dark`, times `scale`.
    fn picture(dark: usize, scale: f32) -> Image {
        let values: Vec<f32> = (0..100).map(|i| if i < dark { 0.0 } else { (i - dark + 1) as f32 * scale }).collect();
        let channels = ["R", "G", "B"].map(|name| Channel { name: name.into(), values: values.clone() }).into();
        let size = UVec2::new(10, 10);
        Image { full_size: size, origin: UVec2::ZERO, size, channels }
    }

    fn at(exposure: f32) -> Tonemap {
        Tonemap { exposure, curve: Curve::None }
    }

    /// 95 of 100 pixels are no brighter than 95: log₂(0.8/95) = −6.89. With half of the pixels dark, 48 of 50: log₂(0.8/48) =
    /// −5.91.
    #[test]
    fn most_of_a_picture_is_shown_below_white() {
        assert_eq!(automatic(&picture(0, 1.0)), -6.9);
        assert_eq!(automatic(&picture(50, 1.0)), -5.9);
        assert_eq!(automatic(&picture(100, 1.0)), 0.0);
        for k in [-60, -7, 9, 60] {
            let stops = automatic(&picture(0, 2f32.powi(k)));
            // A tenth, rounded to f32.
            assert!((stops - (-6.9 - k as f32)).abs() < 1e-5, "2^{k}: {stops}");
        }
    }

    /// The luminance that saturates a sensor is 1.2 · 2^EV cd/m² at ISO 100, where EV = log₂(N²/t): EV 0 is 1 s at f/1, and 1/125 s at f/16
    /// is EV 14.97. A stop of each of the three settings is a stop.
    #[test]
    fn a_photographic_exposure_saturates_at_its_luminance() {
        let stops = |iso, shutter, f_number| CameraExposure { iso, shutter, f_number }.stops();
        for (shutter, f_number) in [(1.0f64, 1.0f64), (1.0 / 125.0, 16.0), (30.0, 2.8)] {
            let saturating = 1.2 * f_number * f_number / shutter / 683.0;
            let shown = stops(100.0, shutter, f_number).exp2() * saturating;
            assert!((shown - 1.0).abs() < 1e-9, "{shutter} s at f/{f_number}: {shown}");
        }
        let before = stops(100.0, 0.5, 4.0);
        for (more, expected) in [(stops(200.0, 0.5, 4.0), 1.0), (stops(100.0, 0.25, 4.0), -1.0), (stops(100.0, 0.5, 8.0), -2.0)] {
            assert!((more - before - expected).abs() < 1e-9, "{more} after {before}");
        }
    }

    /// The brightest parts are below 3 % of white, 5.1 stops; half of all pixels are above twice white.
    #[test]
    fn pictures_too_dark_or_too_bright_are_told() {
        let right = -6.9;
        for (stops, told) in [(0.0, None), (-4.5, None), (-5.0, Some("nearly black")), (2.1, None), (2.3, Some("burnt out"))] {
            assert_eq!(fault(&picture(0, 1.0), &at(right + stops)), told, "{stops}");
            assert_eq!(fault(&picture(0, 0.125), &at(right + stops + 3.0)), told, "{stops}");
        }
        assert_eq!(fault(&picture(100, 1.0), &at(0.0)), None);
    }
}
