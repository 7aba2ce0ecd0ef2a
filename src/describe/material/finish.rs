//! How rough a surface is: the keys that rough materials share.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Fraction, Texture, Textured};
use crate::reader::by_kind;

/// The width of highlights, from 0 to 1: a number or a texture, or `[along u, along v]`, each a number or a texture.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Alpha {
    Round(Textured),
    Along([Textured; 2]),
}

by_kind!(Alpha {
    Number => Round(Fraction),
    Array => Along([Textured; 2]),
    String => Round(String),
    Object => Round(Box<Texture>),
});

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

/// Those keys of a material.
#[derive(Debug, Clone, Copy)]
pub struct Finish<'m> {
    pub roughness: &'m Textured,
    pub anisotropy: &'m Textured,
    pub alpha: Option<&'m Alpha>,
    pub distribution: Distribution,
}

impl<'m> Finish<'m> {
    /// With their keys.
    pub(super) fn textures(self) -> impl Iterator<Item = (&'static str, &'m Textured)> {
        let [first, second] = match self.alpha {
            None => [None, None],
            Some(Alpha::Round(width)) => [Some(("alpha", width)), None],
            Some(Alpha::Along([u, v])) => [Some(("alpha/0", u)), Some(("alpha/1", v))],
        };
        [("roughness", self.roughness), ("anisotropy", self.anisotropy)].into_iter().chain(first).chain(second)
    }
}

/// Of a struct that has the keys.
macro_rules! finish_of {
    ($($name:ident),+) => { $(
        impl $name {
            pub(in crate::describe) fn finish(&self) -> Finish<'_> {
                Finish { roughness: &self.roughness, anisotropy: &self.anisotropy, alpha: self.alpha.as_ref(), distribution: self.distribution }
            }
        }
    )+ };
}

pub(super) use finish_of;
