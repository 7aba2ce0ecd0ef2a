//! Numbers that vary over a surface.

use glam::DVec3;

use super::Texture;
use crate::math::Rgb;
use crate::shape::SurfacePoint;

/// One number, or from + (to − from) · t by a texture t (of a colour, the mean).
///
/// Textures are shares of light, from 0 to 1; what has another range (an index of refraction, an exponent) says which.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    Constant(f32),
    Between(Box<Between>),
}

/// The ends of the range, and the way between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Between {
    from: f32,
    to: f32,
    by: Texture,
}

impl Number {
    /// A constant where `by` is one.
    pub fn between(from: f32, to: f32, by: Texture) -> Number {
        match by {
            Texture::Constant(share) => Number::Constant(mixed(from, to, share)),
            by => Number::Between(Box::new(Between { from, to, by })),
        }
    }

    pub fn at(&self, point: &SurfacePoint) -> f32 {
        match self {
            Number::Constant(value) => *value,
            Number::Between(between) => mixed(between.from, between.to, between.by.at(point)),
        }
    }

    pub fn constant(&self) -> Option<f32> {
        match self {
            Number::Constant(value) => Some(*value),
            Number::Between(_) => None,
        }
    }

    /// The least and the greatest that it may be.
    pub fn range(&self) -> [f32; 2] {
        match self {
            Number::Constant(value) => [*value; 2],
            Number::Between(between) => [between.from.min(between.to), between.from.max(between.to)],
        }
    }

    pub fn texture(&self) -> Option<&Texture> {
        match self {
            Number::Constant(_) => None,
            Number::Between(between) => Some(&between.by),
        }
    }

    /// The same number after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Number {
        match self {
            Number::Constant(_) => self,
            Number::Between(between) => {
                let Between { from, to, by } = *between;
                Number::Between(Box::new(Between { from, to, by: by.recentred(origin) }))
            }
        }
    }
}

/// Both ends exactly, and nothing beyond them.
fn mixed(from: f32, to: f32, share: Rgb) -> f32 {
    let t = share.average();
    (from * (1.0 - t) + to * t).clamp(from.min(to), from.max(to))
}

impl From<f32> for Number {
    fn from(value: f32) -> Number {
        Number::Constant(value)
    }
}
