//! Description of the film: the image's size, the part of it to render, the pixel filter.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Fraction, NonNegative, Positive, Side};
use crate::reader::by_type;

/// The image: its size, pixel filter and layers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Film {
    /// The width, in pixels.
    pub width: Side,
    /// The height, in pixels.
    pub height: Side,
    /// The part to render: `[x0, x1, y0, y1]` in pixels from the top left, x0 ≤ x < x1 and y0 ≤ y < y1.
    /// Its pixels are those of the full image, bit for bit. Default: the full image.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crop: Option<[u32; 4]>,
    /// The pixel filter.
    pub filter: Filter,
    /// The width of the area around a camera ray over which textures are averaged, in pixels; 0 looks them up at points. Default: 1/n
    /// pixels after n samples, n rounded down to a power of two, so that the blur vanishes as samples are added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture_footprint: Option<NonNegative>,
    /// The layers that EXR files have beside the picture: means over each pixel of properties of the first surface, or of light sorted
    /// by its path. The picture itself does not change.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
}

/// A layer of an EXR file beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// The albedo of the first surface, the share of light that it scatters: `Albedo.R`, `.G`, `.B`.
    Albedo,
    /// The geometric normal of the first surface: `N.X`, `.Y`, `.Z`.
    N,
    /// The shading normal of the first surface: `Ns.X`, `.Y`, `.Z`.
    Ns,
    /// The position of the first surface, in metres: `P.X`, `.Y`, `.Z`.
    P,
    /// The depth of the first surface along the camera's axis, in metres: `Z`.
    Z,
    /// The texture coordinates of the first surface: `uv.U`, `uv.V`.
    Uv,
    /// The light that comes from its source to the camera without scattering: `Emission.R`, `.G`, `.B`.
    Emission,
    /// The light that was scattered once: `Direct.R`, `.G`, `.B`.
    Direct,
    /// The light that was scattered more than once: `Indirect.R`, `.G`, `.B`. Emission, direct and indirect light add up to the picture.
    Indirect,
    /// One layer for each light source, with all of its light: `Light.NAME.R`, `.G`, `.B`. These layers add up to the picture.
    Lights,
    /// The time that the pixel took, in seconds: `Time.Y`. It is the only layer that differs from one render to the next.
    Time,
}

/// The pixel filter: the weight of a sample by its distance from the centre of the pixel.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Filter {
    Box(BoxFilter),
    Tent(TentFilter),
    Gaussian(GaussianFilter),
    Mitchell(MitchellFilter),
}

by_type!(Filter { Box(BoxFilter), Tent(TentFilter), Gaussian(GaussianFilter), Mitchell(MitchellFilter) });

/// A constant weight: with radius ½ the mean over the pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoxFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
}

/// A weight that falls linearly to 0 at the radius.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TentFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
}

/// A Gaussian, lowered so that it reaches 0 at its radius.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GaussianFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
    /// Standard deviation, in pixels.
    pub sigma: Positive,
}

/// The cubic of Mitchell and Netravali: sharp, with slight negative lobes. The negative weights cause noise even in a picture of one
/// colour, where the other filters have none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MitchellFilter {
    /// Half the filter's width and height, in pixels.
    pub radius: Positive,
    /// The parameter B, from 0 to 1: larger values blur.
    pub b: Fraction,
    /// The parameter C, from 0 to 1: larger values ring.
    pub c: Fraction,
}

impl Default for Film {
    fn default() -> Film {
        Film {
            width: Side::known(512),
            height: Side::known(512),
            crop: None,
            filter: Filter::Box(BoxFilter::default()),
            texture_footprint: None,
            layers: vec![],
        }
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
    /// Whether textures are averaged over footprints.
    pub fn has_footprints(&self) -> bool {
        self.texture_footprint.is_none_or(|width| width.get() > 0.0)
    }

    /// The part to render, `[x0, x1, y0, y1]` in pixels: the crop, or the full image.
    pub fn bounds(&self) -> [u32; 4] {
        self.crop.unwrap_or([0, self.width.get(), 0, self.height.get()])
    }
}
