//! The material of interchange formats and painting programs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{CoatIndex, Textured, Varying};

/// Metal, plastic, glass, lacquer and velvet by a base colour and some shares, as in glTF and painting programs. White plastic loses
/// up to 0.7 % of the light under a coat, 0.6 % under white sheen of the default roughness, 2.6 % under both; rough metal up to 6
/// and 13 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Principled {
    /// Of metal the colour that is seen straight on, of plastic that of its ground, of glass what passes or is reflected.
    pub base_color: Textured,
    /// The share of metal.
    pub metallic: Textured,
    /// Of metal, plastic and glass: 0 is smooth, 1 the roughest.
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate.
    pub anisotropy: Textured,
    /// How much of the plastic is clad in its clear layer: without, it is matte.
    pub specular: Textured,
    /// Index of refraction of plastic and glass.
    pub eta: Varying<CoatIndex>,
    /// The share of glass in what is not metal.
    pub transmission: Textured,
    /// The share that is coated with another clear layer.
    pub coat: Textured,
    /// Of that layer.
    pub coat_roughness: Textured,
    /// Of that layer.
    pub coat_eta: Varying<CoatIndex>,
    /// What that layer leaves of light that goes straight down through it and up again.
    pub coat_color: Textured,
    /// Fibres on the surface; black is none.
    pub sheen_color: Textured,
    /// Of the fibres: 0.1 (and below) stand straight, 1 lie all ways.
    pub sheen_roughness: Textured,
    /// Follow light that facets of metal and glass reflect more than once.
    pub multiscatter: bool,
}

impl Default for Principled {
    fn default() -> Principled {
        Principled {
            base_color: Textured::gray(0.8),
            metallic: Textured::black(),
            roughness: Textured::gray(0.5),
            anisotropy: Textured::black(),
            specular: Textured::white(),
            eta: Varying::Same(CoatIndex::known(1.5)),
            transmission: Textured::black(),
            coat: Textured::black(),
            coat_roughness: Textured::black(),
            coat_eta: Varying::Same(CoatIndex::known(1.5)),
            coat_color: Textured::white(),
            sheen_color: Textured::black(),
            sheen_roughness: Textured::gray(0.5),
            multiscatter: true,
        }
    }
}
