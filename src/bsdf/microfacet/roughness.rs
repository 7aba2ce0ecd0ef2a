//! How rough a surface is, from point to point.

use glam::{DVec3, Vec2};

use super::energy_loss::Domain;
use super::{Distribution, Microfacets};
use crate::effects::Effects;
use crate::math::Rgb;
use crate::shape::SurfacePoint;
use crate::texture::Texture;

/// A distribution of facets and its roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Roughness {
    pub alpha: Alpha,
    pub distribution: Distribution,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Alpha {
    /// Along the two axes of the surface.
    Constant(Vec2),
    /// Roughness r and anisotropy from 0 to 1 (of a colour, its mean), see [`alpha`].
    Textured { roughness: Texture, anisotropy: Texture },
    /// Along the two axes, each from 0 to 1 (of a colour, its mean).
    Widths([Texture; 2]),
}

/// αx = r² / a, αy = r² a,    a = √(1 − 0.9 · anisotropy)
///
/// - `roughness`: r, from 0 to 1
/// - `anisotropy`: from 0 to 1; the highlight of 1 is ten times as long (along x) as it is wide
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
    /// `None` where the surface is as good as smooth.
    pub fn at(&self, point: &SurfacePoint) -> Option<Microfacets> {
        let alpha = match &self.alpha {
            Alpha::Constant(alpha) => *alpha,
            Alpha::Textured { roughness, anisotropy } => alpha(roughness.scalar(point), anisotropy.scalar(point)),
            Alpha::Widths(widths) => Vec2::from(widths.each_ref().map(|width| width.scalar(point))),
        };
        Microfacets::new(alpha, self.distribution)
    }

    /// What tables of its albedo must cover. By roughness and anisotropy r² is the geometric mean of the widths, and 1 − 0.9 a their
    /// ratio.
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

    /// Whether it matters where x and y point.
    pub fn is_anisotropic(&self) -> bool {
        match &self.alpha {
            Alpha::Constant(alpha) => alpha.x != alpha.y,
            Alpha::Textured { anisotropy, .. } => *anisotropy != Texture::Constant(Rgb::BLACK),
            Alpha::Widths([x, y]) => x != y,
        }
    }

    /// A rough surface scatters all around; a textured one may be smooth in places.
    pub fn effects(&self, smooth: Effects) -> Effects {
        match &self.alpha {
            Alpha::Constant(_) | Alpha::Textured { roughness: Texture::Constant(_), .. } => Effects::INTERREFLECTION,
            Alpha::Textured { .. } | Alpha::Widths(_) => Effects::INTERREFLECTION | smooth,
        }
    }

    pub fn textures(&self) -> impl Iterator<Item = &Texture> {
        let [first, second] = match &self.alpha {
            Alpha::Constant(_) => [None, None],
            Alpha::Textured { roughness, anisotropy } => [Some(roughness), Some(anisotropy)],
            Alpha::Widths([x, y]) => [Some(x), Some(y)],
        };
        first.into_iter().chain(second)
    }

    /// The same finish after the world has moved by −`origin`.
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
