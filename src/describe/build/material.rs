//! Materials and the textures on them.

use glam::Vec3;

use super::{Builder, rgb, spectrum};
use crate::bsdf::Material;
use crate::describe::{self, CheckerOn, MaterialRef, Textured};
use crate::effects::Effects;
use crate::math::{Spectrum, Transform};
use crate::texture::{Checker, Space, Texture};
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
                let made = self.material_of(described);
                let effects = made.effects();
                let known = (self.world.material(made), effects);
                self.materials.insert(key, known);
                known
            }
        };
        (kind(described).to_owned(), (id, effects))
    }

    fn material_of(&mut self, described: &describe::Material) -> Material {
        use describe::Material as M;
        match described {
            M::Diffuse(m) => Material::Diffuse { albedo: self.textured(&m.albedo) },
            M::Mirror(m) => Material::Mirror { color: self.textured(&m.color) },
            M::Conductor(m) => Material::Conductor { eta: rgb(m.eta.each()), k: rgb(m.k.each()) },
            M::Dielectric(m) => Material::Dielectric { eta: m.eta.get() as f32, color: self.textured(&m.color) },
            M::MatteCone(m) => Material::MatteCone { color: self.textured(&m.color), mattness: m.mattness.get() as f32 },
            M::OrenNayar(m) => Material::OrenNayar { albedo: self.textured(&m.albedo), roughness: m.roughness.get() as f32 },
            M::Phong(m) => Material::Phong { color: self.textured(&m.color), exponent: m.exponent.get() as f32 },
            M::BlinnPhong(m) => Material::BlinnPhong { color: self.textured(&m.color), exponent: m.exponent.get() as f32 },
            M::Metal(m) => Material::Metal { color: self.textured(&m.color), roughness: m.roughness.get() as f32 },
            M::Plastic(m) => Material::plastic(self.textured(&m.albedo), m.eta.get() as f32),
            M::DiffuseTransmission(m) => {
                Material::DiffuseTransmission { reflectance: self.textured(&m.reflectance), transmittance: self.textured(&m.transmittance) }
            }
        }
    }

    fn textured(&mut self, described: &Textured) -> Texture {
        match described {
            Textured::Color(color) => Texture::Constant(spectrum(color)),
            Textured::Texture(inline) => self.texture(inline),
            Textured::Named(name) => match self.scene.textures.get(name) {
                Some(texture) => self.texture(texture),
                None => Spectrum::BLACK.into(),
            },
        }
    }

    fn texture(&mut self, described: &describe::Texture) -> Texture {
        self.textures += 1;
        if self.textures > MOST_TEXTURES {
            return Spectrum::BLACK.into();
        }
        match described {
            describe::Texture::Constant(t) => Texture::Constant(spectrum(&t.color)),
            describe::Texture::Checker(t) => {
                let space = match t.on {
                    CheckerOn::Uv => Space::Uv,
                    CheckerOn::Position => Space::World(Transform::IDENTITY),
                };
                let scale = Vec3::splat(t.scale.get() as f32);
                Texture::Checker(Box::new(Checker { even: self.textured(&t.even), odd: self.textured(&t.odd), scale, space }))
            }
        }
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
    }
}
