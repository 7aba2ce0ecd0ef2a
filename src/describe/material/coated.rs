//! Clear coats.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MaterialRef;
use super::finish::{Alpha, Distribution, Finish, finish_of};
use crate::format::{CoatIndex, Textured, Varying};

/// A matte ground under a clear coat that reflects, refracts, and throws light back on the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Plastic {
    /// The share of light that the ground reflects.
    pub albedo: Textured,
    /// Index of refraction of the coat over that outside.
    pub eta: Varying<CoatIndex>,
    /// 0 is smooth, 1 the roughest. The width of highlights, alpha, is its square, so that equal steps look equal. Below 0.001 a
    /// surface is as good as smooth. (Of a colour, the mean.)
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate. (Of a colour, the mean.)
    pub anisotropy: Textured,
    /// In place of `roughness` and `anisotropy`, the width itself; `[along u, along v]` for each of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Alpha>,
    /// How the facets of a rough surface lean.
    pub distribution: Distribution,
}

/// A clear coat on any material: varnish, glaze, lacquer. No energy is lost over matte grounds and mirrors, nor where there are
/// other coats in between. Over others that scatter widely some is: over white `oren_nayar` up to 5 %, over white metal that is
/// rough up to 6 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Coated {
    /// What lies under the coat. The colours of a matte one look deeper, as light is thrown back on it from within.
    pub ground: MaterialRef,
    /// Index of refraction of the coat over that outside.
    #[serde(default = "glassy")]
    pub eta: Varying<CoatIndex>,
    /// What the coat leaves of light that goes straight down through it and up again.
    #[serde(default = "Textured::white")]
    pub color: Textured,
    /// 0 is smooth, 1 the roughest. The width of highlights, alpha, is its square, so that equal steps look equal. Below 0.001 a
    /// surface is as good as smooth. (Of a colour, the mean.)
    #[serde(default = "Textured::black")]
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate. (Of a colour, the mean.)
    #[serde(default = "Textured::black")]
    pub anisotropy: Textured,
    /// In place of `roughness` and `anisotropy`, the width itself; `[along u, along v]` for each of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Alpha>,
    /// How the facets of a rough surface lean.
    #[serde(default)]
    pub distribution: Distribution,
}

finish_of!(Plastic, Coated);

fn glassy() -> Varying<CoatIndex> {
    Varying::Same(CoatIndex::known(1.5))
}

impl Default for Plastic {
    fn default() -> Plastic {
        Plastic {
            albedo: Textured::gray(0.5),
            eta: glassy(),
            roughness: Textured::black(),
            anisotropy: Textured::black(),
            alpha: None,
            distribution: Distribution::Ggx,
        }
    }
}
