//! Colours that vary over a surface.
//!
//! To add one: a file beside these, a variant and an arm here, a variant in `describe::texture`.

pub mod checker;

use glam::DVec3;

use crate::math::Spectrum;
use crate::shape::SurfacePoint;

pub use checker::{Checker, Space};

#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    Constant(Spectrum),
    Checker(Box<Checker>),
}

impl Texture {
    pub fn at(&self, point: &SurfacePoint) -> Spectrum {
        match self {
            Texture::Constant(value) => *value,
            Texture::Checker(checker) => checker.at(point),
        }
    }

    /// The same texture after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Texture {
        match self {
            Texture::Constant(_) => self,
            Texture::Checker(checker) => Texture::Checker(Box::new(checker.recentred(origin))),
        }
    }

    pub fn is_constant(&self) -> bool {
        matches!(self, Texture::Constant(_))
    }
}

impl From<Spectrum> for Texture {
    fn from(value: Spectrum) -> Texture {
        Texture::Constant(value)
    }
}
