//! Options for 8-bit pictures: exposure and tone curve.

use clap::ValueEnum;

use super::parse::finite;
use crate::film::Image;
use crate::output;

/// Conversion from radiance to 8 bits.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct ToneMapping {
    /// Stops of exposure, for 8-bit files only; `auto` shows 95 % of the lit pixels below white.
    #[arg(long, value_name = "STOPS", default_value = "0", allow_negative_numbers = true, value_parser = exposure)]
    pub exposure: Exposure,
    /// Tone curve from radiance to display, for 8-bit files only.
    #[arg(long, value_enum, default_value_t = Curve::None)]
    pub tonemap: Curve,
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
        let exposure = match self.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => output::exposure::automatic(image),
        };
        output::Tonemap { exposure, curve: self.tonemap.into() }
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

fn exposure(text: &str) -> std::result::Result<Exposure, String> {
    let stops = finite(text).map(Exposure::Stops);
    if text == "auto" { Ok(Exposure::Auto) } else { stops.map_err(|_| "expected a number of stops, or auto".to_owned()) }
}
