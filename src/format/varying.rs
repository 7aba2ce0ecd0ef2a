//! Numbers that may vary over a surface.
//!
//! A texture has values from 0 to 1. A parameter with that range (a roughness, an anisotropy) takes the texture directly. A parameter
//! with another range gives the values at black and at white: `{"from": 1.3, "to": 1.6, "by": "clouds"}`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::PerChannel;
use super::texture::Textured;
use crate::reader::by_kind;

/// A number, or `{"from": …, "to": …, "by": …}` where it varies over the surface.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Varying<T> {
    /// One value everywhere.
    Same(T),
    /// A value interpolated by a texture.
    Between(Box<Between<T>>),
}

by_kind!(Varying<T> { Number => Same(T), Object => Between(Box<Between<T>>) });

/// A value for each of red, green and blue, or one for all, or `{"from": …, "to": …, "by": …}` where it varies over the surface.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum VaryingPerChannel<T> {
    /// One value everywhere, for red, green and blue.
    Equal(T),
    /// The values for red, green and blue, everywhere.
    Each([T; 3]),
    /// Values interpolated by a texture.
    Between(Box<BetweenPerChannel<T>>),
}

by_kind!(VaryingPerChannel<T> { Number => Equal(T), Array => Each([T; 3]), Object => Between(Box<BetweenPerChannel<T>>) });

/// A number that a texture interpolates between two values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Varying{T}")]
pub struct Between<T> {
    /// The number where the texture is black.
    pub from: T,
    /// The number where the texture is white.
    pub to: T,
    /// The texture. Where it has a colour, the mean of red, green and blue counts.
    pub by: Textured,
}

/// Values for red, green and blue that a texture interpolates between two ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Varying{T}PerChannel")]
pub struct BetweenPerChannel<T> {
    /// The values where the texture is black.
    pub from: PerChannel<T>,
    /// The values where the texture is white.
    pub to: PerChannel<T>,
    /// The texture. Its red, green and blue interpolate the values for red, green and blue.
    pub by: Textured,
}

impl<T> Varying<T> {
    pub(crate) fn by(&self) -> Option<&Textured> {
        match self {
            Varying::Same(_) => None,
            Varying::Between(between) => Some(&between.by),
        }
    }
}

impl<T> VaryingPerChannel<T> {
    pub(crate) fn by(&self) -> Option<&Textured> {
        match self {
            VaryingPerChannel::Equal(_) | VaryingPerChannel::Each(_) => None,
            VaryingPerChannel::Between(between) => Some(&between.by),
        }
    }
}
