//! Textures: colours and numbers that vary over a surface.
//!
//! To add a texture, write a file in this folder, a variant with its match arms here, and a description in `format/texture.rs`.

pub mod checker;
mod footprint;
pub mod image;
pub mod marble;
pub mod mix;
pub mod noise;
pub mod number;
pub mod pixels;
pub mod pyramid;
pub mod space;
pub mod vertex;

use glam::DVec3;

use crate::effects::Effects;
use crate::math::Rgb;

pub use checker::Checker;
pub use footprint::{Footprint, TextureContext};
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
    /// Looks up the colour at a point, averaged over the footprint if there is one.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        match self {
            Texture::Constant(value) => *value,
            Texture::Checker(checker) => checker.at(at),
            Texture::Image(image) => image.at(at),
            Texture::Noise(noise) => noise.at(at),
            Texture::Marble(marble) => marble.at(at),
            Texture::Mix(mix) => mix.at(at),
            Texture::Product(product) => product.at(at),
            Texture::Threshold(threshold) => threshold.at(at),
            Texture::Vertex(vertex) => vertex.at(at),
        }
    }

    /// Looks up a number at a point: the mean of red, green and blue.
    pub fn scalar(&self, at: &TextureContext) -> f32 {
        self.at(at).average()
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

    /// Whether lookups depend on the footprint.
    pub fn is_filtered(&self) -> bool {
        match self {
            Texture::Constant(_) | Texture::Vertex(_) | Texture::Threshold(_) => false,
            Texture::Checker(_) | Texture::Noise(_) => true,
            Texture::Image(image) => image.pyramid.is_some(),
            Texture::Marble(marble) => marble.base.is_filtered() || marble.veins.is_filtered(),
            Texture::Mix(mix) => [&mix.a, &mix.b, &mix.share].into_iter().any(Texture::is_filtered),
            Texture::Product(product) => product.a.is_filtered() || product.b.is_filtered(),
        }
    }

    /// Whether the texture varies over texture coordinates.
    pub fn needs_uv(&self) -> bool {
        let on_uv = |space: &Space| *space == Space::Uv;
        match self {
            Texture::Constant(_) | Texture::Vertex(_) => false,
            Texture::Image(_) => true,
            Texture::Checker(t) => on_uv(&t.space) || t.even.needs_uv() || t.odd.needs_uv(),
            Texture::Noise(t) => on_uv(&t.space) || t.low.needs_uv() || t.high.needs_uv(),
            Texture::Marble(t) => on_uv(&t.space) || t.base.needs_uv() || t.veins.needs_uv(),
            Texture::Mix(t) => [&t.a, &t.b, &t.share].into_iter().any(Texture::needs_uv),
            Texture::Product(t) => t.a.needs_uv() || t.b.needs_uv(),
            Texture::Threshold(t) => t.by.needs_uv(),
        }
    }

    /// The effects that lookups of the texture are.
    pub fn effects(&self) -> Effects {
        match (self.is_constant(), self.is_filtered()) {
            (true, _) => Effects::NONE,
            (false, false) => Effects::TEXTURES,
            (false, true) => Effects::TEXTURES | Effects::FOOTPRINTS,
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
