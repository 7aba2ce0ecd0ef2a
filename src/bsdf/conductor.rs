//! Smooth metal, and the material `conductor`.

use glam::{DVec3, Vec2};

use super::clear_film;
use super::description::{Description, Prepare, given};
use super::film::{Film, FilmTable};
use super::microfacet::{EnergyLossTable, Roughness, RoughnessKeys, roughness_keys};
use super::{
    Bsdf, BsdfSample, ClearFilm, FilmLayer, HitContext, Lookup, Material, RoughConductor, ScatteringModel, TexturedModel, TransportMode,
    rough_conductor,
};
use crate::effects::Effects;
use crate::format::{Textured, VaryingPerChannel};
use crate::math::{Local, Rgb, Spectrum, fresnel};
use crate::texture::{Number, Texture};

/// The reflectance of metal as a function of the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// Fresnel's equations with the complex index η + ik relative to the outside, for each coefficient of the spectrum.
    Index {
        /// η, the real part of the index.
        eta: Spectrum,
        /// k, the extinction coefficient.
        k: Spectrum,
    },
    /// F = F₀ + (1 − F₀) (1 − μ)⁵, by the reflectance F₀ at normal incidence.
    ///
    /// Source: Schlick, *An Inexpensive BRDF Model for Physically-based Rendering* (1994).
    Schlick {
        /// F₀: [0, 1].
        normal: Spectrum,
    },
    /// Reflectance under a thin film.
    Film {
        /// The reflectance for each angle and thickness.
        table: &'static FilmTable,
        /// The thickness of the film (nm).
        thickness: f32,
    },
    /// Reflectance under a thin film, by the reflectance of the bare surface at normal incidence.
    ClearFilm(ClearFilm),
}

impl Reflectance {
    /// The reflectance of a metal by its index of refraction η + ik, stored for red, green and blue.
    pub fn of_index(eta: Rgb, k: Rgb) -> Reflectance {
        Reflectance::Index { eta: Spectrum::from_coefficients(eta), k: Spectrum::from_coefficients(k) }
    }

    /// The reflectance of a metal under a film by its colour: that of a clear body which reflects as much at normal incidence.
    ///
    /// - `thickness`: that of the film (nm)
    fn of_color_under_film(color: Rgb, eta: f32, thickness: f32) -> Reflectance {
        let base = Spectrum::from_albedo(color).map(ClearFilm::base_of_reflectance);
        Reflectance::ClearFilm(ClearFilm { eta, thickness, base })
    }

    /// The reflectance at an angle.
    ///
    /// - `cos`: the cosine of the angle to the normal; its sign does not matter
    #[inline(always)]
    pub fn at(&self, cos: f32) -> Spectrum {
        match self {
            Reflectance::Index { eta, k } => eta.zip_all(*k, |eta, k| fresnel::conductor(cos, eta, k)),
            Reflectance::Schlick { normal } => schlick(*normal, cos.abs()),
            Reflectance::Film { table, thickness } => table.at(cos, *thickness),
            Reflectance::ClearFilm(film) => film.at(cos),
        }
    }

    /// The reflectance by the square of the cosine.
    #[inline(always)]
    pub fn at_square(&self, cos2: f32) -> Spectrum {
        match self {
            Reflectance::Index { eta, k } => eta.zip_all(*k, |eta, k| fresnel::conductor_of_square(cos2, eta, k)),
            Reflectance::Schlick { normal } => schlick(*normal, cos2.sqrt()),
            Reflectance::Film { table, thickness } => table.at(cos2.sqrt(), *thickness),
            Reflectance::ClearFilm(film) => film.at(cos2.sqrt()),
        }
    }

    /// F̄ = 2 ∫ F μ dμ: the cosine-weighted mean over the hemisphere. For Schlick's formula it is F₀ + (1 − F₀)/21.
    pub fn mean(&self) -> Spectrum {
        let of_steps = |steps: usize| {
            let at = |i: usize| (i as f32 + 0.5) / steps as f32;
            (0..steps).map(|i| self.at(at(i)) * (2.0 * at(i) / steps as f32)).sum()
        };
        match self {
            Reflectance::Index { .. } => of_steps(64),
            // Few steps, because a step takes a tenth of a microsecond and more.
            Reflectance::ClearFilm(_) => of_steps(16),
            Reflectance::Schlick { normal } => normal.map(|f0| f0 + (1.0 - f0) / 21.0),
            Reflectance::Film { table, thickness } => table.mean(*thickness),
        }
    }
}

#[inline(always)]
fn schlick(normal: Spectrum, cos: f32) -> Spectrum {
    let rest = 1.0 - cos.min(1.0);
    normal.map(|f0| f0 + (1.0 - f0) * ((rest * rest) * (rest * rest) * rest))
}

/// Reflection at a smooth metal surface.
///
/// f(wo, wi) = F(cos θo) δ(wi − reflect(wo)) / |cos θi|
///
/// - sampling: the mirror direction, with weight F
///
/// Source: Born and Wolf, *Principles of Optics*, ch. 14. Tests: row F11 of `pt torture`,
/// a_conductor_follows_the_complex_fresnel_equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// F as a function of the angle.
    pub reflectance: Reflectance,
}

impl ScatteringModel for Conductor {
    #[inline]
    fn sample(&self, wo: Local, _choice: f32, _u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let reflectance = self.reflectance.at(wo.abs_cos());
        (!reflectance.is_black()).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), reflectance))
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [self.sample(wo, 0.0, Vec2::ZERO, mode), None]
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    pub use crate::bsdf::element::Element;
    use crate::bsdf::microfacet::{AlphaKey, Distribution};
    use crate::format::{Extinction, FilmIndex, FilmThickness, Index, Textured, Varying, VaryingPerChannel};

    /// Metal, polished or rough. It is given by its name, by its index of refraction eta + i·k, or by its colour.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Conductor {
        /// A chemical element, by its published index of refraction reduced to red, green and blue. At normal incidence it has the
        /// colour of its published spectrum in daylight. The exception is gold, which is redder than Rec. 709 can show: its red of 1.04
        /// is reduced to 0.97.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub metal: Option<Element>,
        /// The real part of the index of refraction, relative to the outside.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub eta: Option<VaryingPerChannel<Index>>,
        /// The extinction coefficient, relative to the outside.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub k: Option<VaryingPerChannel<Extinction>>,
        /// The reflectance at normal incidence. It approaches white at grazing incidence (Schlick's formula).
        #[serde(skip_serializing_if = "Option::is_none")]
        pub color: Option<Textured>,
        /// The roughness: 0 is a mirror, 1 nearly matte. The width of highlights, alpha, is its square, so that equal steps look
        /// equal. Values below 0.001 count as smooth. A colour counts by its mean.
        pub roughness: Textured,
        /// The anisotropy: 0 gives round highlights, 1 highlights ten times as long as wide, along the first texture coordinate. A colour
        /// counts by its mean.
        pub anisotropy: Textured,
        /// The width of highlights itself, in place of `roughness` and `anisotropy`; `[along u, along v]` for different widths.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub alpha: Option<AlphaKey>,
        /// The distribution of the facets' normals on a rough surface.
        pub distribution: Distribution,
        /// Whether light that facets reflect more than once is included. Without it rough metals are too dark: white metal of
        /// roughness 0.7 loses 30 % of the light, of roughness 1 60 %. The cost is a table for each metal and a fifth of the time of a
        /// reflection; where `eta` or `k` vary, two microseconds more. A table takes 30 ms once with GGX, six times that with Beckmann,
        /// twenty to thirty times that where the roughness is a texture or anisotropic, and a hundred times that where the anisotropy is a
        /// texture or both hold; the last are accurate to 1 %.
        pub multiscatter: bool,
        /// A thin clear film on the metal, which gives it the colours of interference: anodized titanium, tempered steel. `eta` and `k` must
        /// be the same everywhere. With `color` the metal counts as a clear body that reflects as much at normal incidence, and bright
        /// metal is darker towards its edge than without a film: one of 0.9 reflects 0.79 at 78°.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub film: Option<SurfaceFilm>,
    }

    /// A thin film on metal or glass.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct SurfaceFilm {
        /// The index of refraction of the film.
        pub eta: FilmIndex,
        /// The thickness of the film in nanometres. On metal by its index, a film whose thickness varies needs a table over the thickness,
        /// once: it takes half a second for up to 300 nm of an oxide, and twenty seconds at the most.
        pub thickness: Varying<FilmThickness>,
    }

    impl Default for Conductor {
        fn default() -> Conductor {
            Conductor {
                metal: None,
                eta: None,
                k: None,
                color: None,
                roughness: Textured::black(),
                anisotropy: Textured::black(),
                alpha: None,
                distribution: Distribution::Ggx,
                multiscatter: true,
                film: None,
            }
        }
    }
}

impl Description for described::Conductor {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let own = [
            ("color", self.color.as_ref()),
            ("eta/by", self.eta.as_ref().and_then(VaryingPerChannel::by)),
            ("k/by", self.k.as_ref().and_then(VaryingPerChannel::by)),
            ("film/thickness/by", self.film.as_ref().and_then(|film| film.thickness.by())),
        ];
        own.into_iter().filter_map(given).chain(roughness_keys!(self).textures()).collect()
    }

    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        Some(roughness_keys!(self))
    }

    /// A metal needs exactly one of its name, its index and its colour.
    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        fn varies<T>(index: &Option<VaryingPerChannel<T>>) -> bool {
            matches!(index, Some(VaryingPerChannel::Between(_)))
        }
        let fault = match (self.metal.is_some(), self.eta.is_some(), self.k.is_some(), self.color.is_some()) {
            (false, true, true, false) if self.film.is_some() && (varies(&self.eta) || varies(&self.k)) => {
                ("/film", "a film needs an eta and a k that are the same everywhere")
            }
            (true, false, false, false) | (false, true, true, false) | (false, false, false, true) => return vec![],
            (true, true, _, _) => ("/eta", "give metal, or eta and k, not both"),
            (true, _, true, _) => ("/k", "give metal, or eta and k, not both"),
            (true, _, _, true) => ("/color", "give metal or color, not both"),
            (_, _, _, true) => ("/color", "give eta and k, or color, not both"),
            (false, true, false, _) => ("", "missing key \"k\""),
            (false, false, true, _) => ("", "missing key \"eta\""),
            (false, false, false, false) => ("", "a conductor needs \"metal\", or \"eta\" and \"k\", or \"color\""),
        };
        vec![fault]
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let roughness = roughness_keys!(self).prepare(builder);
        let index = match self.metal {
            Some(metal) => metal.index().into(),
            None => {
                let eta = self.eta.as_ref().map_or(0.0.into(), |eta| builder.channels("eta", eta));
                let k = self.k.as_ref().map_or(0.0.into(), |k| builder.channels("k", k));
                Metallic::from((eta, k))
            }
        };
        let bare = match &self.color {
            Some(color) => builder.texture("color", color).into(),
            None => index,
        };
        let reflectance = match &self.film {
            Some(film) => {
                let thickness = builder.number("film/thickness", &film.thickness);
                bare.under_film(FilmLayer { eta: film.eta.get() as f32, thickness })
            }
            None => bare,
        };
        Material::metal(reflectance, roughness, self.multiscatter)
    }
}

/// The model with its textures.
pub mod textured {
    use super::{EnergyLossTable, Metallic, Roughness};

    /// Metal with textures for parameters: smooth, rough, or varying between the two.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Conductor {
        pub(super) reflectance: Metallic,
        pub(super) roughness: Option<Roughness>,
        /// The table for light that facets reflect more than once.
        pub(super) losses: Option<&'static EnergyLossTable>,
    }
}

impl textured::Conductor {
    /// Metal, polished or rough.
    ///
    /// - `roughness`: the roughness; `None` for polished metal
    /// - `multiscatter`: whether to include light that facets reflect more than once
    pub fn new(reflectance: impl Into<Metallic>, roughness: Option<Roughness>, multiscatter: bool) -> textured::Conductor {
        let rough = roughness.as_ref().filter(|_| multiscatter);
        let losses = rough.map(|roughness| rough_conductor::losses(roughness.domain(), roughness.distribution));
        textured::Conductor { reflectance: reflectance.into(), roughness, losses }
    }
}

impl Lookup for textured::Conductor {
    type Model = Bsdf<'static>;

    fn at(&self, at: &HitContext) -> Bsdf<'static> {
        let reflectance = self.reflectance.at(at);
        let Some(facets) = self.roughness.as_ref().and_then(|roughness| roughness.at(&at.texture)) else {
            return Bsdf::Conductor(Conductor { reflectance });
        };
        let mean = |losses| rough_conductor::MultiScatter::new(losses, facets.alpha, self.reflectance.mean(&reflectance));
        Bsdf::RoughConductor(RoughConductor { reflectance, facets, more: self.losses.and_then(mean) })
    }

    fn textures(&self) -> Vec<&Texture> {
        self.reflectance.textures().chain(self.roughness.iter().flat_map(Roughness::textures)).collect()
    }

    fn recentred(self, origin: DVec3) -> textured::Conductor {
        let roughness = self.roughness.map(|roughness| roughness.recentred(origin));
        textured::Conductor { reflectance: self.reflectance.recentred(origin), roughness, ..self }
    }
}

impl TexturedModel for textured::Conductor {
    fn effects(&self) -> Effects {
        let film = if matches!(self.reflectance, Metallic::Film { .. } | Metallic::ColorUnderFilm { .. }) {
            Effects::THIN_FILM
        } else {
            Effects::NONE
        };
        let smooth = Effects::SPECULAR_REFLECTION;
        film | self.roughness.as_ref().map_or(smooth, |roughness| roughness.effects(smooth))
    }

    fn is_anisotropic(&self) -> bool {
        self.roughness.as_ref().is_some_and(Roughness::is_anisotropic)
    }
}

/// The reflectance of metal, which may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Metallic {
    /// Reflectance by a constant index of refraction.
    Index {
        /// The reflectance as a function of the angle.
        reflectance: Reflectance,
        /// F̄, see [`Reflectance::mean`].
        mean: Spectrum,
    },
    /// Reflectance by an index of refraction that varies.
    Indices {
        /// η, the real part of the index.
        eta: Texture,
        /// k, the extinction coefficient.
        k: Texture,
    },
    /// Reflectance by its value at normal incidence, with Schlick's formula.
    Color(Texture),
    /// Reflectance by a constant index of refraction under a thin film.
    Film {
        /// The reflectance for each angle and thickness.
        table: &'static FilmTable,
        /// The thickness of the film (nm).
        thickness: Number,
    },
    /// Reflectance under a thin film by that of the bare metal at normal incidence.
    ColorUnderFilm {
        /// The reflectance of the bare metal at normal incidence. It is that of a real index of refraction.
        color: Texture,
        /// The film.
        film: FilmLayer,
        /// F̄, if colour and thickness are the same everywhere.
        mean: Option<Spectrum>,
    },
}

impl Metallic {
    fn at(&self, at: &HitContext) -> Reflectance {
        match self {
            Metallic::Index { reflectance, .. } => *reflectance,
            Metallic::Indices { eta, k } => Reflectance::of_index(eta.at(&at.texture), k.at(&at.texture)),
            Metallic::Color(color) => Reflectance::Schlick { normal: Spectrum::from_albedo(color.at(&at.texture)) },
            Metallic::Film { table, thickness } => Reflectance::Film { table, thickness: thickness.at(&at.texture) },
            Metallic::ColorUnderFilm { color, film, .. } => {
                Reflectance::of_color_under_film(color.at(&at.texture), film.eta, film.thickness.at(&at.texture))
            }
        }
    }

    /// The metal under a thin film. Metal with an index of refraction that varies stays as it is.
    pub fn under_film(self, film: FilmLayer) -> Metallic {
        let (n, k) = match self {
            Metallic::Color(color) => {
                clear_film::prepare();
                let mean = match (&color, film.thickness.constant()) {
                    (Texture::Constant(color), Some(thickness)) => {
                        Some(Reflectance::of_color_under_film(*color, film.eta, thickness).mean())
                    }
                    _ => None,
                };
                return Metallic::ColorUnderFilm { color, film, mean };
            }
            Metallic::Index { reflectance: Reflectance::Index { eta, k }, .. } => (eta, k),
            other => return other,
        };
        let base = [n, k].map(|of| {
            let [r, g, b] = of.coefficients();
            Rgb::new(r, g, b)
        });
        let table = Film { eta: film.eta, thickness: film.thickness.range(), base, on_both_faces: false }.table();
        Metallic::Film { table, thickness: film.thickness }
    }

    /// The mean F̄ of the reflectance at a point.
    fn mean(&self, reflectance: &Reflectance) -> Spectrum {
        match self {
            Metallic::Index { mean, .. } | Metallic::ColorUnderFilm { mean: Some(mean), .. } => *mean,
            _ => reflectance.mean(),
        }
    }

    fn textures(&self) -> impl Iterator<Item = &Texture> {
        let [first, second] = match self {
            Metallic::Index { .. } => [None, None],
            Metallic::Indices { eta, k } => [Some(eta), Some(k)],
            Metallic::Color(color) => [Some(color), None],
            Metallic::Film { thickness, .. } => [thickness.texture(), None],
            Metallic::ColorUnderFilm { color, film, .. } => [Some(color), film.thickness.texture()],
        };
        first.into_iter().chain(second)
    }

    fn recentred(self, origin: DVec3) -> Metallic {
        match self {
            Metallic::Index { .. } => self,
            Metallic::Indices { eta, k } => Metallic::Indices { eta: eta.recentred(origin), k: k.recentred(origin) },
            Metallic::Color(color) => Metallic::Color(color.recentred(origin)),
            Metallic::Film { table, thickness } => Metallic::Film { table, thickness: thickness.recentred(origin) },
            Metallic::ColorUnderFilm { color, film, mean } => {
                Metallic::ColorUnderFilm { color: color.recentred(origin), film: film.recentred(origin), mean }
            }
        }
    }
}

impl From<Texture> for Metallic {
    fn from(color: Texture) -> Metallic {
        Metallic::Color(color)
    }
}

/// Converts constant η and k.
impl From<(Rgb, Rgb)> for Metallic {
    fn from((eta, k): (Rgb, Rgb)) -> Metallic {
        let reflectance = Reflectance::of_index(eta, k);
        Metallic::Index { reflectance, mean: reflectance.mean() }
    }
}

/// Converts textures of η and k; constant ones give a constant index.
impl From<(Texture, Texture)> for Metallic {
    fn from(index: (Texture, Texture)) -> Metallic {
        match index {
            (Texture::Constant(eta), Texture::Constant(k)) => (eta, k).into(),
            (eta, k) => Metallic::Indices { eta, k },
        }
    }
}
