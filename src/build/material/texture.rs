//! Builds textures: resolves names and reads pictures.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::build::transform::placed;
use crate::build::{Builder, rgb};
use crate::describe::{self, Channel, Encoding, Size, TextureSpace, Textured, identity, picture};
use crate::error::Error;
use crate::math::{Rgb, Transform};
use crate::reader::escaped;
use crate::texture::image::{Filter, Pixels, Wrap};
use crate::texture::noise::Turbulence;
use crate::texture::pyramid::Pyramid;
use crate::texture::{Checker, Image, Marble, Mix, Noise, Product, Space, Texture, Threshold, Vertex};

/// The largest number of textures within textures. Each use is a copy, so that nested checkerboards grow as 2ⁿ.
pub(in crate::build) const MOST_TEXTURES: usize = 1 << 16;

/// What a texture is used for. It says which values its pictures may have, and whether lookups average over what a pixel shows.
#[derive(Clone, Copy, PartialEq)]
pub(in crate::build) enum Use {
    /// A reflectance, a transmittance or a number: values from 0 to 1, averaged.
    Scattering,
    /// A normal, a height or an opacity: values from 0 to 1, looked up at points.
    Points,
    /// Emission: finite values from 0, looked up at points as samples of lights do.
    Emission,
}

impl Builder<'_> {
    /// Builds the texture of a reflectance, or of a number from 0 to 1.
    pub(in crate::build) fn textured(&mut self, pointer: &str, described: &Textured) -> Texture {
        self.texture_for(pointer, described, Use::Scattering)
    }

    /// Builds a texture for a use.
    pub(in crate::build) fn texture_for(&mut self, pointer: &str, described: &Textured, purpose: Use) -> Texture {
        match described {
            Textured::Color(color) => Texture::Constant(rgb(color)),
            Textured::Texture(inline) => self.texture(pointer, inline, purpose),
            Textured::Named(name) => match self.scene.textures.get(name) {
                Some(texture) => self.texture(&format!("/textures{}", escaped(name)), texture, purpose),
                None => Rgb::BLACK.into(),
            },
        }
    }

    /// Builds the texture of a normal map. Its picture is linear unless its `encoding` says otherwise.
    pub(super) fn normal_map(&mut self, pointer: &str, described: &Textured) -> Texture {
        let picture = match described {
            Textured::Texture(inline) => Some(&**inline),
            Textured::Named(name) => self.scene.textures.get(name),
            Textured::Color(_) => None,
        };
        match picture {
            Some(describe::Texture::Image(picture)) if picture.encoding == Encoding::Auto => {
                let linear = describe::Image { encoding: Encoding::Linear, ..picture.clone() };
                self.image(pointer, &linear, Use::Points)
            }
            _ => self.texture_for(pointer, described, Use::Points),
        }
    }

    fn texture(&mut self, pointer: &str, described: &describe::Texture, purpose: Use) -> Texture {
        use describe::Texture as T;
        self.textures += 1;
        if self.textures > MOST_TEXTURES {
            return Rgb::BLACK.into();
        }
        if let T::Image(t) = described {
            return self.image(pointer, t, purpose);
        }
        let space = self.space(pointer, described);
        let mut part = |key: &str, described: &Textured| {
            let purpose = if key == "share" && purpose == Use::Emission { Use::Points } else { purpose };
            self.texture_for(&format!("{pointer}/{key}"), described, purpose)
        };
        match described {
            T::Constant(t) => Texture::Constant(rgb(&t.color)),
            T::Checker(t) => Texture::Checker(Box::new(Checker {
                even: part("even", &t.even),
                odd: part("odd", &t.odd),
                scale: Vec3::splat(t.scale.get() as f32),
                space,
            })),
            T::Noise(t) => Texture::Noise(Box::new(Noise {
                low: part("low", &t.low),
                high: part("high", &t.high),
                scale: t.scale.get(),
                octaves: t.octaves.get(),
                space,
            })),
            T::Marble(t) => Texture::Marble(Box::new(Marble {
                base: part("base", &t.base),
                veins: part("veins", &t.veins),
                scale: t.scale.get(),
                turbulence: match t.turbulence {
                    describe::Turbulence::SumOfAbsolutes => Turbulence::SumOfAbsolutes,
                    describe::Turbulence::AbsoluteOfSum => Turbulence::AbsoluteOfSum,
                },
                space,
            })),
            T::Mix(t) => Texture::Mix(Box::new(Mix { a: part("a", &t.a), b: part("b", &t.b), share: part("share", &t.share) })),
            T::Product(t) => Texture::Product(Box::new(Product { a: part("a", &t.a), b: part("b", &t.b) })),
            T::Threshold(t) => Texture::Threshold(Box::new(Threshold { by: part("by", &t.by), at: t.at.get() as f32 })),
            T::VertexColor(t) => Texture::Vertex(Vertex { channel: t.channel.map(|channel| channel as usize) }),
            T::Image(_) => Rgb::BLACK.into(),
        }
    }

    /// Builds an image texture. Returns black after adding a fault.
    fn image(&mut self, pointer: &str, described: &describe::Image, purpose: Use) -> Texture {
        let pixels = self.picture(&format!("{pointer}/file"), &described.file, described.encoding, described.channel);
        let Some(pixels) = pixels else { return Rgb::BLACK.into() };
        if purpose != Use::Emission
            && let Some(message) = picture::beyond_shares(&pixels)
        {
            self.fault(&format!("{pointer}/file"), &format!("{}: {message}; only what is emitted may be more", described.file));
        }
        let wrap = match described.wrap {
            describe::Wrap::Repeat => Wrap::Repeat,
            describe::Wrap::Mirror => Wrap::Mirror,
            describe::Wrap::Clamp => Wrap::Clamp,
        };
        let filter = match described.filter {
            describe::TextureFilter::Bilinear => Filter::Bilinear,
            describe::TextureFilter::Nearest => Filter::Nearest,
        };
        let scale = match described.scale {
            Size::Square(both) => Vec2::splat(both.get() as f32),
            Size::Sides(sides) => Vec2::from(sides.map(|side| side.get() as f32)),
        };
        let averages = self.scene.film.has_footprints() && purpose == Use::Scattering;
        let pyramid = averages.then(|| {
            let key = (described.file.clone(), described.encoding, described.channel);
            self.pyramids.entry(key).or_insert_with(|| Arc::new(Pyramid::new(&pixels))).clone()
        });
        Texture::Image(Image { pixels, pyramid, scale, wrap, filter })
    }

    /// Reads a picture, once for each encoding and channel. Returns nothing after adding a fault.
    ///
    /// - `pointer`: JSON pointer of the file's name
    pub(in crate::build) fn picture(
        &mut self,
        pointer: &str,
        file: &str,
        encoding: Encoding,
        channel: Option<Channel>,
    ) -> Option<Arc<Pixels>> {
        let key = (file.to_owned(), encoding, channel);
        if let Some(known) = self.pictures.get(&key) {
            return known.clone();
        }
        let loaded = self.read_picture(pointer, file, encoding, channel);
        self.pictures.insert(key, loaded.clone());
        loaded
    }

    fn read_picture(&mut self, pointer: &str, file: &str, encoding: Encoding, channel: Option<Channel>) -> Option<Arc<Pixels>> {
        match self.source.files.picture(file, encoding, channel) {
            Ok((pixels, warnings)) => {
                self.warnings.extend(warnings);
                let name = channel.map_or_else(|| file.to_owned(), |channel| format!("{file}, {channel:?}"));
                self.contents.insert(name, identity::of_picture(&pixels));
                return Some(Arc::new(pixels));
            }
            Err(Error::Invalid(faults)) => {
                for fault in faults {
                    self.fault(pointer, &format!("{file}: {}", fault.message));
                }
            }
            Err(other) => self.failures.push(other),
        }
        None
    }

    /// The coordinates that a texture varies over. Adds a fault where its transform has no inverse.
    fn space(&mut self, pointer: &str, described: &describe::Texture) -> Space {
        match described.space() {
            Some((TextureSpace::Position, steps)) => match placed(steps, &Transform::IDENTITY) {
                Ok(to_world) => Space::World(to_world.inverse()),
                Err(message) => {
                    self.fault(&format!("{pointer}/transform"), &message);
                    Space::Uv
                }
            },
            _ => Space::Uv,
        }
    }
}
