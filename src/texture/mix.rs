//! Textures made of other textures.

use glam::DVec3;

use super::{Texture, TextureContext};
use crate::math::Rgb;

/// The blend (1 − t) a + t b, for each of red, green and blue by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Mix {
    /// a, the first texture.
    pub a: Texture,
    /// b, the second texture.
    pub b: Texture,
    /// t, the share of the second texture: [0, 1].
    pub share: Texture,
}

/// The product a · b, for each of red, green and blue by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// The first factor.
    pub a: Texture,
    /// The second factor.
    pub b: Texture,
}

/// 1 where a ≥ t and 0 elsewhere, for each of red, green and blue by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Threshold {
    /// a, the texture that is compared.
    pub by: Texture,
    /// t, the threshold: [0, 1].
    pub at: f32,
}

impl Threshold {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        self.by.at(at).map(|a| if a >= self.at { 1.0 } else { 0.0 })
    }

    pub(super) fn recentred(self, origin: DVec3) -> Threshold {
        Threshold { by: self.by.recentred(origin), ..self }
    }
}

impl Mix {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        let share = self.share.at(at);
        self.a.at(at) * (Rgb::WHITE - share) + self.b.at(at) * share
    }

    pub(super) fn recentred(self, origin: DVec3) -> Mix {
        Mix { a: self.a.recentred(origin), b: self.b.recentred(origin), share: self.share.recentred(origin) }
    }
}

impl Product {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        self.a.at(at) * self.b.at(at)
    }

    pub(super) fn recentred(self, origin: DVec3) -> Product {
        Product { a: self.a.recentred(origin), b: self.b.recentred(origin) }
    }
}
