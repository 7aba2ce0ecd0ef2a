//! Materials: how surfaces reflect and transmit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::{Color, PerChannel};
use super::texture::Textured;
use super::value::{CoatIndex, Exponent, Extinction, Fraction, Index, Positive};
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
    ThinDielectric(ThinDielectric),
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
    ThinDielectric(ThinDielectric),
});

impl Material {
    /// The colours that may be textures, with their keys.
    pub(super) fn parts(&self) -> Vec<(&'static str, &Textured)> {
        match self {
            Material::Conductor(Conductor { roughness, .. }) => vec![("roughness", roughness)],
            Material::Diffuse(Diffuse { albedo }) => vec![("albedo", albedo)],
            Material::OrenNayar(OrenNayar { albedo, .. }) => vec![("albedo", albedo)],
            Material::Plastic(Plastic { albedo, .. }) => vec![("albedo", albedo)],
            Material::Mirror(Mirror { color }) => vec![("color", color)],
            Material::Dielectric(Dielectric { color, roughness, .. }) => vec![("color", color), ("roughness", roughness)],
            Material::ThinDielectric(ThinDielectric { color, .. }) => vec![("color", color)],
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

/// Metal: a polished mirror, or rough. Either by name, or by its index of refraction eta − i·k.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Conductor {
    /// A chemical element: its published index, reduced to red, green and blue.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metal: Option<Element>,
    /// Real part of the index of refraction, relative to the outside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta: Option<PerChannel<Index>>,
    /// Extinction coefficient.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k: Option<PerChannel<Extinction>>,
    /// 0 is a mirror, 1 nearly matte. The width of highlights, alpha, is its square, so that equal steps look equal. Below
    /// 0.001 a surface is as good as smooth. (Of a colour, the mean.)
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate.
    pub anisotropy: Fraction,
    /// In place of `roughness` and `anisotropy`, the width itself: one number, or `[along u, along v]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Alpha>,
    /// How the facets of a rough surface lean.
    pub distribution: Distribution,
    /// Follow light that is reflected more than once among the facets. Without, rough metals are too dark: white ones of
    /// roughness 0.7 lose 30 % of the light, of roughness 1 60 %. It costs tables (30 ms once for each metal with GGX, six
    /// times that with Beckmann, twenty to thirty times where the roughness is a texture or anisotropic) and a fifth of the time
    /// of a reflection.
    pub multiscatter: bool,
}

/// Glass, water, …: reflects and refracts, clear or frosted.
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
    /// 0 is clear, 1 frosted. The width of highlights, alpha, is its square, so that equal steps look equal. Below 0.001 a
    /// surface is as good as smooth. (Of a colour, the mean.)
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate.
    pub anisotropy: Fraction,
    /// In place of `roughness` and `anisotropy`, the width itself: one number, or `[along u, along v]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Alpha>,
    /// How the facets of a rough surface lean.
    pub distribution: Distribution,
    /// Follow light that meets more than one facet. Without, frosted glass is too dark, from inside above all. It costs tables
    /// (70 ms once for each glass with GGX, five times that with Beckmann, fifteen to thirty times where the roughness is a texture
    /// or anisotropic) and a fifth of the time of a scattering.
    pub multiscatter: bool,
    /// What the glass itself takes of the light on its way through. Exact for a closed body with nothing in it: the way from
    /// one meeting with this surface to the next counts, so that light on its way to something inside of the body is not dimmed,
    /// and an open surface dims whatever reaches it from behind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption: Option<Absorption>,
}

/// The colour that is left of white light after a distance (Beer and Lambert): colour^(way / distance).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Absorption {
    /// The share of light that is left.
    pub color: Color<Fraction>,
    /// After how long a way inside (m).
    pub distance: Positive,
}

/// A pane or a bubble as one surface without thickness: both faces and all reflections between them. Light passes straight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ThinDielectric {
    /// Index of refraction of the pane divided by that around it.
    pub eta: Index,
    /// Light that passes or is reflected is multiplied by this once.
    pub color: Textured,
}

/// The width of highlights: one number, or `[along u, along v]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Alpha {
    Round(Fraction),
    Along([Fraction; 2]),
}

by_kind!(Alpha { Number => Round(Fraction), Array => Along([Fraction; 2]) });

/// How the facets of a rough surface lean.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Distribution {
    /// Trowbridge and Reitz's: highlights with long tails, as measured ones have.
    #[default]
    Ggx,
    /// Gaussian slopes: highlights that end soon.
    Beckmann,
}

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
        Dielectric {
            eta: Index::known(1.5),
            color: Textured::white(),
            roughness: Textured::black(),
            anisotropy: Fraction::known(0.0),
            alpha: None,
            distribution: Distribution::Ggx,
            multiscatter: true,
            absorption: None,
        }
    }
}

impl Default for Conductor {
    fn default() -> Conductor {
        Conductor {
            metal: None,
            eta: None,
            k: None,
            roughness: Textured::black(),
            anisotropy: Fraction::known(0.0),
            alpha: None,
            distribution: Distribution::Ggx,
            multiscatter: true,
        }
    }
}

impl Default for ThinDielectric {
    fn default() -> ThinDielectric {
        ThinDielectric { eta: Index::known(1.5), color: Textured::white() }
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
