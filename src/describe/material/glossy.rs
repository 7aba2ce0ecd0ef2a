//! Mirrors, and lobes about the mirror direction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Exponent, Textured, Varying};

/// Reflects like a perfect mirror.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mirror {
    /// The share of light that is reflected.
    pub color: Textured,
}

/// Reflects evenly into the cone of half angle 90° · mattness about the mirror direction. Not reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MatteCone {
    /// The share of light that is reflected.
    pub color: Textured,
    /// 0 is a mirror. 1 is a hemisphere about the mirror direction, which is not the same as diffuse.
    pub mattness: Textured,
}

/// A glossy lobe around the mirror direction (Phong), normalised. What falls below the surface is lost. Not reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Phong {
    /// The share of light that is reflected, at most.
    pub color: Textured,
    /// The lobe is the cosine to this power: the larger, the sharper.
    pub exponent: Varying<Exponent>,
}

/// A glossy lobe of half vectors (Blinn and Phong), normalised. What falls below the surface is lost. Not reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BlinnPhong {
    /// The share of light that is reflected, at most.
    pub color: Textured,
    /// Half vectors are spread as the cosine to this power: the larger, the sharper.
    pub exponent: Varying<Exponent>,
}

/// A mirror with shaken reflections: the mirror direction plus `roughness` times a point on the unit sphere. What falls
/// below the surface is lost. Not reciprocal. For measured metals see `conductor`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Metal {
    /// The share of light that is reflected, at most.
    pub color: Textured,
    /// 0 is a mirror.
    pub roughness: Textured,
}

impl Default for Mirror {
    fn default() -> Mirror {
        Mirror { color: Textured::white() }
    }
}

impl Default for Phong {
    fn default() -> Phong {
        Phong { color: Textured::white(), exponent: Varying::Same(Exponent::known(10.0)) }
    }
}

impl Default for BlinnPhong {
    fn default() -> BlinnPhong {
        BlinnPhong { color: Textured::white(), exponent: Varying::Same(Exponent::known(10.0)) }
    }
}

impl Default for Metal {
    fn default() -> Metal {
        Metal { color: Textured::white(), roughness: Textured::black() }
    }
}
