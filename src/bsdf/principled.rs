//! The material of interchange formats and painting programs: a handful of sliders.

use super::microfacet::Finish;
use super::{Coat, Coated, Compound, Material, Sheen};
use crate::math::Spectrum;
use crate::texture::{Number, Texture};

/// Metal, plastic, glass, lacquer and velvet by a base colour and some shares.
///
/// f = coat over ( sheen over ( metallic · metal + (1 − metallic) ( transmission · glass + (1 − transmission) · plastic ) ) )
///
/// - metal: facets that reflect the base colour straight on, by Schlick's formula
/// - glass: facets of the index `eta`; the base colour dims each passage and reflection
/// - plastic: `specular` of a clear layer with the same facets over a Lambertian ground, that then shows the base colour
///
/// It is a description: what scatters are the models that it names, each proved by itself. Shares that are constant 0 or 1
/// cost nothing.
///
/// Source: Burley, *Physically Based Shading at Disney* (2012), and the names of glTF 2.0. Tests: compounds_are_proved,
/// principled_is_what_it_names.
#[derive(Clone, Debug)]
pub struct Principled {
    pub base_color: Texture,
    pub metallic: Texture,
    pub transmission: Texture,
    pub specular: Texture,
    /// Of metal, glass and plastic; `None` where they are smooth.
    pub finish: Option<Finish>,
    /// Index of refraction of glass and plastic: at least 1.
    pub eta: Number,
    /// How much of the surface is coated.
    pub coat: Texture,
    /// Index of refraction of that coat: at least 1.
    pub coat_eta: Number,
    pub coat_color: Texture,
    /// `None` where it is smooth.
    pub coat_finish: Option<Finish>,
    pub sheen_color: Texture,
    /// How far its fibres spread, see [`Sheen`].
    pub sheen_roughness: Texture,
    /// Whether light is followed that facets of metal and glass reflect more than once.
    pub multiscatter: bool,
}

impl From<Principled> for Material {
    fn from(p: Principled) -> Material {
        let ground = || Material::diffuse(p.base_color.clone());
        let glaze = || Coat::new(p.eta.clone(), Spectrum::ONE, p.finish.clone()).as_seen();
        let glazed = || Compound::Coated(Coated { ground: ground(), coat: glaze() }).into();
        let plastic = || Material::mixed(ground, glazed, p.specular.clone());
        let glass = || match p.finish.clone() {
            None => Material::Dielectric { eta: p.eta.clone(), color: p.base_color.clone() },
            Some(finish) => Material::rough_glass(p.eta.clone(), p.base_color.clone(), finish, p.multiscatter),
        };
        let metal = || Material::metal(p.base_color.clone(), p.finish.clone(), p.multiscatter);
        let body = Material::mixed(|| Material::mixed(plastic, glass, p.transmission.clone()), metal, p.metallic.clone());
        let dressed = match p.sheen_color {
            Texture::Constant(color) if color.is_black() => body,
            color => Compound::Sheen(Sheen::new(body, color, p.sheen_roughness)).into(),
        };
        let lacquer = || Coat::new(p.coat_eta, p.coat_color, p.coat_finish);
        let coated = || Compound::Coated(Coated { ground: dressed.clone(), coat: lacquer() }).into();
        Material::mixed(|| dressed.clone(), coated, p.coat)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_not_made() {
        let [black, white] = [Spectrum::BLACK, Spectrum::ONE].map(Material::diffuse);
        assert_eq!(Material::mixed(|| black.clone(), || unreachable!("a share of 0"), 0.0.into()), black);
        assert_eq!(Material::mixed(|| unreachable!("a share of 1"), || white.clone(), 1.0.into()), white);
    }
}
