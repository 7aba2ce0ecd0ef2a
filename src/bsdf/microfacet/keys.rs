//! The keys of scene files for roughness, which all rough materials have.

use glam::Vec2;
use schemars::JsonSchema;
use serde::Serialize;

use super::roughness::{Alpha, Roughness, alpha};
use super::{Distribution, Microfacets};
use crate::bsdf::description::Prepare;
use crate::format::{self, Fraction, Textured};
use crate::math::Rgb;
use crate::reader::by_kind;
use crate::texture::Texture;

/// The width of highlights, from 0 to 1: a number or a texture, or `[along u, along v]`, each a number or a texture.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum AlphaKey {
    /// One width for all directions.
    Round(Textured),
    /// The widths along u and along v.
    Along([Textured; 2]),
}

by_kind!(AlphaKey {
    Number => Round(Fraction),
    Array => Along([Textured; 2]),
    String => Round(String),
    Object => Round(Box<format::Texture>),
});

/// The keys `roughness`, `anisotropy`, `alpha` and `distribution` of a material.
#[derive(Debug, Clone, Copy)]
pub struct RoughnessKeys<'m> {
    /// The roughness r, from 0 to 1.
    pub roughness: &'m Textured,
    /// The anisotropy, from 0 to 1.
    pub anisotropy: &'m Textured,
    /// The widths α, in place of roughness and anisotropy.
    pub alpha: Option<&'m AlphaKey>,
    /// The distribution of the facets' normals.
    pub distribution: Distribution,
}

/// The [`RoughnessKeys`] of a struct with these four fields.
macro_rules! roughness_keys {
    ($material:expr) => {
        RoughnessKeys {
            roughness: &$material.roughness,
            anisotropy: &$material.anisotropy,
            alpha: $material.alpha.as_ref(),
            distribution: $material.distribution,
        }
    };
}

pub(in crate::bsdf) use roughness_keys;

impl<'m> RoughnessKeys<'m> {
    /// The numbers and textures of the keys, by key.
    pub fn textures(self) -> impl Iterator<Item = (String, &'m Textured)> {
        let [first, second] = match self.alpha {
            None => [None, None],
            Some(AlphaKey::Round(width)) => [Some(("alpha", width)), None],
            Some(AlphaKey::Along([u, v])) => [Some(("alpha/0", u)), Some(("alpha/1", v))],
        };
        let all = [("roughness", self.roughness), ("anisotropy", self.anisotropy)].into_iter().chain(first).chain(second);
        all.map(|(key, texture)| (key.to_owned(), texture))
    }

    /// Builds the roughness; `None` for a surface that is smooth everywhere.
    pub fn prepare(self, builder: &mut dyn Prepare) -> Option<Roughness> {
        let widths = match self.alpha {
            None => return roughened(builder, ["roughness", "anisotropy"], [self.roughness, self.anisotropy], self.distribution),
            Some(AlphaKey::Round(width)) => [builder.texture("alpha", width), builder.texture("alpha", width)],
            Some(AlphaKey::Along([u, v])) => [builder.texture("alpha/0", u), builder.texture("alpha/1", v)],
        };
        let alpha = match widths {
            [Texture::Constant(x), Texture::Constant(y)] => Alpha::Constant(Vec2::new(x.average(), y.average())),
            widths => Alpha::Widths(widths),
        };
        rough(alpha, self.distribution)
    }
}

/// Builds the roughness of facets from a roughness r and an anisotropy; `None` for a surface that is smooth everywhere.
///
/// - `keys`: the keys of roughness and anisotropy
/// - `described`: the roughness and the anisotropy
pub fn roughened(builder: &mut dyn Prepare, keys: [&str; 2], described: [&Textured; 2], distribution: Distribution) -> Option<Roughness> {
    let [roughness, anisotropy] = [0, 1].map(|k| builder.texture(keys[k], described[k]));
    let alpha = match (roughness, anisotropy) {
        (Texture::Constant(roughness), Texture::Constant(anisotropy)) => Alpha::Constant(alpha(roughness.average(), anisotropy.average())),
        (Texture::Constant(smooth), _) if smooth == Rgb::BLACK => Alpha::Constant(Vec2::ZERO),
        (roughness, anisotropy) => Alpha::Textured { roughness, anisotropy },
    };
    rough(alpha, distribution)
}

/// The roughness of an alpha; `None` for a surface that is smooth everywhere.
fn rough(alpha: Alpha, distribution: Distribution) -> Option<Roughness> {
    let smooth = matches!(alpha, Alpha::Constant(alpha) if Microfacets::new(alpha, distribution).is_none());
    (!smooth).then_some(Roughness { alpha, distribution })
}
