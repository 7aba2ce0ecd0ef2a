//! Textures made of textures.

use glam::DVec3;

use super::Texture;
use crate::math::Rgb;
use crate::shape::SurfacePoint;

/// (1 − t) a + t b, coefficient by coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Mix {
    pub a: Texture,
    pub b: Texture,
    /// t: [0, 1].
    pub share: Texture,
}

/// a · b, coefficient by coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    pub a: Texture,
    pub b: Texture,
}

/// 1 where a ≥ t, 0 elsewhere, coefficient by coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Threshold {
    pub by: Texture,
    /// t: [0, 1].
    pub at: f32,
}

impl Threshold {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        self.by.at(point).map(|a| if a >= self.at { 1.0 } else { 0.0 })
    }

    pub(super) fn recentred(self, origin: DVec3) -> Threshold {
        Threshold { by: self.by.recentred(origin), ..self }
    }
}

impl Mix {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        let share = self.share.at(point);
        self.a.at(point) * (Rgb::WHITE - share) + self.b.at(point) * share
    }

    pub(super) fn recentred(self, origin: DVec3) -> Mix {
        Mix { a: self.a.recentred(origin), b: self.b.recentred(origin), share: self.share.recentred(origin) }
    }
}

impl Product {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        self.a.at(point) * self.b.at(point)
    }

    pub(super) fn recentred(self, origin: DVec3) -> Product {
        Product { a: self.a.recentred(origin), b: self.b.recentred(origin) }
    }
}
