//! Materials: how surfaces reflect and transmit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::PerChannel;
use super::texture::Textured;
use super::value::{Extinction, Fraction, Index};
use crate::reader::{by_kind, by_type};

/// How a surface reflects and transmits light.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Material {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Conductor(Conductor),
    Dielectric(Dielectric),
    MatteCone(MatteCone),
}

by_type!(Material {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Conductor(Conductor),
    Dielectric(Dielectric),
    MatteCone(MatteCone),
});

/// Reflects equal radiance in every direction (Lambert).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Diffuse {
    /// The share of light that is reflected.
    pub albedo: Textured,
}

/// Reflects like a perfect mirror.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mirror {
    /// The share of light that is reflected.
    pub color: Textured,
}

/// A smooth metal with index of refraction eta − i·k.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Conductor {
    /// Real part of the index of refraction, relative to the outside.
    pub eta: PerChannel<Index>,
    /// Extinction coefficient.
    pub k: PerChannel<Extinction>,
}

/// Smooth glass, water, …: reflects and refracts.
///
/// Of two faces in exactly one place (a glass box standing on a glass box) only the one listed first is met, and light
/// goes on as if the other body had no surface there: wrong. Describe glued bodies as one mesh without the faces between
/// them; two media that touch (water in a glass) by one face whose `eta` is the ratio of the two; bodies that only stand
/// on each other with a gap of a hundred-thousandth of the scene's size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Dielectric {
    /// Index of refraction inside (the side the normal points away from) divided by that outside.
    pub eta: Index,
    /// Light is multiplied by this at every passage through the surface.
    pub color: Textured,
}

/// Reflects evenly into the cone of half angle 90° · mattness about the mirror direction. Not reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MatteCone {
    /// The share of light that is reflected.
    pub color: Textured,
    /// 0 is a mirror. 1 is a hemisphere about the mirror direction, which is not the same as diffuse.
    pub mattness: Fraction,
}

impl Default for Diffuse {
    fn default() -> Diffuse {
        Diffuse { albedo: Textured::gray(0.5) }
    }
}

impl Default for Mirror {
    fn default() -> Mirror {
        Mirror { color: Textured::white() }
    }
}

impl Default for Dielectric {
    fn default() -> Dielectric {
        Dielectric { eta: Index::known(1.5), color: Textured::white() }
    }
}

impl Default for Material {
    fn default() -> Material {
        Material::Diffuse(Diffuse::default())
    }
}

/// The name of a material under `materials`, or a material.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MaterialRef {
    /// The name of a material under `materials`.
    Named(String),
    Inline(Box<Material>),
}

by_kind!(MaterialRef { String => Named(String), Object => Inline(Material) });
