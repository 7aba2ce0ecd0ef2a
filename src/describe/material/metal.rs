//! Metals by their index of refraction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::finish::{Alpha, Distribution, Finish, finish_of};
use crate::format::{Extinction, Index, Textured, VaryingPerChannel};

/// Metal: a polished mirror, or rough. By its name, by its index of refraction eta − i·k, or by its colour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Conductor {
    /// A chemical element: its published index, reduced to red, green and blue. Seen straight on it has the colour in daylight of
    /// its published spectrum; but for gold, whose red of 1.04 no red, green and blue can show: it is 0.97.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metal: Option<Element>,
    /// Real part of the index of refraction, relative to the outside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta: Option<VaryingPerChannel<Index>>,
    /// Extinction coefficient.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k: Option<VaryingPerChannel<Extinction>>,
    /// The colour that is seen straight on; it fades to white along the surface (Schlick).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<Textured>,
    /// 0 is a mirror, 1 nearly matte. The width of highlights, alpha, is its square, so that equal steps look equal. Below
    /// 0.001 a surface is as good as smooth. (Of a colour, the mean.)
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate. (Of a colour, the mean.)
    pub anisotropy: Textured,
    /// In place of `roughness` and `anisotropy`, the width itself; `[along u, along v]` for each of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Alpha>,
    /// How the facets of a rough surface lean.
    pub distribution: Distribution,
    /// Follow light that is reflected more than once among the facets. Without, rough metals are too dark: white ones of
    /// roughness 0.7 lose 30 % of the light, of roughness 1 60 %. It costs tables (30 ms once for each metal with GGX, six
    /// times that with Beckmann, twenty to thirty times where the roughness is a texture or anisotropic, a hundred times where the
    /// anisotropy is a texture or both; those are known to 1 %) and a fifth of the time of a reflection; where `eta` or `k` vary, two microseconds more.
    pub multiscatter: bool,
}

finish_of!(Conductor);

/// A metal, by its chemical symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub enum Element {
    /// Silver.
    Ag,
    /// Aluminium.
    Al,
    /// Gold.
    Au,
    /// Chromium.
    Cr,
    /// Copper.
    Cu,
    /// Iron.
    Fe,
    /// Nickel.
    Ni,
    /// Titanium.
    Ti,
    /// Tungsten.
    W,
}

impl Default for Conductor {
    fn default() -> Conductor {
        Conductor {
            metal: None,
            eta: None,
            k: None,
            color: None,
            roughness: Textured::black(),
            anisotropy: Textured::black(),
            alpha: None,
            distribution: Distribution::Ggx,
            multiscatter: true,
        }
    }
}
