//! Numbers that may vary over a surface.

use glam::DVec3;

use super::{Texture, TextureContext};
use crate::math::Rgb;

/// A constant number, or from + (to − from) · t by a texture t. Colours count by their mean.
///
/// Textures have values from 0 to 1. A number with another range, such as an index of refraction or an exponent, gives its ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// One number everywhere.
    Constant(f32),
    /// A number that a texture interpolates between two ends.
    Between(Box<Between>),
}

/// The ends of the range, and the texture that interpolates between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Between {
    from: f32,
    to: f32,
    by: Texture,
}

impl Number {
    /// A number that `by` interpolates from `from` to `to`. It is a constant if `by` is.
    pub fn between(from: f32, to: f32, by: Texture) -> Number {
        match by {
            Texture::Constant(share) => Number::Constant(mixed(from, to, share)),
            by => Number::Between(Box::new(Between { from, to, by })),
        }
    }

    /// Looks up the number at a point.
    pub fn at(&self, at: &TextureContext) -> f32 {
        match self {
            Number::Constant(value) => *value,
            Number::Between(between) => mixed(between.from, between.to, between.by.at(at)),
        }
    }

    /// The number, if it is the same everywhere.
    pub fn constant(&self) -> Option<f32> {
        match self {
            Number::Constant(value) => Some(*value),
            Number::Between(_) => None,
        }
    }

    /// The least and the greatest possible value.
    pub fn range(&self) -> [f32; 2] {
        match self {
            Number::Constant(value) => [*value; 2],
            Number::Between(between) => [between.from.min(between.to), between.from.max(between.to)],
        }
    }

    /// The texture, if the number varies.
    pub fn texture(&self) -> Option<&Texture> {
        match self {
            Number::Constant(_) => None,
            Number::Between(between) => Some(&between.by),
        }
    }

    /// The number after the world has been moved by −`origin`.
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

/// Interpolates linearly. The result is exact at both ends and never beyond them.
fn mixed(from: f32, to: f32, share: Rgb) -> f32 {
    let t = share.average();
    (from * (1.0 - t) + to * t).clamp(from.min(to), from.max(to))
}

impl From<f32> for Number {
    fn from(value: f32) -> Number {
        Number::Constant(value)
    }
}
