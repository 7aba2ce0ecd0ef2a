//! Numbers that vary over a surface.
//!
//! A texture says shares from 0 to 1, and so what is a share itself (a roughness, an anisotropy) takes a texture as it is. What has
//! another range takes one from an end of its own to another: `{"from": 1.3, "to": 1.6, "by": "clouds"}`.

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
    Same(T),
    Between(Box<Between<T>>),
}

by_kind!(Varying<T> { Number => Same(T), Object => Between(Box<Between<T>>) });

/// A value for each of red, green and blue, or one for all, or `{"from": …, "to": …, "by": …}` where it varies over the surface.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum VaryingPerChannel<T> {
    Equal(T),
    Each([T; 3]),
    Between(Box<BetweenPerChannel<T>>),
}

by_kind!(VaryingPerChannel<T> { Number => Equal(T), Array => Each([T; 3]), Object => Between(Box<BetweenPerChannel<T>>) });

/// From one number to another by a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Varying{T}")]
pub struct Between<T> {
    /// The number where the texture is black.
    pub from: T,
    /// The number where it is white.
    pub to: T,
    /// The texture. (Of a colour, the mean.)
    pub by: Textured,
}

/// From one value for each of red, green and blue to another by a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Varying{T}PerChannel")]
pub struct BetweenPerChannel<T> {
    /// The values where the texture is black.
    pub from: PerChannel<T>,
    /// The values where it is white.
    pub to: PerChannel<T>,
    /// The texture: red, green and blue of a colour, each by itself.
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
