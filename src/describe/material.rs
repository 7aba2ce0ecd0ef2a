//! Materials: how surfaces reflect and transmit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::PerChannel;
use super::texture::Textured;
use super::value::{CoatIndex, Exponent, Extinction, Fraction, Index};
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
    OrenNayar(OrenNayar),
    Phong(Phong),
    BlinnPhong(BlinnPhong),
    Metal(Metal),
    Plastic(Plastic),
    DiffuseTransmission(DiffuseTransmission),
}

by_type!(Material {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Conductor(Conductor),
    Dielectric(Dielectric),
    MatteCone(MatteCone),
    OrenNayar(OrenNayar),
    Phong(Phong),
    BlinnPhong(BlinnPhong),
    Metal(Metal),
    Plastic(Plastic),
    DiffuseTransmission(DiffuseTransmission),
});

impl Material {
    /// The colours that may be textures, with their keys.
    pub(super) fn parts(&self) -> Vec<(&'static str, &Textured)> {
        match self {
            Material::Conductor(_) => vec![],
            Material::Diffuse(Diffuse { albedo }) => vec![("albedo", albedo)],
            Material::OrenNayar(OrenNayar { albedo, .. }) => vec![("albedo", albedo)],
            Material::Plastic(Plastic { albedo, .. }) => vec![("albedo", albedo)],
            Material::Mirror(Mirror { color }) => vec![("color", color)],
            Material::Dielectric(Dielectric { color, .. }) => vec![("color", color)],
            Material::MatteCone(MatteCone { color, .. }) => vec![("color", color)],
            Material::Phong(Phong { color, .. }) => vec![("color", color)],
            Material::BlinnPhong(BlinnPhong { color, .. }) => vec![("color", color)],
            Material::Metal(Metal { color, .. }) => vec![("color", color)],
            Material::DiffuseTransmission(m) => vec![("reflectance", &m.reflectance), ("transmittance", &m.transmittance)],
        }
    }
}

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

/// A rough matte surface (Oren and Nayar): flatter than `diffuse`, and brighter at its edges. No energy is lost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OrenNayar {
    /// The share of light that is reflected, about.
    pub albedo: Textured,
    /// 0 is `diffuse`, 1 the roughest.
    pub roughness: Fraction,
}

/// A glossy lobe around the mirror direction (Phong), normalised. What falls below the surface is lost. Not reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Phong {
    /// The share of light that is reflected, at most.
    pub color: Textured,
    /// The lobe is the cosine to this power: the larger, the sharper.
    pub exponent: Exponent,
}

/// A glossy lobe of half vectors (Blinn and Phong), normalised. What falls below the surface is lost. Not reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BlinnPhong {
    /// The share of light that is reflected, at most.
    pub color: Textured,
    /// Half vectors are spread as the cosine to this power: the larger, the sharper.
    pub exponent: Exponent,
}

/// A mirror with shaken reflections: the mirror direction plus `roughness` times a point on the unit sphere. What falls
/// below the surface is lost. Not reciprocal. For measured metals see `conductor`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Metal {
    /// The share of light that is reflected, at most.
    pub color: Textured,
    /// 0 is a mirror.
    pub roughness: Fraction,
}

/// A matte ground under a clear smooth coat that reflects, refracts, and throws light back on the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Plastic {
    /// The share of light that the ground reflects.
    pub albedo: Textured,
    /// Index of refraction of the coat over that outside.
    pub eta: CoatIndex,
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

impl Default for OrenNayar {
    fn default() -> OrenNayar {
        OrenNayar { albedo: Textured::gray(0.5), roughness: Fraction::known(0.5) }
    }
}

impl Default for Phong {
    fn default() -> Phong {
        Phong { color: Textured::white(), exponent: Exponent::known(10.0) }
    }
}

impl Default for BlinnPhong {
    fn default() -> BlinnPhong {
        BlinnPhong { color: Textured::white(), exponent: Exponent::known(10.0) }
    }
}

impl Default for Metal {
    fn default() -> Metal {
        Metal { color: Textured::white(), roughness: Fraction::known(0.0) }
    }
}

impl Default for Plastic {
    fn default() -> Plastic {
        Plastic { albedo: Textured::gray(0.5), eta: CoatIndex::known(1.5) }
    }
}

impl Default for DiffuseTransmission {
    fn default() -> DiffuseTransmission {
        DiffuseTransmission { reflectance: Textured::gray(0.25), transmittance: Textured::gray(0.25) }
    }
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
