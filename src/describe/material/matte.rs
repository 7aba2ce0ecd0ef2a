//! Surfaces that scatter light all around.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::Textured;

/// Reflects equal radiance in every direction (Lambert).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Diffuse {
    /// The share of light that is reflected.
    pub albedo: Textured,
}

/// A rough matte surface (Oren and Nayar): flatter than `diffuse`, and brighter at its edges. No energy is lost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OrenNayar {
    /// The share of light that is reflected, about.
    pub albedo: Textured,
    /// 0 is `diffuse`, 1 the roughest.
    pub roughness: Textured,
}

/// A thin matte sheet, the same from both sides: paper, a leaf, a lampshade.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DiffuseTransmission {
    /// The share of light that is reflected. Where it and `transmittance` add up to more than 1 both are scaled down.
    pub reflectance: Textured,
    /// The share of light that goes through.
    pub transmittance: Textured,
}

impl Default for Diffuse {
    fn default() -> Diffuse {
        Diffuse { albedo: Textured::gray(0.5) }
    }
}

impl Default for OrenNayar {
    fn default() -> OrenNayar {
        OrenNayar { albedo: Textured::gray(0.5), roughness: Textured::gray(0.5) }
    }
}

impl Default for DiffuseTransmission {
    fn default() -> DiffuseTransmission {
        DiffuseTransmission { reflectance: Textured::gray(0.25), transmittance: Textured::gray(0.25) }
    }
}
