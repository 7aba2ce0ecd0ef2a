//! Options for 8-bit pictures: exposure and tone curve.

use clap::ValueEnum;

use super::parse::{above_zero, finite};
use crate::film::Image;
use crate::output;
use crate::output::exposure::CameraExposure;

/// Conversion from radiance to 8 bits.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct ToneMapping {
    /// Stops of exposure, for 8-bit files only; `auto` shows 95 % of the lit pixels below white.
    #[arg(long, value_name = "STOPS", default_value = "0", allow_negative_numbers = true, value_parser = exposure)]
    pub exposure: Exposure,
    #[command(flatten)]
    pub camera: Option<CameraArgs>,
    /// Tone curve from radiance to display, for 8-bit files only.
    #[arg(long, value_enum, default_value_t = Curve::None)]
    pub tonemap: Curve,
}

/// Exposure of a photographic camera in place of stops, for 8-bit files only.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct CameraArgs {
    /// Sensitivity of the camera whose exposure 8-bit files get, with --shutter and --f-number.
    #[arg(long, value_name = "ISO", value_parser = above_zero, requires = "shutter", requires = "f_number", conflicts_with = "exposure", required = false)]
    pub iso: f32,
    /// Time for which its shutter is open, in seconds: 0.01 or 1/100.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "iso", required = false)]
    pub shutter: f32,
    /// Its f-number, which need not be that of the scene's camera.
    #[arg(long, value_name = "N", value_parser = above_zero, requires = "iso", required = false)]
    pub f_number: f32,
}

/// Exposure of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Stops of exposure.
    Stops(f32),
    /// Exposure chosen from the picture.
    Auto,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// Clip at 1.
    None,
    /// A shoulder like film's.
    Filmic,
    /// Bright and saturated colours fade to white (AgX).
    Agx,
    /// Divide by the brightest value; no transfer curve.
    Normalize,
    /// The curve of the postcard path tracer.
    Postcard,
}

impl ToneMapping {
    /// Tone mapping of a picture with these options.
    pub fn tonemap(&self, image: &Image) -> output::Tonemap {
        let exposure = match (self.camera, self.exposure) {
            (Some(CameraArgs { iso, shutter, f_number }), _) => {
                CameraExposure { iso: iso.into(), shutter: shutter.into(), f_number: f_number.into() }.stops() as f32
            }
            (None, Exposure::Stops(stops)) => stops,
            (None, Exposure::Auto) => output::exposure::automatic(image),
        };
        output::Tonemap { exposure, curve: self.tonemap.into() }
    }
}

impl ToneMapping {
    /// The options as words of a command; none for those that have their default.
    pub fn words(&self) -> Vec<String> {
        let exposure = match (self.camera, self.exposure) {
            (Some(CameraArgs { iso, shutter, f_number }), _) => {
                vec![("--iso", iso.to_string()), ("--shutter", shutter.to_string()), ("--f-number", f_number.to_string())]
            }
            (None, Exposure::Stops(0.0)) => vec![],
            (None, Exposure::Stops(stops)) => vec![("--exposure", stops.to_string())],
            (None, Exposure::Auto) => vec![("--exposure", "auto".to_owned())],
        };
        let curve = self.tonemap.to_possible_value().filter(|_| self.tonemap != Curve::None);
        let curve = curve.map(|curve| ("--tonemap", curve.get_name().to_owned()));
        exposure.into_iter().chain(curve).flat_map(|(flag, value)| [flag.to_owned(), value]).collect()
    }
}

impl From<Curve> for output::Curve {
    fn from(curve: Curve) -> output::Curve {
        match curve {
            Curve::None => output::Curve::None,
            Curve::Filmic => output::Curve::Filmic,
            Curve::Agx => output::Curve::Agx,
            Curve::Normalize => output::Curve::Normalize,
            Curve::Postcard => output::Curve::Postcard,
        }
    }
}

/// Parses a time in seconds, as a number or a fraction.
fn seconds(text: &str) -> std::result::Result<f32, String> {
    let (part, whole) = text.split_once('/').unwrap_or((text, "1"));
    let quotient = above_zero(part).and_then(|part| Ok(part / above_zero(whole)?));
    quotient.ok().filter(|time| time.is_finite() && *time > 0.0).ok_or("expected seconds such as 0.01 or 1/100".to_owned())
}

fn exposure(text: &str) -> std::result::Result<Exposure, String> {
    let stops = finite(text).map(Exposure::Stops);
    if text == "auto" { Ok(Exposure::Auto) } else { stops.map_err(|_| "expected a number of stops, or auto".to_owned()) }
}
