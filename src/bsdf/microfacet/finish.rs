//! How rough a surface is, from point to point.

use glam::{DVec3, Vec2};

use super::albedo::Domain;
use super::{Distribution, Microfacets};
use crate::effects::Effects;
use crate::shape::SurfacePoint;
use crate::texture::Texture;

/// A distribution of facets and its roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Finish {
    pub alpha: Alpha,
    pub distribution: Distribution,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Alpha {
    /// Along the two axes of the surface.
    Constant(Vec2),
    /// Roughness r from 0 to 1 (of a colour, its mean), see [`alpha`].
    Textured { roughness: Texture, anisotropy: f32 },
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

impl Finish {
    /// `None` where the surface is as good as smooth.
    pub fn at(&self, point: &SurfacePoint) -> Option<Microfacets> {
        let alpha = match &self.alpha {
            Alpha::Constant(alpha) => *alpha,
            Alpha::Textured { roughness, anisotropy } => alpha(roughness.at(point).average(), *anisotropy),
        };
        Microfacets::new(alpha, self.distribution)
    }

    /// What tables of its albedo must cover.
    pub fn domain(&self) -> Domain {
        match &self.alpha {
            Alpha::Constant(alpha) => Domain::One(*alpha),
            Alpha::Textured { .. } => Domain::All,
        }
    }

    /// Whether it matters where x and y point.
    pub fn is_anisotropic(&self) -> bool {
        match &self.alpha {
            Alpha::Constant(alpha) => alpha.x != alpha.y,
            Alpha::Textured { anisotropy, .. } => *anisotropy != 0.0,
        }
    }

    /// A rough surface scatters all around; a textured one may be smooth in places.
    pub fn effects(&self, smooth: Effects) -> Effects {
        if self.texture().is_some() { Effects::INTERREFLECTION | smooth } else { Effects::INTERREFLECTION }
    }

    pub fn texture(&self) -> Option<&Texture> {
        match &self.alpha {
            Alpha::Constant(_) => None,
            Alpha::Textured { roughness, .. } => Some(roughness),
        }
    }

    /// The same finish after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Finish {
        let alpha = match self.alpha {
            Alpha::Constant(_) => self.alpha,
            Alpha::Textured { roughness, anisotropy } => Alpha::Textured { roughness: roughness.recentred(origin), anisotropy },
        };
        Finish { alpha, ..self }
    }
}
