//! Colours that vary over a surface.
//!
//! To add one: a file beside these, a variant and its arms here, a variant in `describe::texture`.

pub mod checker;
pub mod image;
pub mod marble;
pub mod mix;
pub mod noise;
pub mod number;
pub mod space;
pub mod vertex;

use glam::DVec3;

use crate::math::Rgb;
use crate::shape::SurfacePoint;

pub use checker::Checker;
pub use image::Image;
pub use marble::Marble;
pub use mix::{Mix, Product, Threshold};
pub use noise::Noise;
pub use number::Number;
pub use space::Space;
pub use vertex::Vertex;

#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    Constant(Rgb),
    Checker(Box<Checker>),
    Image(Image),
    Noise(Box<Noise>),
    Marble(Box<Marble>),
    Mix(Box<Mix>),
    Product(Box<Product>),
    Threshold(Box<Threshold>),
    Vertex(Vertex),
}

impl Texture {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        match self {
            Texture::Constant(value) => *value,
            Texture::Checker(checker) => checker.at(point),
            Texture::Image(image) => image.at(point),
            Texture::Noise(noise) => noise.at(point),
            Texture::Marble(marble) => marble.at(point),
            Texture::Mix(mix) => mix.at(point),
            Texture::Product(product) => product.at(point),
            Texture::Threshold(threshold) => threshold.at(point),
            Texture::Vertex(vertex) => vertex.at(point),
        }
    }

    /// The mean over the coefficients, where a number is asked for.
    pub fn scalar(&self, point: &SurfacePoint) -> f32 {
        self.at(point).average()
    }

    /// The same texture after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Texture {
        match self {
            Texture::Constant(_) | Texture::Image(_) | Texture::Vertex(_) => self,
            Texture::Checker(checker) => Texture::Checker(Box::new(checker.recentred(origin))),
            Texture::Noise(noise) => Texture::Noise(Box::new(noise.recentred(origin))),
            Texture::Marble(marble) => Texture::Marble(Box::new(marble.recentred(origin))),
            Texture::Mix(mix) => Texture::Mix(Box::new(mix.recentred(origin))),
            Texture::Product(product) => Texture::Product(Box::new(product.recentred(origin))),
            Texture::Threshold(threshold) => Texture::Threshold(Box::new(threshold.recentred(origin))),
        }
    }

    /// From `a` to `b` by `share`, coefficient by coefficient; constant where `share` is.
    pub fn between(a: Rgb, b: Rgb, share: Texture) -> Texture {
        match share {
            Texture::Constant(share) => Texture::Constant(a * (Rgb::WHITE - share) + b * share),
            share => Texture::Mix(Box::new(Mix { a: a.into(), b: b.into(), share })),
        }
    }

    pub fn is_constant(&self) -> bool {
        matches!(self, Texture::Constant(_))
    }
}

impl From<Rgb> for Texture {
    fn from(value: Rgb) -> Texture {
        Texture::Constant(value)
    }
}

/// A number, the same everywhere.
impl From<f32> for Texture {
    fn from(value: f32) -> Texture {
        Texture::Constant(Rgb::gray(value))
    }
}
