//! The film: the image's size, the part of it to render, the pixel filter.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Fraction, Positive, Side};
use crate::reader::by_type;

/// The image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Film {
    /// Pixels.
    pub width: Side,
    /// Pixels.
    pub height: Side,
    /// The part to render: `[x0, x1, y0, y1]` in pixels from the top left, x0 ≤ x < x1 and y0 ≤ y < y1.
    /// Its pixels are those of the full image, bit for bit. Default: all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crop: Option<[u32; 4]>,
    /// The pixel filter.
    pub filter: Filter,
    /// What is kept beside the picture, in EXR files: means over each pixel of what the camera meets first, or of the light by the way
    /// it came. The picture itself does not change.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
}

/// A layer beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// The share of light that the first surface scatters: `Albedo.R`, `.G`, `.B`.
    Albedo,
    /// Its geometric normal: `N.X`, `.Y`, `.Z`.
    N,
    /// Its shading normal: `Ns.X`, `.Y`, `.Z`.
    Ns,
    /// Where it is, in metres: `P.X`, `.Y`, `.Z`.
    P,
    /// How far it is along the camera's axis, in metres: `Z`.
    Z,
    /// Its texture coordinates: `uv.U`, `uv.V`.
    Uv,
    /// The light that the camera sees at its source: `Emission.R`, `.G`, `.B`.
    Emission,
    /// The light that was scattered once: `Direct.R`, `.G`, `.B`.
    Direct,
    /// The light that was scattered more often: `Indirect.R`, `.G`, `.B`. The three add up to the picture.
    Indirect,
    /// The light of each light, however it came: `Light.NAME.R`, `.G`, `.B`. All of them add up to the picture.
    Lights,
    /// Seconds that the pixel took: `Time.Y`. The only layer that is another one each time.
    Time,
}

/// How samples near a pixel contribute to it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Filter {
    Box(BoxFilter),
    Tent(TentFilter),
    Gaussian(GaussianFilter),
    Mitchell(MitchellFilter),
}

by_type!(Filter { Box(BoxFilter), Tent(TentFilter), Gaussian(GaussianFilter), Mitchell(MitchellFilter) });

/// The mean over the pixel, if the radius is ½.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoxFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
}

/// Falls linearly to 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TentFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
}

/// A bell curve, lowered so that it reaches 0 at its radius.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GaussianFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
    /// Standard deviation, in pixels.
    pub sigma: Positive,
}

/// The cubic of Mitchell and Netravali: sharp, with slight negative lobes. Samples there count negatively, which is noise even in a
/// picture of one colour; the other filters have none there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MitchellFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
    /// Blur.
    pub b: Fraction,
    /// Ringing.
    pub c: Fraction,
}

impl Default for Film {
    fn default() -> Film {
        Film { width: Side::known(512), height: Side::known(512), crop: None, filter: Filter::Box(BoxFilter::default()), layers: vec![] }
    }
}

impl Default for BoxFilter {
    fn default() -> BoxFilter {
        BoxFilter { radius: Positive::known(0.5) }
    }
}

impl Default for TentFilter {
    fn default() -> TentFilter {
        TentFilter { radius: Positive::known(1.0) }
    }
}

impl Default for GaussianFilter {
    fn default() -> GaussianFilter {
        GaussianFilter { radius: Positive::known(1.5), sigma: Positive::known(0.5) }
    }
}

impl Default for MitchellFilter {
    fn default() -> MitchellFilter {
        MitchellFilter { radius: Positive::known(2.0), b: Fraction::known(1.0 / 3.0), c: Fraction::known(1.0 / 3.0) }
    }
}

impl Film {
    /// The part to render, `[x0, x1, y0, y1]`.
    pub fn bounds(&self) -> [u32; 4] {
        self.crop.unwrap_or([0, self.width.get(), 0, self.height.get()])
    }
}
