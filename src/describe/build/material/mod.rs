//! Materials, and what they are made of.

mod finish;
mod texture;

use super::{Builder, spectrum};
use crate::bsdf::{Coat, Coated, Compound, Element, MAX_DELTA_LOBES, Material, Mix, Principled, Relief, Share, Sheen, Sides, Skin};
use crate::describe::{self, Distribution, MaterialRef, Textured};
use crate::effects::Effects;
use crate::math::{Spectrum, float};
use crate::reader::escaped;
use crate::texture::{Product, Texture};
use crate::world::MaterialId;

pub(super) use texture::{MOST_TEXTURES, Range};

/// Materials within materials are copied where they are used: mixes of mixes of … grow as 2ⁿ.
pub(super) const MOST_PARTS: usize = 1 << 12;

impl Builder<'_> {
    /// The material's name in words, its id and what it calls for.
    pub(super) fn material(&mut self, pointer: &str, chosen: Option<&MaterialRef>) -> (String, (MaterialId, Effects)) {
        let default = describe::Material::default();
        let (key, described) = chosen.map_or((String::new(), None), |chosen| find(self.scene, pointer, chosen));
        let described = described.unwrap_or(&default);
        let (id, effects) = match self.materials.get(&key) {
            Some(known) => *known,
            None => {
                let skin = self.skin(&key, described);
                if skin.material.most_delta_lobes() > MAX_DELTA_LOBES {
                    let message = format!("sends light into more than {MAX_DELTA_LOBES} single directions: mix fewer kinds of glass");
                    self.fault(&key, &message);
                }
                let effects = skin.effects();
                let known = (self.world.material(skin), effects);
                self.materials.insert(key, known);
                known
            }
        };
        (kind(described).to_owned(), (id, effects))
    }

    /// A material with the reliefs and holes around it.
    fn skin(&mut self, pointer: &str, described: &describe::Material) -> Skin {
        match described {
            describe::Material::Bumped(m) => {
                let relief = self.relief(pointer, m);
                Skin { relief, ..self.skin_within(pointer, &m.surface) }
            }
            describe::Material::Masked(m) => {
                let opacity = self.textured(&format!("{pointer}/opacity"), &m.opacity);
                let inner = self.skin_within(pointer, &m.surface);
                let opacity = match inner.opacity {
                    None => opacity,
                    Some(more) => Texture::Product(Box::new(Product { a: opacity, b: more })),
                };
                Skin { opacity: Some(opacity), ..inner }
            }
            plain => self.material_of(pointer, plain).into(),
        }
    }

    fn skin_within(&mut self, pointer: &str, chosen: &MaterialRef) -> Skin {
        let default = describe::Material::default();
        let (pointer, described) = find(self.scene, &format!("{pointer}/surface"), chosen);
        self.skin(&pointer, described.unwrap_or(&default))
    }

    fn relief(&mut self, pointer: &str, m: &describe::Bumped) -> Option<Relief> {
        let scale = self.number(pointer, "scale", &m.scale);
        let normals = m.normal_map.as_ref().map(|map| self.normal_map(&format!("{pointer}/normal_map"), map));
        let heights = m.bump_map.as_ref().map(|map| self.textured(&format!("{pointer}/bump_map"), map));
        normals.map(|map| Relief::Normals { map, strength: scale.clone() }).or(heights.map(|map| Relief::Heights { map, scale }))
    }

    /// A material within another.
    fn part(&mut self, pointer: &str, key: &str, chosen: &MaterialRef) -> Material {
        self.parts += 1;
        let default = describe::Material::default();
        if self.parts > MOST_PARTS {
            return Material::diffuse(Spectrum::BLACK);
        }
        let (pointer, described) = find(self.scene, &format!("{pointer}/{key}"), chosen);
        self.material_of(&pointer, described.unwrap_or(&default))
    }

    fn material_of(&mut self, pointer: &str, described: &describe::Material) -> Material {
        use describe::Material as M;
        self.note_smooth(pointer, described);
        let mut textured = |key: &str, described: &Textured| self.textured(&format!("{pointer}/{key}"), described);
        match described {
            M::Diffuse(m) => Material::Diffuse { albedo: textured("albedo", &m.albedo) },
            M::Mirror(m) => Material::Mirror { color: textured("color", &m.color) },
            M::Conductor(m) => self.conductor(pointer, m),
            M::Dielectric(m) => self.dielectric(pointer, m),
            M::ThinDielectric(m) => {
                Material::ThinDielectric { color: textured("color", &m.color), eta: self.number(pointer, "eta", &m.eta) }
            }
            M::MatteCone(m) => Material::MatteCone { color: textured("color", &m.color), mattness: textured("mattness", &m.mattness) },
            M::OrenNayar(m) => {
                Material::OrenNayar { albedo: textured("albedo", &m.albedo), roughness: textured("roughness", &m.roughness) }
            }
            M::Phong(m) => Material::Phong { color: textured("color", &m.color), exponent: self.number(pointer, "exponent", &m.exponent) },
            M::BlinnPhong(m) => {
                Material::BlinnPhong { color: textured("color", &m.color), exponent: self.number(pointer, "exponent", &m.exponent) }
            }
            M::Metal(m) => Material::Metal { color: textured("color", &m.color), roughness: textured("roughness", &m.roughness) },
            M::Plastic(m) => self.plastic(pointer, m),
            M::DiffuseTransmission(m) => Material::DiffuseTransmission {
                reflectance: textured("reflectance", &m.reflectance),
                transmittance: textured("transmittance", &m.transmittance),
            },
            M::Coated(m) => self.coated(pointer, m),
            M::Mix(m) => self.mix(pointer, m),
            M::Sheen(m) => {
                let (color, roughness) = (textured("color", &m.color), textured("roughness", &m.roughness));
                Compound::Sheen(Sheen::new(self.part(pointer, "ground", &m.ground), color, roughness)).into()
            }
            M::TwoSided(m) => self.two_sided(pointer, m),
            M::Principled(m) => self.principled(pointer, m),
            // Refused where it is read: they stand around others.
            M::Bumped(_) | M::Masked(_) => Material::diffuse(Spectrum::BLACK),
        }
    }

    fn conductor(&mut self, pointer: &str, m: &describe::Conductor) -> Material {
        let finish = self.finish(pointer, m.finish());
        if let Some(color) = &m.color {
            return Material::metal(self.textured(&format!("{pointer}/color"), color), finish, m.multiscatter);
        }
        let named = m.metal.map(|metal| metal_of(metal).index());
        if let Some(index) = named {
            return Material::metal(index, finish, m.multiscatter);
        }
        let eta = m.eta.as_ref().map_or(Spectrum::BLACK.into(), |eta| self.channels(pointer, "eta", eta));
        let k = m.k.as_ref().map_or(Spectrum::BLACK.into(), |k| self.channels(pointer, "k", k));
        Material::metal((eta, k), finish, m.multiscatter)
    }

    fn dielectric(&mut self, pointer: &str, m: &describe::Dielectric) -> Material {
        let (eta, color) = (self.number(pointer, "eta", &m.eta), self.textured(&format!("{pointer}/color"), &m.color));
        let surface = match self.finish(pointer, m.finish()) {
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

    fn plastic(&mut self, pointer: &str, m: &describe::Plastic) -> Material {
        let (albedo, eta) = (self.textured(&format!("{pointer}/albedo"), &m.albedo), self.number(pointer, "eta", &m.eta));
        match self.finish(pointer, m.finish()) {
            None => Material::plastic(albedo, eta),
            finish => Compound::Coated(Coated { ground: Material::diffuse(albedo), coat: Coat::new(eta, Spectrum::ONE, finish) }).into(),
        }
    }

    fn coated(&mut self, pointer: &str, m: &describe::Coated) -> Material {
        let color = self.textured(&format!("{pointer}/color"), &m.color);
        let coat = Coat::new(self.number(pointer, "eta", &m.eta), color, self.finish(pointer, m.finish()));
        Compound::Coated(Coated { ground: self.part(pointer, "ground", &m.ground), coat }).into()
    }

    fn mix(&mut self, pointer: &str, m: &describe::MaterialMix) -> Material {
        let (a, b) = (self.part(pointer, "a", &m.a), self.part(pointer, "b", &m.b));
        match &m.fresnel {
            Some(eta) => Compound::Mix(Mix { a, b, share: Share::Fresnel { eta: self.number(pointer, "fresnel", eta) } }).into(),
            None => {
                let share = m.share.as_ref().map(|share| self.textured(&format!("{pointer}/share"), share));
                Material::mix(a, b, share.unwrap_or(Spectrum::BLACK.into()))
            }
        }
    }

    fn two_sided(&mut self, pointer: &str, m: &describe::TwoSided) -> Material {
        let mut side = |key: &str, chosen: &Option<MaterialRef>| {
            let material = self.part(pointer, key, chosen.as_ref()?);
            if material.transmits() {
                self.fault(&format!("{pointer}/{key}"), "lets light through, and a two-sided material does not: use it without");
            }
            Some(material)
        };
        let (front, back) = (side("front", &m.front), side("back", &m.back));
        Compound::Sides(Sides { front, back }).into()
    }

    fn principled(&mut self, pointer: &str, m: &describe::Principled) -> Material {
        let mut textured = |key: &str, described: &Textured| self.textured(&format!("{pointer}/{key}"), described);
        let base_color = textured("base_color", &m.base_color);
        let (metallic, transmission) = (textured("metallic", &m.metallic), textured("transmission", &m.transmission));
        let (specular, coat) = (textured("specular", &m.specular), textured("coat", &m.coat));
        let (coat_color, sheen_color) = (textured("coat_color", &m.coat_color), textured("sheen_color", &m.sheen_color));
        let sheen_roughness = textured("sheen_roughness", &m.sheen_roughness);
        let finish = self.roughened(pointer, ["roughness", "anisotropy"], [&m.roughness, &m.anisotropy], Distribution::Ggx);
        let round = Textured::gray(0.0);
        let coat_finish = self.roughened(pointer, ["coat_roughness"; 2], [&m.coat_roughness, &round], Distribution::Ggx);
        Principled {
            base_color,
            metallic,
            transmission,
            specular,
            finish,
            eta: self.number(pointer, "eta", &m.eta),
            coat,
            coat_eta: self.number(pointer, "coat_eta", &m.coat_eta),
            coat_color,
            coat_finish,
            sheen_color,
            sheen_roughness,
            multiscatter: m.multiscatter,
        }
        .into()
    }
}

/// Where a material is described, and how; `None` for a name that is not there.
fn find<'s>(scene: &'s describe::Scene, pointer: &str, chosen: &'s MaterialRef) -> (String, Option<&'s describe::Material>) {
    let place = match chosen {
        MaterialRef::Inline(_) => pointer.to_owned(),
        MaterialRef::Named(name) => format!("/materials{}", escaped(name)),
    };
    (place, scene.material(chosen))
}

fn kind(described: &describe::Material) -> &'static str {
    use describe::Material as M;
    match described {
        M::Diffuse(_) => "diffuse",
        M::Mirror(_) => "mirror",
        M::Conductor(_) => "conductor",
        M::Dielectric(_) => "dielectric",
        M::MatteCone(_) => "matte_cone",
        M::OrenNayar(_) => "oren_nayar",
        M::Phong(_) => "phong",
        M::BlinnPhong(_) => "blinn_phong",
        M::Metal(_) => "metal",
        M::Plastic(_) => "plastic",
        M::DiffuseTransmission(_) => "diffuse_transmission",
        M::ThinDielectric(_) => "thin_dielectric",
        M::Coated(_) => "coated",
        M::Mix(_) => "mix",
        M::Sheen(_) => "sheen",
        M::TwoSided(_) => "two_sided",
        M::Principled(_) => "principled",
        M::Bumped(_) => "bumped",
        M::Masked(_) => "masked",
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
