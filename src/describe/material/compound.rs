//! Materials made of materials.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MaterialRef;
use crate::format::{Index, Textured, Varying};

/// Two materials side by side, too fine to be told apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialMix {
    /// The first.
    pub a: MaterialRef,
    /// The second.
    pub b: MaterialRef,
    /// How much of `b`: 0 is all `a`. (Of a colour, the mean.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<Textured>,
    /// In place of `share`: `b` shows where a surface with this index of refraction reflects, along the surface above all. A little
    /// energy is lost unless `b` is a mirror.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fresnel: Option<Varying<Index>>,
}

/// Fibres that stand up from a material and catch the light where one looks along it: velvet, dust. White ones lose no energy over
/// matte grounds and mirrors. Others that scatter widely lose some under them: white `oren_nayar` and metal of roughness 1 up to
/// 13 %, white plastic up to 0.6 %. Coloured fibres keep light of all colours from the ground as their brightest one does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sheen {
    /// What the fibres stand on.
    pub ground: MaterialRef,
    /// Of the fibres.
    #[serde(default = "Textured::white")]
    pub color: Textured,
    /// 0.1 (and below) are fibres that stand straight, 1 lie all ways. (Of a colour, the mean.)
    #[serde(default = "half")]
    pub roughness: Textured,
}

/// A sheet with two faces. Nothing goes through; a side that is left out is black.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TwoSided {
    /// Where the normal points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front: Option<MaterialRef>,
    /// On the other side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub back: Option<MaterialRef>,
}

fn half() -> Textured {
    Textured::gray(0.5)
}
