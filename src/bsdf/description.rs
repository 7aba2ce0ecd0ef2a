//! Materials as scene files describe them, and how they are prepared for rendering.
//!
//! Each model describes itself in its own file; [`described::Material`](Material) is made of all of them by the table in
//! [`bsdf`](super).

use schemars::JsonSchema;
use serde::Serialize;

use super::microfacet::RoughnessKeys;
use super::{Material as Prepared, SurfaceMaterial};
use crate::format::{Textured, Varying, VaryingPerChannel};
use crate::math::Rgb;
use crate::reader::by_kind;
use crate::texture::{Number, Texture};

pub use super::table::described::*;

/// A material as a scene file describes it.
pub trait Description {
    /// The colours and numbers that may be textures, with their keys.
    fn textures(&self) -> Vec<(String, &Textured)>;

    /// The materials it is made of, with their keys.
    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![]
    }

    /// The keys for the roughness of facets, where it has them.
    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        None
    }

    /// Its roughnesses of facets, with their keys.
    fn roughnesses(&self) -> Vec<(&'static str, &Textured)> {
        self.roughness_keys().into_iter().map(|keys| ("roughness", keys.roughness)).collect()
    }

    /// What is wrong with it by itself: a key (or nothing, for the whole) and a sentence for each fault.
    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        vec![]
    }

    /// Prepares it for rendering: pictures are read and tables made.
    fn prepare(&self, builder: &mut dyn Prepare) -> Prepared;

    /// The same with the fine shape and the holes around it.
    fn surface(&self, builder: &mut dyn Prepare) -> SurfaceMaterial {
        self.prepare(builder).into()
    }
}

/// The builder of a scene, as a description sees it. Keys are those of the description: `albedo`, `eta/by`.
pub trait Prepare {
    /// The texture of what reflects light, or stands for a number.
    fn texture(&mut self, key: &str, described: &Textured) -> Texture;

    /// A picture of normals: linear where nothing else is said.
    fn normal_map(&mut self, key: &str, described: &Textured) -> Texture;

    /// A material within this one.
    fn part(&mut self, key: &str, described: &MaterialRef) -> Prepared;

    /// The material within this one, with the fine shape and the holes around it.
    fn surface(&mut self, key: &str, described: &MaterialRef) -> SurfaceMaterial;

    /// Notes a mistake of the scene.
    fn fault(&mut self, key: &str, message: &str);
}

impl dyn Prepare + '_ {
    /// A number that may vary from one end of a range to the other.
    pub fn number<T: Copy + Into<f64>>(&mut self, key: &str, described: &Varying<T>) -> Number {
        let single = |value: T| value.into() as f32;
        match described {
            Varying::Same(value) => Number::Constant(single(*value)),
            Varying::Between(b) => Number::between(single(b.from), single(b.to), self.texture(&format!("{key}/by"), &b.by)),
        }
    }

    /// Three numbers, for red, green and blue.
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
    Inline(Box<Material>),
}

by_kind!(MaterialRef { String => Named(String), Object => Inline(Box<Material>) });

/// What is there of what may be.
pub(super) fn given<'m>((key, texture): (&str, Option<&'m Textured>)) -> Option<(String, &'m Textured)> {
    texture.map(|texture| (key.to_owned(), texture))
}
