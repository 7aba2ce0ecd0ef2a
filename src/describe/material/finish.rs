//! How rough a surface is: the keys that rough materials share.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::texture::Textured;
use super::super::value::Fraction;
use crate::reader::by_kind;

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

/// Those keys of a material.
#[derive(Debug, Clone, Copy)]
pub struct Finish<'m> {
    pub roughness: &'m Textured,
    pub anisotropy: Fraction,
    pub alpha: Option<Alpha>,
    pub distribution: Distribution,
}

/// Of a struct that has the keys.
macro_rules! finish_of {
    ($($name:ident),+) => { $(
        impl $name {
            pub(in crate::describe) fn finish(&self) -> Finish<'_> {
                Finish { roughness: &self.roughness, anisotropy: self.anisotropy, alpha: self.alpha, distribution: self.distribution }
            }
        }
    )+ };
}

pub(super) use finish_of;
