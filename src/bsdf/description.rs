//! Descriptions of materials, as scene files have them, and their preparation for rendering.
//!
//! The description of each model is in the model's file. The table of materials in [`bsdf`](super) combines them to
//! [`described::Material`](Material).

use schemars::JsonSchema;
use serde::Serialize;

use super::microfacet::RoughnessKeys;
use super::{Material as Prepared, SurfaceMaterial};
use crate::format::{Textured, Varying, VaryingPerChannel};
use crate::math::Rgb;
use crate::reader::by_kind;
use crate::texture::{Number, Texture};

pub use super::table::described::*;

/// The description of a material in a scene file.
pub trait Description {
    /// The colours and numbers that may have textures, with their keys.
    fn textures(&self) -> Vec<(String, &Textured)>;

    /// The materials that this one is made of, with their keys.
    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![]
    }

    /// The keys for the roughness of facets, if the material has them.
    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        None
    }

    /// The roughness parameters of facets, with their keys.
    fn roughnesses(&self) -> Vec<(&'static str, &Textured)> {
        self.roughness_keys().into_iter().map(|keys| ("roughness", keys.roughness)).collect()
    }

    /// The faults of the description by itself, each with the pointer of a key (empty for the whole material) and a message.
    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        vec![]
    }

    /// Prepares the material for rendering: reads pictures and computes tables.
    fn prepare(&self, builder: &mut dyn Prepare) -> Prepared;

    /// Prepares the material with its normal or bump map and its opacity.
    fn surface(&self, builder: &mut dyn Prepare) -> SurfaceMaterial {
        self.prepare(builder).into()
    }
}

/// The services of the scene's builder for a description. Keys are those of the description: `albedo`, `eta/by`.
pub trait Prepare {
    /// Builds the texture of a reflectance or of a number from 0 to 1.
    fn texture(&mut self, key: &str, described: &Textured) -> Texture;

    /// Builds the texture of a number from 0 to 1 that is looked up at points, and not averaged over what a pixel shows.
    fn texture_at_points(&mut self, key: &str, described: &Textured) -> Texture;

    /// Builds the texture of a normal map, which is looked up at points. Its picture is linear unless its `encoding` says otherwise.
    fn normal_map(&mut self, key: &str, described: &Textured) -> Texture;

    /// Prepares a material within this one.
    fn part(&mut self, key: &str, described: &MaterialRef) -> Prepared;

    /// Prepares a material within this one, with its normal or bump map and its opacity.
    fn surface(&mut self, key: &str, described: &MaterialRef) -> SurfaceMaterial;

    /// Adds a fault of the scene.
    fn fault(&mut self, key: &str, message: &str);
}

impl dyn Prepare + '_ {
    /// Builds a number that may vary between the ends of a range.
    pub fn number<T: Copy + Into<f64>>(&mut self, key: &str, described: &Varying<T>) -> Number {
        let single = |value: T| value.into() as f32;
        match described {
            Varying::Same(value) => Number::Constant(single(*value)),
            Varying::Between(b) => Number::between(single(b.from), single(b.to), self.texture(&format!("{key}/by"), &b.by)),
        }
    }

    /// Builds three numbers, for red, green and blue.
    pub fn channels<T: Copy + Into<f64>>(&mut self, key: &str, described: &VaryingPerChannel<T>) -> Texture {
        match described {
            VaryingPerChannel::Equal(value) => Texture::Constant(Rgb::gray((*value).into() as f32)),
            VaryingPerChannel::Each(values) => Texture::Constant(Rgb::from_f64(values.map(Into::into))),
            VaryingPerChannel::Between(b) => {
                let by = self.texture(&format!("{key}/by"), &b.by);
                Texture::between(Rgb::from_f64(b.from.each()), Rgb::from_f64(b.to.each()), by)
            }
        }
    }
}

impl Default for Material {
    fn default() -> Material {
        Material::Diffuse(super::diffuse::described::Diffuse::default())
    }
}

/// The name of a material under `materials`, or a material.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MaterialRef {
    /// The name of a material under `materials`.
    Named(String),
    /// A material described in place.
    Inline(Box<Material>),
}

by_kind!(MaterialRef { String => Named(String), Object => Inline(Box<Material>) });

/// The key and the texture of an optional parameter; `None` where it is not given.
pub(super) fn given<'m>((key, texture): (&str, Option<&'m Textured>)) -> Option<(String, &'m Textured)> {
    texture.map(|texture| (key.to_owned(), texture))
}
