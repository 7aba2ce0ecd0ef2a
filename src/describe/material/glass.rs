//! What light goes through.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::finish::{Alpha, Distribution, Finish, finish_of};
use crate::format::{Color, Fraction, Index, Positive, Textured, Varying};

/// Glass, water, …: the surface of a body, normals outwards, that reflects and refracts, clear or frosted.
///
/// Light that gets into a body and out of it without passing its surface, through an open side of its mesh or behind a single sheet, is wrong
/// by the square of `eta`: `pt check` and every render name such shapes. A pane as one sheet is `thin_dielectric`; water in an opaque
/// basin is closed by that.
///
/// Of two faces in exactly one place (a glass box standing on a glass box) only the one listed first is met, and light
/// goes on as if the other body had no surface there: wrong. Describe glued bodies as one mesh without the faces between
/// them; two media that touch (water in a glass) by one face whose `eta` is the ratio of the two; bodies that only stand
/// on each other with a gap of a hundred-thousandth of the scene's size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Dielectric {
    /// Index of refraction inside (the side the normal points away from) divided by that outside.
    ///
    /// A body whose index varies over its surface has no index inside: light that goes in by one index and out by another is
    /// brighter or darker by the square of their ratio.
    pub eta: Varying<Index>,
    /// Light is multiplied by this every time it meets the surface: what is reflected there as well as what passes.
    pub color: Textured,
    /// 0 is clear, 1 frosted. The width of highlights, alpha, is its square, so that equal steps look equal. Below 0.001 a
    /// surface is as good as smooth. (Of a colour, the mean.)
    pub roughness: Textured,
    /// From round highlights to highlights ten times as long as wide, along the first texture coordinate. (Of a colour, the mean.)
    pub anisotropy: Textured,
    /// In place of `roughness` and `anisotropy`, the width itself; `[along u, along v]` for each of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Alpha>,
    /// How the facets of a rough surface lean.
    pub distribution: Distribution,
    /// Follow light that meets more than one facet. Without, frosted glass is too dark, from inside above all. It costs tables
    /// (70 ms once for each glass with GGX, five times that with Beckmann, fifteen to thirty times where the roughness is a texture
    /// or anisotropic, a hundred times where the anisotropy is a texture or both; all that for each table of a varying `eta`, which are
    /// 5 from 1.3 to 1.6, 15 from 1 to 1.6) and a fifth of the time of a scattering.
    pub multiscatter: bool,
    /// What the glass itself takes of the light on its way through. Exact for a closed body with nothing in it: the way from
    /// one meeting with this surface to the next counts, so that light on its way to something inside of the body is not dimmed,
    /// and an open surface dims whatever reaches it from behind. It takes no textures: it belongs to the body, not to a place on
    /// its surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption: Option<Absorption>,
}

finish_of!(Dielectric);

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
    pub eta: Varying<Index>,
    /// Light that passes or is reflected is multiplied by this once.
    pub color: Textured,
}

impl Default for Dielectric {
    fn default() -> Dielectric {
        Dielectric {
            eta: Varying::Same(Index::known(1.5)),
            color: Textured::white(),
            roughness: Textured::black(),
            anisotropy: Textured::black(),
            alpha: None,
            distribution: Distribution::Ggx,
            multiscatter: true,
            absorption: None,
        }
    }
}

impl Default for ThinDielectric {
    fn default() -> ThinDielectric {
        ThinDielectric { eta: Varying::Same(Index::known(1.5)), color: Textured::white() }
    }
}
