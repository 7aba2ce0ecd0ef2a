//! What stands around a material: the fine shape of the surface, and its holes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MaterialRef;
use crate::format::{Real, Textured, Varying};

/// A relief too fine for triangles: it turns normals, and moves no points. A normal that points below the surface, or away from the
/// viewer, is bent back until its cosine to the surface's own normal, then to the viewer, is 1/64: what is seen of it along the
/// surface is lit a little differently than the map says. Where texture coordinates span no area there is no relief. Not within
/// other materials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bumped {
    /// What is bumped.
    pub surface: MaterialRef,
    /// A picture of normals: red, green and blue from 0 to 1 are −1 to 1 along u, along v (up), and out. Read as linear unless
    /// its `encoding` says otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_map: Option<Textured>,
    /// In its place, heights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bump_map: Option<Textured>,
    /// The height of white above black (m); with `normal_map`, the strength of the relief.
    #[serde(default = "one")]
    pub scale: Varying<Real>,
}

/// A surface with holes: leaves, lace, a fence on one quad. Light of all kinds goes through them, shadow rays too; through 4096
/// on one line, then it is stopped. Not within other materials, and not on what emits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Masked {
    /// What has holes.
    pub surface: MaterialRef,
    /// The share of rays that meet the surface: 0 is a hole. (Of a colour, the mean.)
    pub opacity: Textured,
}

fn one() -> Varying<Real> {
    Varying::Same(Real::known(1.0))
}
