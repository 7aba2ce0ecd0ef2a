//! Roughness that may vary over a surface.

use glam::{DVec3, Vec2};

use super::energy_loss::Domain;
use super::{Distribution, Microfacets};
use crate::effects::Effects;
use crate::math::Rgb;
use crate::texture::{Texture, TextureContext};

/// The roughness of a surface and the distribution of its facets' normals.
#[derive(Clone, Debug, PartialEq)]
pub struct Roughness {
    /// The widths α along the tangents.
    pub alpha: Alpha,
    /// The distribution of the facets' normals.
    pub distribution: Distribution,
}

/// The widths α of highlights along the surface's tangents.
#[derive(Clone, Debug, PartialEq)]
pub enum Alpha {
    /// Constant widths along the two tangents.
    Constant(Vec2),
    /// Widths from textures of roughness and anisotropy by [`alpha`]. Colours count by their mean.
    Textured {
        /// The roughness r, from 0 to 1.
        roughness: Texture,
        /// The anisotropy, from 0 to 1.
        anisotropy: Texture,
    },
    /// Textures of the widths along the two tangents, from 0 to 1. Colours count by their mean.
    Widths([Texture; 2]),
}

/// The widths α of a roughness and an anisotropy.
///
/// αx = r² / a, αy = r² a,    a = √(1 − 0.9 · anisotropy)
///
/// - `roughness`: r, from 0 to 1
/// - `anisotropy`: from 0 to 1; at 1 a highlight is ten times as long (along x) as wide
///
/// Source: Burley, *Physically Based Shading at Disney* (2012).
pub fn alpha(roughness: f32, anisotropy: f32) -> Vec2 {
    let (square, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropy).sqrt());
    Vec2::new(square / aspect, square * aspect)
}

fn constant(texture: &Texture) -> Option<f32> {
    match texture {
        Texture::Constant(value) => Some(value.average()),
        _ => None,
    }
}

impl Roughness {
    /// The facets at a point; `None` where the surface counts as smooth.
    pub fn at(&self, at: &TextureContext) -> Option<Microfacets> {
        let alpha = match &self.alpha {
            Alpha::Constant(alpha) => *alpha,
            Alpha::Textured { roughness, anisotropy } => alpha(roughness.scalar(at), anisotropy.scalar(at)),
            Alpha::Widths(widths) => Vec2::from(widths.each_ref().map(|width| width.scalar(at))),
        };
        Microfacets::new(alpha, self.distribution)
    }

    /// The range of roughness that tables of its albedo must cover. For roughness r and anisotropy a the geometric mean of the widths is r²
    /// and their ratio is 1 − 0.9 a.
    pub fn domain(&self) -> Domain {
        match &self.alpha {
            Alpha::Constant(alpha) => Domain::One(*alpha),
            Alpha::Textured { anisotropy: Texture::Constant(none), .. } if none.is_black() => Domain::Round,
            Alpha::Textured { roughness, anisotropy } => Domain::Long {
                mean: constant(roughness).map_or([0.0, 1.0], |roughness| [roughness; 2]),
                ratio: constant(anisotropy).map_or([0.1, 1.0], |anisotropy| [1.0 - 0.9 * anisotropy; 2]),
            },
            Alpha::Widths(_) => Domain::Long { mean: [0.0, 1.0], ratio: [0.1, 1.0] },
        }
    }

    /// Whether scattering depends on the directions of the surface's tangents.
    pub fn is_anisotropic(&self) -> bool {
        match &self.alpha {
            Alpha::Constant(alpha) => alpha.x != alpha.y,
            Alpha::Textured { anisotropy, .. } => *anisotropy != Texture::Constant(Rgb::BLACK),
            Alpha::Widths([x, y]) => x != y,
        }
    }

    /// The effects of a rough surface: lobes, and the single directions of a smooth one where a texture may be 0.
    ///
    /// - `smooth`: the effects of the smooth surface
    pub fn effects(&self, smooth: Effects) -> Effects {
        match &self.alpha {
            Alpha::Constant(_) | Alpha::Textured { roughness: Texture::Constant(_), .. } => smooth.roughened(),
            Alpha::Textured { .. } | Alpha::Widths(_) => smooth.roughened() | smooth,
        }
    }

    /// The textures of the roughness; none if it is constant.
    pub fn textures(&self) -> impl Iterator<Item = &Texture> {
        let [first, second] = match &self.alpha {
            Alpha::Constant(_) => [None, None],
            Alpha::Textured { roughness, anisotropy } => [Some(roughness), Some(anisotropy)],
            Alpha::Widths([x, y]) => [Some(x), Some(y)],
        };
        first.into_iter().chain(second)
    }

    /// The roughness after the world has been moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Roughness {
        let alpha = match self.alpha {
            Alpha::Constant(_) => self.alpha,
            Alpha::Textured { roughness, anisotropy } => {
                Alpha::Textured { roughness: roughness.recentred(origin), anisotropy: anisotropy.recentred(origin) }
            }
            Alpha::Widths(widths) => Alpha::Widths(widths.map(|width| width.recentred(origin))),
        };
        Roughness { alpha, ..self }
    }
}
