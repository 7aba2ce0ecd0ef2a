//! Materials and the textures on them.

use glam::{Vec2, Vec3};

use super::{Builder, rgb, spectrum};
use crate::bsdf::microfacet::finish::{self, Alpha, Finish};
use crate::bsdf::microfacet::{Distribution, Microfacets};
use crate::bsdf::{Material, Element};
use crate::describe::{self, CheckerOn, Fraction, MaterialRef, Textured};
use crate::effects::Effects;
use crate::math::{Spectrum, Transform, float};
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
            M::Conductor(m) => self.conductor(m),
            M::Dielectric(m) => self.dielectric(m),
            M::ThinDielectric(m) => Material::ThinDielectric { eta: m.eta.get() as f32, color: self.textured(&m.color) },
            M::MatteCone(m) => Material::MatteCone { color: self.textured(&m.color), mattness: m.mattness.get() as f32 },
        }
    }

    fn conductor(&mut self, m: &describe::Conductor) -> Material {
        let named = m.metal.map(|metal| metal_of(metal).index());
        let each = |values: Option<[f64; 3]>| values.map_or(Spectrum::BLACK, rgb);
        let (eta, k) = named.unwrap_or_else(|| (each(m.eta.map(|v| v.each())), each(m.k.map(|v| v.each()))));
        match self.finish(&m.roughness, m.anisotropy, m.alpha, m.distribution) {
            None => Material::Conductor { eta, k },
            Some(finish) => Material::rough_conductor(eta, k, finish, m.multiscatter),
        }
    }

    fn dielectric(&mut self, m: &describe::Dielectric) -> Material {
        let (eta, color) = (m.eta.get() as f32, self.textured(&m.color));
        let surface = match self.finish(&m.roughness, m.anisotropy, m.alpha, m.distribution) {
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
        roughness: &Textured,
        anisotropy: Fraction,
        width: Option<describe::Alpha>,
        distribution: describe::Distribution,
    ) -> Option<Finish> {
        let anisotropy = anisotropy.get() as f32;
        let alpha = match (width, self.textured(roughness)) {
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
