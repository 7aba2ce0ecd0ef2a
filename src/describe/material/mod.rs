//! Materials: how surfaces reflect and transmit.

mod coated;
mod compound;
mod finish;
mod glass;
mod glossy;
mod matte;
mod metal;
mod principled;
mod skin;

use schemars::JsonSchema;
use serde::Serialize;

use crate::format::{Textured, Varying, VaryingPerChannel};
use crate::reader::{by_kind, by_type};

pub use coated::*;
pub use compound::*;
pub use finish::*;
pub use glass::*;
pub use glossy::*;
pub use matte::*;
pub use metal::*;
pub use principled::*;
pub use skin::*;

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
    Coated(Coated),
    Mix(MaterialMix),
    Sheen(Sheen),
    TwoSided(TwoSided),
    Principled(Principled),
    Bumped(Bumped),
    Masked(Masked),
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
    Coated(Coated),
    Mix(MaterialMix),
    Sheen(Sheen),
    TwoSided(TwoSided),
    Principled(Principled),
    Bumped(Bumped),
    Masked(Masked),
});

impl Material {
    /// The colours and numbers that may be textures, with their keys.
    pub(super) fn textures(&self) -> Vec<(&'static str, &Textured)> {
        match self {
            Material::Diffuse(m) => vec![("albedo", &m.albedo)],
            Material::Mirror(m) => vec![("color", &m.color)],
            Material::Conductor(m) => {
                let by = [
                    ("color", m.color.as_ref()),
                    ("eta/by", m.eta.as_ref().and_then(VaryingPerChannel::by)),
                    ("k/by", m.k.as_ref().and_then(VaryingPerChannel::by)),
                ];
                by.into_iter().filter_map(given).chain(m.finish().textures()).collect()
            }
            Material::Dielectric(m) => {
                given(("eta/by", m.eta.by())).into_iter().chain([("color", &m.color)]).chain(m.finish().textures()).collect()
            }
            Material::MatteCone(m) => vec![("color", &m.color), ("mattness", &m.mattness)],
            Material::OrenNayar(m) => vec![("albedo", &m.albedo), ("roughness", &m.roughness)],
            Material::Phong(m) => given(("exponent/by", m.exponent.by())).into_iter().chain([("color", &m.color)]).collect(),
            Material::BlinnPhong(m) => given(("exponent/by", m.exponent.by())).into_iter().chain([("color", &m.color)]).collect(),
            Material::Metal(m) => vec![("color", &m.color), ("roughness", &m.roughness)],
            Material::Plastic(m) => {
                given(("eta/by", m.eta.by())).into_iter().chain([("albedo", &m.albedo)]).chain(m.finish().textures()).collect()
            }
            Material::DiffuseTransmission(m) => vec![("reflectance", &m.reflectance), ("transmittance", &m.transmittance)],
            Material::ThinDielectric(m) => given(("eta/by", m.eta.by())).into_iter().chain([("color", &m.color)]).collect(),
            Material::Coated(m) => {
                given(("eta/by", m.eta.by())).into_iter().chain([("color", &m.color)]).chain(m.finish().textures()).collect()
            }
            Material::Mix(m) => [("share", m.share.as_ref()), ("fresnel/by", m.fresnel.as_ref().and_then(Varying::by))]
                .into_iter()
                .filter_map(given)
                .collect(),
            Material::Sheen(m) => vec![("color", &m.color), ("roughness", &m.roughness)],
            Material::TwoSided(_) => vec![],
            Material::Principled(m) => {
                let by = [("eta/by", m.eta.by()), ("coat_eta/by", m.coat_eta.by())];
                let shares = [
                    ("base_color", &m.base_color),
                    ("metallic", &m.metallic),
                    ("roughness", &m.roughness),
                    ("anisotropy", &m.anisotropy),
                    ("specular", &m.specular),
                    ("transmission", &m.transmission),
                    ("coat", &m.coat),
                    ("coat_roughness", &m.coat_roughness),
                    ("coat_color", &m.coat_color),
                    ("sheen_color", &m.sheen_color),
                    ("sheen_roughness", &m.sheen_roughness),
                ];
                shares.into_iter().chain(by.into_iter().filter_map(given)).collect()
            }
            Material::Bumped(m) => {
                let maps = [("normal_map", m.normal_map.as_ref()), ("bump_map", m.bump_map.as_ref()), ("scale/by", m.scale.by())];
                maps.into_iter().filter_map(given).collect()
            }
            Material::Masked(m) => vec![("opacity", &m.opacity)],
        }
    }

    /// The materials it is made of, with their keys.
    pub(super) fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        match self {
            Material::Coated(m) => vec![("ground", &m.ground)],
            Material::Mix(m) => vec![("a", &m.a), ("b", &m.b)],
            Material::Sheen(m) => vec![("ground", &m.ground)],
            Material::TwoSided(m) => m.front.iter().map(|side| ("front", side)).chain(m.back.iter().map(|side| ("back", side))).collect(),
            Material::Bumped(m) => vec![("surface", &m.surface)],
            Material::Masked(m) => vec![("surface", &m.surface)],
            _ => vec![],
        }
    }

    /// Its roughnesses of facets, with their keys.
    pub(super) fn roughnesses(&self) -> Vec<(&'static str, &Textured)> {
        match self {
            Material::Principled(m) => vec![("roughness", &m.roughness), ("coat_roughness", &m.coat_roughness)],
            other => other.finish().into_iter().map(|finish| ("roughness", finish.roughness)).collect(),
        }
    }

    /// How rough it is, where it has the keys for that.
    pub(super) fn finish(&self) -> Option<Finish<'_>> {
        match self {
            Material::Conductor(m) => Some(m.finish()),
            Material::Dielectric(m) => Some(m.finish()),
            Material::Plastic(m) => Some(m.finish()),
            Material::Coated(m) => Some(m.finish()),
            _ => None,
        }
    }
}

/// What is there of what may be.
fn given<'m>((key, texture): (&'static str, Option<&'m Textured>)) -> Option<(&'static str, &'m Textured)> {
    texture.map(|texture| (key, texture))
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

by_kind!(MaterialRef { String => Named(String), Object => Inline(Box<Material>) });
