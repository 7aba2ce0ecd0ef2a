//! The principled material of interchange formats and painting programs.

use super::description::{Description, Prepare, given};
use super::microfacet::{Distribution, Roughness, roughened};
use super::{Coat, Coated, Compound, FilmLayer, Material, Metallic, Sheen, textured};
use crate::format::Textured;
use crate::texture::{Number, Texture};

/// Metal, plastic, glass, coat and velvet by a base colour and shares.
///
/// f = coat over ( sheen over ( metallic · metal + (1 − metallic) ( transmission · glass + (1 − transmission) · plastic ) ) )
///
/// - metal: facets with the base colour as reflectance at normal incidence, by Schlick's formula
/// - glass: facets of the index `eta`; the base colour multiplies all transmitted and reflected light
/// - plastic: the share `specular` of a clear layer with the same facets, over a Lambertian base that keeps the base colour
///
/// The share `iridescence` of the surface is under a thin film.
///
/// It is only a description: light is scattered by the models above, which are tested by themselves. A share of constant 0 or 1 costs
/// nothing.
///
/// Source: Burley, *Physically Based Shading at Disney* (2012), and the names of glTF 2.0. Tests: compounds_are_proved,
/// principled_extremes_are_the_named_materials.
#[derive(Clone, Debug)]
pub struct Principled {
    /// The base colour: [0, 1].
    pub base_color: Texture,
    /// The share of metal, from 0 to 1.
    pub metallic: Texture,
    /// The share of glass in the part that is not metal, from 0 to 1.
    pub transmission: Texture,
    /// The share of plastic with a clear layer, from 0 to 1.
    pub specular: Texture,
    /// The roughness of metal, glass and plastic; `None` where they are smooth.
    pub roughness: Option<Roughness>,
    /// The index of refraction of glass and plastic: at least 1.
    pub eta: Number,
    /// The share of the surface that is coated, from 0 to 1.
    pub coat: Texture,
    /// The index of refraction of the coat: at least 1.
    pub coat_eta: Number,
    /// The transmittance of the coat straight down and up: [0, 1].
    pub coat_color: Texture,
    /// The roughness of the coat; `None` where it is smooth.
    pub coat_roughness: Option<Roughness>,
    /// The colour of the sheen's fibres: [0, 1]; black is no sheen.
    pub sheen_color: Texture,
    /// The spread of the sheen's fibres, see [`Sheen`].
    pub sheen_roughness: Texture,
    /// The share of the surface under a thin film, from 0 to 1.
    pub iridescence: Texture,
    /// The film.
    pub film: FilmLayer,
    /// Whether light is included that facets of metal and glass reflect more than once.
    pub multiscatter: bool,
}

impl From<Principled> for Material {
    fn from(p: Principled) -> Material {
        let base = || Material::diffuse(p.base_color.clone());
        let glass_of = |more| textured::Dielectric::new(p.eta.clone(), p.base_color.clone(), p.roughness.clone(), more);
        let layered = |film| {
            let coat = Coat::under_film(p.eta.clone(), 1.0, p.roughness.clone(), film).keep_base_color();
            Compound::Coated(Coated { base: base(), coat }).into()
        };
        let metal_of = |reflectance| Material::metal(reflectance, p.roughness.clone(), p.multiscatter);
        let bare_metal = || Metallic::from(p.base_color.clone());
        let partly = |bare: &dyn Fn() -> Material, filmed: &dyn Fn() -> Material| Material::mixed(bare, filmed, p.iridescence.clone());
        let coated = || partly(&|| layered(None), &|| layered(Some(p.film.clone())));
        let glass = || partly(&|| glass_of(p.multiscatter).into(), &|| glass_of(false).under_film(p.film.clone()).into());
        let plastic = || Material::mixed(base, coated, p.specular.clone());
        let metal = || partly(&|| metal_of(bare_metal()), &|| metal_of(bare_metal().under_film(p.film.clone())));
        let body = Material::mixed(|| Material::mixed(plastic, glass, p.transmission.clone()), metal, p.metallic.clone());
        let with_sheen = match p.sheen_color {
            Texture::Constant(color) if color.is_black() => body,
            color => Compound::Sheen(Sheen::new(body, color, p.sheen_roughness)).into(),
        };
        let coat = || Coat::new(p.coat_eta, p.coat_color, p.coat_roughness);
        let coated = || Compound::Coated(Coated { base: with_sheen.clone(), coat: coat() }).into();
        Material::mixed(|| with_sheen.clone(), coated, p.coat)
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::format::{CoatIndex, FilmIndex, FilmThickness, Textured, Varying};

    /// Metal, plastic, glass, coat and velvet by a base colour and shares, as in glTF and painting programs. White plastic loses up to
    /// 0.7 % of the light under a coat, 0.6 % under white sheen of the default roughness, and 2.6 % under both. Rough metal loses up to 6 %
    /// under a coat and 13 % under sheen.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Principled {
        /// The base colour: for metal the reflectance at normal incidence, for plastic the albedo of its base, for glass a factor of
        /// all transmitted and reflected light.
        pub base_color: Textured,
        /// The share of metal.
        pub metallic: Textured,
        /// The roughness of metal, plastic and glass: 0 is smooth, 1 the roughest.
        pub roughness: Textured,
        /// The anisotropy: 0 gives round highlights, 1 highlights ten times as long as wide, along the first texture coordinate.
        pub anisotropy: Textured,
        /// The share of the plastic with a clear layer; the rest is matte.
        pub specular: Textured,
        /// The index of refraction of plastic and glass.
        pub eta: Varying<CoatIndex>,
        /// The share of glass in the part that is not metal.
        pub transmission: Textured,
        /// The share that has a coat, another clear layer above all others.
        pub coat: Textured,
        /// The roughness of the coat: 0 is smooth, 1 the roughest.
        pub coat_roughness: Textured,
        /// The index of refraction of the coat.
        pub coat_eta: Varying<CoatIndex>,
        /// The share of light that is left after passing straight down through the coat and up again.
        pub coat_color: Textured,
        /// The colour of fibres on the surface; black is none.
        pub sheen_color: Textured,
        /// The spread of the fibres: at 0.1 and below they stand upright, at 1 they lie in all directions.
        pub sheen_roughness: Textured,
        /// The share of the surface that is under a thin film, with the colours of interference. Metal counts as a clear body that
        /// reflects `base_color` at normal incidence. Plastic reflects the film's colours, and its base gets what the brightest film would
        /// leave: white plastic loses up to 9 % of the light under a film of index 1.3, and up to 17 % under one of index 2. Rough
        /// glass under the film is a little too dark: light that hits more than one facet is lost, whatever `multiscatter` says.
        pub iridescence: Textured,
        /// The index of refraction of the film.
        pub iridescence_eta: FilmIndex,
        /// The thickness of the film in nanometres.
        pub iridescence_thickness: Varying<FilmThickness>,
        /// Whether light is included that facets of metal and glass reflect more than once.
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
                iridescence: Textured::black(),
                iridescence_eta: FilmIndex::known(1.3),
                iridescence_thickness: Varying::Same(FilmThickness::known(400.0)),
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
            ("iridescence", Some(&self.iridescence)),
            ("iridescence_thickness/by", self.iridescence_thickness.by()),
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
            roughness: roughened(builder, ["roughness", "anisotropy"], [&self.roughness, &self.anisotropy], Distribution::Ggx),
            eta: builder.number("eta", &self.eta),
            coat: builder.texture("coat", &self.coat),
            coat_eta: builder.number("coat_eta", &self.coat_eta),
            coat_color: builder.texture("coat_color", &self.coat_color),
            coat_roughness: roughened(builder, ["coat_roughness"; 2], [&self.coat_roughness, &round], Distribution::Ggx),
            sheen_color: builder.texture("sheen_color", &self.sheen_color),
            sheen_roughness: builder.texture("sheen_roughness", &self.sheen_roughness),
            iridescence: builder.texture("iridescence", &self.iridescence),
            film: FilmLayer {
                eta: self.iridescence_eta.get() as f32,
                thickness: builder.number("iridescence_thickness", &self.iridescence_thickness),
            },
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
