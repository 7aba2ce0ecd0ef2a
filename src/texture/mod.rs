//! Textures: colours and numbers that vary over a surface.
//!
//! To add a texture, write a file in this folder, a variant with its match arms here, and a description in `format/texture.rs`.

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

/// A colour that varies over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// One colour everywhere.
    Constant(Rgb),
    /// A checkerboard.
    Checker(Box<Checker>),
    /// A picture over the texture coordinates.
    Image(Image),
    /// Fractal noise between two colours.
    Noise(Box<Noise>),
    /// Layers disturbed by turbulence.
    Marble(Box<Marble>),
    /// A blend of two textures.
    Mix(Box<Mix>),
    /// The product of two textures.
    Product(Box<Product>),
    /// A texture reduced to 0 and 1.
    Threshold(Box<Threshold>),
    /// The interpolated colours of a mesh's vertices.
    Vertex(Vertex),
}

impl Texture {
    /// Looks up the colour at a point.
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

    /// Looks up a number at a point: the mean of red, green and blue.
    pub fn scalar(&self, point: &SurfacePoint) -> f32 {
        self.at(point).average()
    }

    /// The texture after the world has been moved by −`origin`.
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

    /// The blend (1 − share) a + share b of two colours, for each component by itself. A constant share gives a constant.
    pub fn between(a: Rgb, b: Rgb, share: Texture) -> Texture {
        match share {
            Texture::Constant(share) => Texture::Constant(a * (Rgb::WHITE - share) + b * share),
            share => Texture::Mix(Box::new(Mix { a: a.into(), b: b.into(), share })),
        }
    }

    /// Whether the texture is one colour everywhere.
    pub fn is_constant(&self) -> bool {
        matches!(self, Texture::Constant(_))
    }
}

impl From<Rgb> for Texture {
    fn from(value: Rgb) -> Texture {
        Texture::Constant(value)
    }
}

/// Makes a constant grey.
impl From<f32> for Texture {
    fn from(value: f32) -> Texture {
        Texture::Constant(Rgb::gray(value))
    }
}
