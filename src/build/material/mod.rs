//! Builds materials and their parts.

mod texture;

use super::Builder;
use crate::bsdf::description::{Description, Prepare};
use crate::bsdf::microfacet::{Distribution, Microfacets, roughness};
use crate::bsdf::{MAX_DELTA_LOBES, Material, MaterialId, SurfaceMaterial};
use crate::describe::{self, MaterialRef, Textured};
use crate::effects::Effects;
use crate::reader::escaped;
use crate::texture::Texture;

pub(super) use texture::{MOST_TEXTURES, Use};

/// The largest number of materials within materials. Each use is a copy, so that nested mixes grow as 2ⁿ.
pub(super) const MOST_PARTS: usize = 1 << 12;

impl Builder<'_> {
    /// Builds a material, or finds it if it was built before. Returns its `type`, its id and its effects.
    pub(super) fn material(&mut self, pointer: &str, chosen: Option<&MaterialRef>) -> (String, (MaterialId, Effects)) {
        let default = describe::Material::default();
        let (key, described) = chosen.map_or((String::new(), None), |chosen| find(self.scene, pointer, chosen));
        let described = described.unwrap_or(&default);
        let (id, effects) = match self.materials.get(&key) {
            Some(known) => *known,
            None => {
                let surface = self.surface(&key, described);
                if surface.material.most_delta_lobes() > MAX_DELTA_LOBES {
                    let message = format!("sends light into more than {MAX_DELTA_LOBES} single directions: mix fewer kinds of glass");
                    self.fault(&key, &message);
                }
                let effects = self.effects_of(&surface);
                let known = (self.world.material(surface), effects);
                self.materials.insert(key, known);
                known
            }
        };
        (described.kind().to_owned(), (id, effects))
    }

    /// The effects of a material in this scene.
    fn effects_of(&self, surface: &SurfaceMaterial) -> Effects {
        if self.scene.film.has_footprints() { surface.effects() } else { surface.effects().without(Effects::FOOTPRINTS) }
    }

    /// Builds a material with its normal or bump map and its opacity.
    fn surface(&mut self, pointer: &str, described: &describe::Material) -> SurfaceMaterial {
        self.note_smooth(pointer, described.description());
        described.description().surface(&mut At { builder: self, pointer })
    }

    /// Warns about roughnesses so small that they count as 0.
    fn note_smooth(&mut self, pointer: &str, described: &dyn Description) {
        for (key, roughness) in described.roughnesses() {
            let Textured::Color(color) = roughness else { continue };
            let value = super::rgb(color).average();
            if value > 0.0 && Microfacets::new(roughness::alpha(value, 0.0), Distribution::Ggx).is_none() {
                self.warnings.push(format!("{}: {pointer}/{key}: {value} is as good as 0, the surface is smooth", self.source.file));
            }
        }
    }
}

/// The builder, at the material with a JSON pointer.
struct At<'b, 'a> {
    builder: &'b mut Builder<'a>,
    pointer: &'b str,
}

impl Prepare for At<'_, '_> {
    fn texture(&mut self, key: &str, described: &Textured) -> Texture {
        self.builder.textured(&format!("{}/{key}", self.pointer), described)
    }

    fn texture_at_points(&mut self, key: &str, described: &Textured) -> Texture {
        self.builder.texture_for(&format!("{}/{key}", self.pointer), described, Use::Points)
    }

    fn normal_map(&mut self, key: &str, described: &Textured) -> Texture {
        self.builder.normal_map(&format!("{}/{key}", self.pointer), described)
    }

    fn part(&mut self, key: &str, described: &MaterialRef) -> Material {
        self.builder.parts += 1;
        if self.builder.parts > MOST_PARTS {
            return Material::diffuse(0.0);
        }
        let default = describe::Material::default();
        let (pointer, described) = find(self.builder.scene, &format!("{}/{key}", self.pointer), described);
        let described = described.unwrap_or(&default).description();
        self.builder.note_smooth(&pointer, described);
        described.prepare(&mut At { builder: self.builder, pointer: &pointer })
    }

    fn surface(&mut self, key: &str, described: &MaterialRef) -> SurfaceMaterial {
        let default = describe::Material::default();
        let (pointer, described) = find(self.builder.scene, &format!("{}/{key}", self.pointer), described);
        self.builder.surface(&pointer, described.unwrap_or(&default))
    }

    fn fault(&mut self, key: &str, message: &str) {
        self.builder.fault(&format!("{}/{key}", self.pointer), message);
    }
}

/// The JSON pointer and the description of a material; the description is `None` for an unknown name.
fn find<'s>(scene: &'s describe::Scene, pointer: &str, chosen: &'s MaterialRef) -> (String, Option<&'s describe::Material>) {
    let place = match chosen {
        MaterialRef::Inline(_) => pointer.to_owned(),
        MaterialRef::Named(name) => format!("/materials{}", escaped(name)),
    };
    (place, scene.material(chosen))
}
