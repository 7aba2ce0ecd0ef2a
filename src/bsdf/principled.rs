//! The material of interchange formats and painting programs: a handful of sliders.

use super::description::{Description, Prepare, given};
use super::microfacet::{Distribution, Roughness, roughened};
use super::{Coat, Coated, Compound, Material, Sheen, textured};
use crate::format::Textured;
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
    pub finish: Option<Roughness>,
    /// Index of refraction of glass and plastic: at least 1.
    pub eta: Number,
    /// How much of the surface is coated.
    pub coat: Texture,
    /// Index of refraction of that coat: at least 1.
    pub coat_eta: Number,
    pub coat_color: Texture,
    /// `None` where it is smooth.
    pub coat_finish: Option<Roughness>,
    pub sheen_color: Texture,
    /// How far its fibres spread, see [`Sheen`].
    pub sheen_roughness: Texture,
    /// Whether light is followed that facets of metal and glass reflect more than once.
    pub multiscatter: bool,
}

impl From<Principled> for Material {
    fn from(p: Principled) -> Material {
        let ground = || Material::diffuse(p.base_color.clone());
        let glaze = || Coat::new(p.eta.clone(), 1.0, p.finish.clone()).keep_base_color();
        let glazed = || Compound::Coated(Coated { ground: ground(), coat: glaze() }).into();
        let plastic = || Material::mixed(ground, glazed, p.specular.clone());
        let glass = || textured::Dielectric::new(p.eta.clone(), p.base_color.clone(), p.finish.clone(), p.multiscatter).into();
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

/// As a scene file says it.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::format::{CoatIndex, Textured, Varying};

    /// Metal, plastic, glass, lacquer and velvet by a base colour and some shares, as in glTF and painting programs. White plastic loses
    /// up to 0.7 % of the light under a coat, 0.6 % under white sheen of the default roughness, 2.6 % under both; rough metal up to 6
    /// and 13 %.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Principled {
        /// Of metal the colour that is seen straight on, of plastic that of its ground, of glass what passes or is reflected.
        pub base_color: Textured,
        /// The share of metal.
        pub metallic: Textured,
        /// Of metal, plastic and glass: 0 is smooth, 1 the roughest.
        pub roughness: Textured,
        /// From round highlights to highlights ten times as long as wide, along the first texture coordinate.
        pub anisotropy: Textured,
        /// How much of the plastic is clad in its clear layer: without, it is matte.
        pub specular: Textured,
        /// Index of refraction of plastic and glass.
        pub eta: Varying<CoatIndex>,
        /// The share of glass in what is not metal.
        pub transmission: Textured,
        /// The share that is coated with another clear layer.
        pub coat: Textured,
        /// Of that layer.
        pub coat_roughness: Textured,
        /// Of that layer.
        pub coat_eta: Varying<CoatIndex>,
        /// What that layer leaves of light that goes straight down through it and up again.
        pub coat_color: Textured,
        /// Fibres on the surface; black is none.
        pub sheen_color: Textured,
        /// Of the fibres: 0.1 (and below) stand straight, 1 lie all ways.
        pub sheen_roughness: Textured,
        /// Follow light that facets of metal and glass reflect more than once.
        pub multiscatter: bool,
    }

    impl Default for Principled {
        fn default() -> Principled {
            Principled {
                base_color: Textured::gray(0.8),
                metallic: Textured::black(),
                roughness: Textured::gray(0.5),
                anisotropy: Textured::black(),
                specular: Textured::white(),
                eta: Varying::Same(CoatIndex::known(1.5)),
                transmission: Textured::black(),
                coat: Textured::black(),
                coat_roughness: Textured::black(),
                coat_eta: Varying::Same(CoatIndex::known(1.5)),
                coat_color: Textured::white(),
                sheen_color: Textured::black(),
                sheen_roughness: Textured::gray(0.5),
                multiscatter: true,
            }
        }
    }
}

impl Description for described::Principled {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let all = [
            ("base_color", Some(&self.base_color)),
            ("metallic", Some(&self.metallic)),
            ("roughness", Some(&self.roughness)),
            ("anisotropy", Some(&self.anisotropy)),
            ("specular", Some(&self.specular)),
            ("transmission", Some(&self.transmission)),
            ("coat", Some(&self.coat)),
            ("coat_roughness", Some(&self.coat_roughness)),
            ("coat_color", Some(&self.coat_color)),
            ("sheen_color", Some(&self.sheen_color)),
            ("sheen_roughness", Some(&self.sheen_roughness)),
            ("eta/by", self.eta.by()),
            ("coat_eta/by", self.coat_eta.by()),
        ];
        all.into_iter().filter_map(given).collect()
    }

    fn roughnesses(&self) -> Vec<(&'static str, &Textured)> {
        vec![("roughness", &self.roughness), ("coat_roughness", &self.coat_roughness)]
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let round = Textured::gray(0.0);
        Principled {
            base_color: builder.texture("base_color", &self.base_color),
            metallic: builder.texture("metallic", &self.metallic),
            transmission: builder.texture("transmission", &self.transmission),
            specular: builder.texture("specular", &self.specular),
            finish: roughened(builder, ["roughness", "anisotropy"], [&self.roughness, &self.anisotropy], Distribution::Ggx),
            eta: builder.number("eta", &self.eta),
            coat: builder.texture("coat", &self.coat),
            coat_eta: builder.number("coat_eta", &self.coat_eta),
            coat_color: builder.texture("coat_color", &self.coat_color),
            coat_finish: roughened(builder, ["coat_roughness"; 2], [&self.coat_roughness, &round], Distribution::Ggx),
            sheen_color: builder.texture("sheen_color", &self.sheen_color),
            sheen_roughness: builder.texture("sheen_roughness", &self.sheen_roughness),
            multiscatter: self.multiscatter,
        }
        .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_not_made() {
        let [black, white] = [0.0, 1.0].map(Material::diffuse);
        assert_eq!(Material::mixed(|| black.clone(), || unreachable!("a share of 0"), 0.0.into()), black);
        assert_eq!(Material::mixed(|| unreachable!("a share of 1"), || white.clone(), 1.0.into()), white);
    }
}
