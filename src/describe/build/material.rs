//! Materials and the textures on them.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{Builder, rgb, spectrum};
use crate::bsdf::microfacet::finish::{self, Alpha, Finish};
use crate::bsdf::microfacet::{Distribution, Microfacets};
use crate::bsdf::{Element, Material};
use crate::describe::{self, Fraction, MaterialRef, Size, TextureSpace, Textured};
use crate::effects::Effects;
use crate::error::Error;
use crate::math::{Spectrum, Transform, float};
use crate::reader::escaped;
use crate::texture::image::{Filter, Pixels, Wrap};
use crate::texture::{Checker, Image, Marble, Mix, Noise, Product, Space, Texture};
use crate::world::MaterialId;

/// Textures within textures are copied where they are used: checkers of checkers of … grow as 2ⁿ.
pub(super) const MOST_TEXTURES: usize = 1 << 16;

impl Builder<'_> {
    /// The material's name in words, its id and what it calls for.
    pub(super) fn material(&mut self, pointer: &str, chosen: Option<&MaterialRef>) -> (String, (MaterialId, Effects)) {
        let default = describe::Material::default();
        let (key, described) = match chosen {
            None => (String::new(), &default),
            Some(MaterialRef::Inline(inline)) => (pointer.to_owned(), &**inline),
            Some(MaterialRef::Named(name)) => (format!("/materials/{name}"), self.scene.materials.get(name).unwrap_or(&default)),
        };
        let (id, effects) = match self.materials.get(&key) {
            Some(known) => *known,
            None => {
                self.note_smooth(&key, described);
                let made = self.material_of(&key, described);
                let effects = made.effects();
                let known = (self.world.material(made), effects);
                self.materials.insert(key, known);
                known
            }
        };
        (kind(described).to_owned(), (id, effects))
    }

    /// A roughness too small to be told from none.
    fn note_smooth(&mut self, pointer: &str, described: &describe::Material) {
        let (describe::Material::Conductor(describe::Conductor { roughness, .. })
        | describe::Material::Dielectric(describe::Dielectric { roughness, .. })) = described
        else {
            return;
        };
        let Textured::Color(color) = roughness else { return };
        let value = spectrum(color).average();
        if value > 0.0 && Microfacets::new(finish::alpha(value, 0.0), Distribution::Ggx).is_none() {
            self.warnings.push(format!("{}: {pointer}/roughness: {value} is as good as 0, the surface is smooth", self.source.file));
        }
    }

    fn material_of(&mut self, pointer: &str, described: &describe::Material) -> Material {
        use describe::Material as M;
        let mut textured = |key: &str, described: &Textured| self.textured(&format!("{pointer}/{key}"), described);
        match described {
            M::Diffuse(m) => Material::Diffuse { albedo: textured("albedo", &m.albedo) },
            M::Mirror(m) => Material::Mirror { color: textured("color", &m.color) },
            M::Conductor(m) => self.conductor(pointer, m),
            M::Dielectric(m) => self.dielectric(pointer, m),
            M::ThinDielectric(m) => Material::ThinDielectric { eta: m.eta.get() as f32, color: textured("color", &m.color) },
            M::MatteCone(m) => Material::MatteCone { color: textured("color", &m.color), mattness: m.mattness.get() as f32 },
            M::OrenNayar(m) => Material::OrenNayar { albedo: textured("albedo", &m.albedo), roughness: m.roughness.get() as f32 },
            M::Phong(m) => Material::Phong { color: textured("color", &m.color), exponent: m.exponent.get() as f32 },
            M::BlinnPhong(m) => Material::BlinnPhong { color: textured("color", &m.color), exponent: m.exponent.get() as f32 },
            M::Metal(m) => Material::Metal { color: textured("color", &m.color), roughness: m.roughness.get() as f32 },
            M::Plastic(m) => Material::plastic(textured("albedo", &m.albedo), m.eta.get() as f32),
            M::DiffuseTransmission(m) => Material::DiffuseTransmission {
                reflectance: textured("reflectance", &m.reflectance),
                transmittance: textured("transmittance", &m.transmittance),
            },
        }
    }

    fn conductor(&mut self, pointer: &str, m: &describe::Conductor) -> Material {
        let named = m.metal.map(|metal| metal_of(metal).index());
        let each = |values: Option<[f64; 3]>| values.map_or(Spectrum::BLACK, rgb);
        let (eta, k) = named.unwrap_or_else(|| (each(m.eta.map(|v| v.each())), each(m.k.map(|v| v.each()))));
        match self.finish(pointer, &m.roughness, m.anisotropy, m.alpha, m.distribution) {
            None => Material::Conductor { eta, k },
            Some(finish) => Material::rough_conductor(eta, k, finish, m.multiscatter),
        }
    }

    fn dielectric(&mut self, pointer: &str, m: &describe::Dielectric) -> Material {
        let (eta, color) = (m.eta.get() as f32, self.textured(&format!("{pointer}/color"), &m.color));
        let surface = match self.finish(pointer, &m.roughness, m.anisotropy, m.alpha, m.distribution) {
            None => Material::Dielectric { eta, color },
            Some(finish) => Material::rough_glass(eta, color, finish, m.multiscatter),
        };
        match &m.absorption {
            None => surface,
            Some(a) => {
                let left = spectrum(&a.color);
                let absorption = left.map(|left| -float::ln(left) / a.distance.get() as f32);
                Material::Filled { surface: Box::new(surface), absorption }
            }
        }
    }

    /// `None` for a surface that is smooth everywhere.
    fn finish(
        &mut self,
        pointer: &str,
        roughness: &Textured,
        anisotropy: Fraction,
        width: Option<describe::Alpha>,
        distribution: describe::Distribution,
    ) -> Option<Finish> {
        let anisotropy = anisotropy.get() as f32;
        let alpha = match (width, self.textured(&format!("{pointer}/roughness"), roughness)) {
            (Some(describe::Alpha::Round(width)), _) => Alpha::Constant(Vec2::splat(width.get() as f32)),
            (Some(describe::Alpha::Along(widths)), _) => Alpha::Constant(Vec2::from(widths.map(|width| width.get() as f32))),
            (None, Texture::Constant(roughness)) => Alpha::Constant(finish::alpha(roughness.average(), anisotropy)),
            (None, roughness) => Alpha::Textured { roughness, anisotropy },
        };
        let distribution = match distribution {
            describe::Distribution::Ggx => Distribution::Ggx,
            describe::Distribution::Beckmann => Distribution::Beckmann,
        };
        let smooth = matches!(alpha, Alpha::Constant(alpha) if Microfacets::new(alpha, distribution).is_none());
        (!smooth).then_some(Finish { alpha, distribution })
    }

    fn textured(&mut self, pointer: &str, described: &Textured) -> Texture {
        match described {
            Textured::Color(color) => Texture::Constant(spectrum(color)),
            Textured::Texture(inline) => self.texture(pointer, inline),
            Textured::Named(name) => match self.scene.textures.get(name) {
                Some(texture) => self.texture(&format!("/textures{}", escaped(name)), texture),
                None => Spectrum::BLACK.into(),
            },
        }
    }

    fn texture(&mut self, pointer: &str, described: &describe::Texture) -> Texture {
        use describe::Texture as T;
        self.textures += 1;
        if self.textures > MOST_TEXTURES {
            return Spectrum::BLACK.into();
        }
        if let T::Image(t) = described {
            return self.image(pointer, t);
        }
        let mut part = |key: &str, described: &Textured| self.textured(&format!("{pointer}/{key}"), described);
        match described {
            T::Constant(t) => Texture::Constant(spectrum(&t.color)),
            T::Checker(t) => Texture::Checker(Box::new(Checker {
                even: part("even", &t.even),
                odd: part("odd", &t.odd),
                scale: Vec3::splat(t.scale.get() as f32),
                space: space(t.on),
            })),
            T::Noise(t) => Texture::Noise(Box::new(Noise {
                low: part("low", &t.low),
                high: part("high", &t.high),
                scale: t.scale.get(),
                octaves: t.octaves.get(),
                space: space(t.on),
            })),
            T::Marble(t) => Texture::Marble(Box::new(Marble {
                base: part("base", &t.base),
                veins: part("veins", &t.veins),
                scale: t.scale.get(),
                space: space(t.on),
            })),
            T::Mix(t) => Texture::Mix(Box::new(Mix { a: part("a", &t.a), b: part("b", &t.b), share: part("share", &t.share) })),
            T::Product(t) => Texture::Product(Box::new(Product { a: part("a", &t.a), b: part("b", &t.b) })),
            T::Image(_) => Spectrum::BLACK.into(),
        }
    }

    /// Read once for every encoding that it is used in; black with a fault noted.
    fn image(&mut self, pointer: &str, described: &describe::Image) -> Texture {
        let key = (described.file.clone(), described.encoding);
        let pixels = match self.pictures.get(&key) {
            Some(known) => known.clone(),
            None => {
                let loaded = self.picture(pointer, described);
                self.pictures.insert(key, loaded.clone());
                loaded
            }
        };
        let Some(pixels) = pixels else { return Spectrum::BLACK.into() };
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
        Texture::Image(Image { pixels, scale, wrap, filter })
    }

    fn picture(&mut self, pointer: &str, described: &describe::Image) -> Option<Arc<Pixels>> {
        match describe::picture::load(&self.source.folder.join(&described.file), &described.file, described.encoding) {
            Ok((pixels, warnings)) => {
                self.warnings.extend(warnings);
                return Some(Arc::new(pixels));
            }
            Err(Error::Invalid(faults)) => {
                for fault in faults {
                    self.fault(&format!("{pointer}/file"), &format!("{}: {}", described.file, fault.message));
                }
            }
            Err(other) => self.failures.push(other),
        }
        None
    }
}

fn space(on: TextureSpace) -> Space {
    match on {
        TextureSpace::Uv => Space::Uv,
        TextureSpace::Position => Space::World(Transform::IDENTITY),
    }
}

fn kind(described: &describe::Material) -> &'static str {
    match described {
        describe::Material::Diffuse(_) => "diffuse",
        describe::Material::Mirror(_) => "mirror",
        describe::Material::Conductor(_) => "conductor",
        describe::Material::Dielectric(_) => "dielectric",
        describe::Material::MatteCone(_) => "matte_cone",
        describe::Material::OrenNayar(_) => "oren_nayar",
        describe::Material::Phong(_) => "phong",
        describe::Material::BlinnPhong(_) => "blinn_phong",
        describe::Material::Metal(_) => "metal",
        describe::Material::Plastic(_) => "plastic",
        describe::Material::DiffuseTransmission(_) => "diffuse_transmission",
        describe::Material::ThinDielectric(_) => "thin_dielectric",
    }
}

fn metal_of(described: describe::Element) -> Element {
    use describe::Element as M;
    match described {
        M::Ag => Element::Ag,
        M::Al => Element::Al,
        M::Au => Element::Au,
        M::Cr => Element::Cr,
        M::Cu => Element::Cu,
        M::Fe => Element::Fe,
        M::Ni => Element::Ni,
        M::Ti => Element::Ti,
        M::W => Element::W,
    }
}
