//! Smooth glass, water or diamond, and the material `dielectric`.

use glam::{DVec3, Vec2};

use super::description::{Description, Prepare, given};
use super::dispersion::{Dispersion, MOST_TERMS};
use super::microfacet::{Roughness, RoughnessKeys, Scale, TableRange, roughness_keys};
use super::{
    Bsdf, BsdfSample, FilmLayer, FilmedDielectric, HitContext, Lobe, Lookup, Material, Passage, RoughDielectric, ScatteringModel,
    TexturedModel, TransportMode, clear_film, rough_dielectric,
};
use crate::effects::Effects;
use crate::format::{Index, Textured, Varying};
use crate::math::{Density, Local, Rgb, Spectrum, float, fresnel};
use crate::texture::{Number, Texture};

/// A smooth interface between two clear media.
///
/// f(wo, wi) = F δ(wi − reflect(wo)) / |cos θi|  +  (1 − F) s δ(wi − refract(wo)) / |cos θi|
///
/// with Fresnel's reflectance F(cos θo; η). The factor s is (ηo/ηi)² for radiance, because refraction changes the solid angle of the
/// light, and 1 for importance.
///
/// - `eta`: index of refraction inside (below the surface) over outside (where the normal points)
/// - for η = 1 light goes straight on, as without a surface
/// - sampling: reflection with probability F, otherwise refraction, so that weight = colour (· s)
///
/// Source: Walter et al., *Microfacet Models for Refraction* (2007), §2; Veach, thesis (1997), §5.2.
/// Tests: row O1 of `pt torture`, magnification, row O15 of `pt torture`, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// η, the index of refraction inside over outside.
    pub eta: f32,
    /// The factor of all reflected and transmitted light: [0, 1]. Physical glass has 1.
    pub color: Spectrum,
}

impl ScatteringModel for Dielectric {
    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, _u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.cos() == 0.0 || self.color.is_black() {
            return None;
        }
        if choice < fresnel::dielectric(wo.cos(), self.eta) { Some(self.reflect(wo, 1.0)) } else { self.transmit(wo, 1.0, mode) }
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        if wo.cos() == 0.0 || self.color.is_black() {
            return [None, None];
        }
        let reflectance = fresnel::dielectric(wo.cos(), self.eta);
        let reflected = (reflectance > 0.0).then(|| self.reflect(wo, reflectance));
        let transmitted = if reflectance < 1.0 { self.transmit(wo, 1.0 - reflectance, mode) } else { None };
        [reflected, transmitted]
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

impl Dielectric {
    fn reflect(&self, wo: Local, share: f32) -> BsdfSample {
        BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color * share)
    }

    /// Returns the transmitted direction, or `None` under total reflection.
    fn transmit(&self, wo: Local, share: f32, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(fresnel::refract(wo.0, self.eta)?);
        let eta = if wo.cos() > 0.0 { self.eta } else { 1.0 / self.eta };
        let spread = match mode {
            TransportMode::Radiance => 1.0 / (eta * eta),
            TransportMode::Importance => 1.0,
        };
        let weight = self.color * (share * spread);
        Some(BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Transmission, eta })
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::conductor::described::SurfaceFilm;
    use crate::bsdf::dispersion::Dispersion;
    pub use crate::bsdf::glass::Glass;
    use crate::bsdf::microfacet::{AlphaKey, Distribution};
    use crate::format::{Color, Fraction, Index, Positive, Real, Textured, Varying};

    /// The surface of a body of glass, water, …, clear or frosted, with its normals outwards. It reflects and refracts.
    ///
    /// The body must be closed. Light that enters or leaves it without crossing its surface, through an open side of the mesh or
    /// behind a single sheet, is wrong by the square of `eta`; `pt check` and every render name such shapes. Use `thin_dielectric` for a
    /// pane that is one sheet. Water in an opaque basin counts as closed.
    ///
    /// Where two faces coincide (a glass box on a glass box), rays hit only the one that is listed first, and the other body seems to
    /// have no surface there, which is wrong. Describe glued bodies as one mesh without the faces between them. Describe two touching
    /// media (water in a glass) by one face with the ratio of the two indices as `eta`. Leave a gap of a hundred-thousandth of the
    /// scene's size between bodies that only stand on each other.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Dielectric {
        /// The index of refraction inside (the side the normal points away from) divided by that outside.
        ///
        /// If the index varies over the surface, light that enters with one index and leaves with another is brighter or darker by the
        /// square of their ratio. Default: 1.5.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub eta: Option<Varying<Index>>,
        /// The Abbe number V of glass with dispersion, which bends blue light more than red: (eta − 1)/V is the difference between the indices
        /// at 486 and 656 nm. Common glass has 64, flint glass 25 to 40. `eta` is then the index at 588 nm, and the index at the
        /// wavelength λ is A + B/λ².
        ///
        /// A path that meets such glass goes on with light of one wavelength, so that pictures of it have coloured noise, also in its
        /// reflections. In the mean all colours that dispersion does not change are as without it.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub abbe: Option<Positive>,
        /// A clear material with a published index of refraction at each wavelength, in place of `eta`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub glass: Option<Glass>,
        /// A and B (µm²) of Cauchy's formula for the index at the wavelength λ (µm), A + B/λ², in place of `eta`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub cauchy: Option<[Real; 2]>,
        /// B and C (µm²) of each term of Sellmeier's formula for the index at the wavelength λ (µm), n² = 1 + Σ B λ²/(λ² − C), in place of
        /// `eta`: from 1 to 6 pairs.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub sellmeier: Option<Vec<[Real; 2]>>,
        /// A factor of all light that the surface reflects or transmits, at every hit.
        pub color: Textured,
        /// The roughness: 0 is clear, 1 frosted. The width of highlights, alpha, is its square, so that equal steps look equal. Values
        /// below 0.001 count as smooth. A colour counts by its mean.
        pub roughness: Textured,
        /// The anisotropy: 0 gives round highlights, 1 highlights ten times as long as wide, along the first texture coordinate. A colour
        /// counts by its mean.
        pub anisotropy: Textured,
        /// The width of highlights itself, in place of `roughness` and `anisotropy`; `[along u, along v]` for different widths.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub alpha: Option<AlphaKey>,
        /// The distribution of the facets' normals on a rough surface.
        pub distribution: Distribution,
        /// Whether light that hits more than one facet is included. Without it frosted glass is too dark, mostly from inside. The cost is
        /// tables for each glass and a fifth of the time of a scattering event. A table takes 70 ms once with GGX, five times that with
        /// Beckmann, fifteen to thirty times that where the roughness is a texture or anisotropic, and a hundred times that where the
        /// anisotropy is a texture or both hold. A varying `eta` and dispersion need several tables: 5 from 1.3 to 1.6, 15 from 1 to 1.6.
        pub multiscatter: bool,
        /// The absorption of light inside the body. It is exact for a closed body with nothing in it, also for a camera inside: the distance
        /// between consecutive hits counts where the second is on the inner side of this surface. Light on its way to an object inside
        /// the body is therefore not attenuated, and an open surface attenuates all light that reaches it from behind. A render and
        /// `pt check` name bodies with something in them; a `medium` of the shape in place of the absorption is exact there, and slower.
        /// It takes no textures, because it belongs to the body and not to its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub absorption: Option<Absorption>,
        /// A thin clear film on the surface, which gives reflections the colours of interference: a coated lens, oil on glass. It needs an index
        /// of at least 1; where the index is 1, the surface counts as smooth whatever its roughness. Rough glass under a film is a little too
        /// dark: light that hits more than one facet is lost, whatever `multiscatter` says.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub film: Option<SurfaceFilm>,
    }

    /// The absorption of a body by the Beer–Lambert law: the transmittance over a length is color^(length / distance).
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Absorption {
        /// The transmittance over `distance`: the share of light that is left.
        pub color: Color<Fraction>,
        /// The length inside the body over which `color` is left (m).
        pub distance: Positive,
    }

    impl Dielectric {
        /// The index of refraction where it does not depend on the wavelength, or that at 588 nm.
        pub fn index(&self) -> Varying<Index> {
            self.eta.clone().unwrap_or(Varying::Same(Index::known(1.5)))
        }

        /// The least index of refraction for any wavelength and place.
        pub(super) fn least_index(&self) -> f64 {
            match (self.dispersion(), self.index()) {
                (Some(dispersion), _) => dispersion.range().map_or(0.0, |[a, b]| a.min(b)),
                (None, Varying::Same(index)) => index.get(),
                (None, Varying::Between(between)) => between.from.get().min(between.to.get()),
            }
        }

        /// The formula of the index of refraction, where it depends on the wavelength.
        pub fn dispersion(&self) -> Option<Dispersion> {
            let pair = |pair: &[Real; 2]| pair.map(Real::get);
            match (self.glass, &self.cauchy, &self.sellmeier, self.abbe, self.index()) {
                (Some(glass), ..) => Some(glass.dispersion()),
                (_, Some(cauchy), ..) => {
                    let [a, b] = pair(cauchy);
                    Some(Dispersion::Cauchy { a, b })
                }
                (_, _, Some(terms), ..) => Some(Dispersion::sellmeier(terms.iter().map(pair))),
                (.., Some(abbe), Varying::Same(index)) => Some(Dispersion::of_abbe_number(index.get(), abbe.get())),
                _ => None,
            }
        }
    }

    impl Default for Dielectric {
        fn default() -> Dielectric {
            Dielectric {
                eta: None,
                abbe: None,
                glass: None,
                cauchy: None,
                sellmeier: None,
                color: Textured::white(),
                roughness: Textured::black(),
                anisotropy: Textured::black(),
                alpha: None,
                distribution: Distribution::Ggx,
                multiscatter: true,
                absorption: None,
                film: None,
            }
        }
    }
}

impl Description for described::Dielectric {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let film = self.film.as_ref().and_then(|film| film.thickness.by());
        let own = [("eta/by", self.eta.as_ref().and_then(Varying::by)), ("color", Some(&self.color)), ("film/thickness/by", film)];
        own.into_iter().filter_map(given).chain(roughness_keys!(self).textures()).collect()
    }

    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        Some(roughness_keys!(self))
    }

    /// The index of refraction comes from one source only, and is a number in the range of `eta` for all visible light.
    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        let given = [
            ("/eta", self.eta.is_some()),
            ("/glass", self.glass.is_some()),
            ("/cauchy", self.cauchy.is_some()),
            ("/sellmeier", self.sellmeier.is_some()),
        ];
        let mut given = given.into_iter().filter(|(_, is_given)| *is_given).map(|(key, _)| key);
        let (first, second) = (given.next(), given.next());
        if let Some(second) = second {
            return vec![(second, "give one of eta, glass, cauchy and sellmeier")];
        }
        if self.abbe.is_some() && first.is_some_and(|key| key != "/eta") {
            return vec![("/abbe", "an Abbe number belongs to eta: the other formulas of the index have a dispersion of their own")];
        }
        if self.abbe.is_some() && matches!(self.eta, Some(Varying::Between(_))) {
            return vec![("/abbe", "an Abbe number needs an eta that is one number")];
        }
        if self.sellmeier.as_ref().is_some_and(|terms| !(1..=MOST_TERMS).contains(&terms.len())) {
            return vec![("/sellmeier", "expected from 1 to 6 pairs [B, C]")];
        }
        let key = if self.abbe.is_some() { "/abbe" } else { first.unwrap_or_default() };
        let in_range = |range: [f64; 2]| range.iter().all(|index| Index::RANGE.contains(*index));
        match self.dispersion() {
            Some(dispersion) if !dispersion.range().is_some_and(in_range) => {
                vec![(key, "the index of refraction leaves the range from 0.01 to 100 between 380 and 700 nm")]
            }
            _ if self.film.is_some() && self.least_index() < 1.0 => {
                vec![(
                    "/film",
                    "a film needs an index of refraction of at least 1 everywhere; for a body of lower index turn its normals round and give 1/eta",
                )]
            }
            _ => vec![],
        }
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (eta, color) = (builder.number("eta", &self.index()), builder.texture("color", &self.color));
        let (roughness, dispersion) = (roughness_keys!(self).prepare(builder), self.dispersion());
        let range = dispersion.as_ref().map_or(eta.range(), Dispersion::tabulated);
        let surface = textured::Dielectric::of_range(range, eta, color, roughness, self.multiscatter && self.film.is_none());
        let surface = match &self.film {
            None => surface,
            Some(film) => {
                let thickness = builder.number("film/thickness", &film.thickness);
                surface.under_film(FilmLayer { eta: film.eta.get() as f32, thickness })
            }
        };
        let surface = match &self.absorption {
            None => surface,
            Some(absorption) => {
                let left = Rgb::from_f64(absorption.color.linear());
                surface.absorbing(left.map(|left| -float::ln(left) / absorption.distance.get() as f32))
            }
        };
        match dispersion {
            None => surface.into(),
            Some(dispersion) => Material::dispersive(surface, dispersion),
        }
    }
}

/// The model with its textures.
pub mod textured {
    use super::{FilmLayer, Number, Rgb, Roughness, TableRange, Texture, rough_dielectric};

    /// Glass with textures for parameters: smooth, rough, or varying between the two.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Dielectric {
        pub(super) eta: Number,
        pub(super) color: Texture,
        pub(super) roughness: Option<Roughness>,
        /// The tables for light that hits more than one facet.
        pub(super) losses: Option<TableRange<rough_dielectric::Losses>>,
        /// σ, the absorption coefficient of the body behind the surface (1/m): the transmittance over the distance d is e^(−σ d).
        pub(super) absorption: Option<Rgb>,
        /// The thin film on the surface.
        pub(super) film: Option<FilmLayer>,
    }
}

impl textured::Dielectric {
    /// Clear glass with the index of refraction `eta`, inside over outside.
    pub fn smooth(eta: impl Into<Number>, color: impl Into<Texture>) -> textured::Dielectric {
        textured::Dielectric::new(eta, color, None, false)
    }

    /// Glass, smooth or rough.
    ///
    /// - `roughness`: the roughness; `None` for smooth glass
    /// - `multiscatter`: whether to include light that hits more than one facet
    pub fn new(
        eta: impl Into<Number>,
        color: impl Into<Texture>,
        roughness: Option<Roughness>,
        multiscatter: bool,
    ) -> textured::Dielectric {
        let eta = eta.into();
        textured::Dielectric::of_range(eta.range(), eta, color, roughness, multiscatter)
    }

    /// Glass with tables for all indices of refraction of a range.
    fn of_range(
        range: [f32; 2],
        eta: Number,
        color: impl Into<Texture>,
        roughness: Option<Roughness>,
        multiscatter: bool,
    ) -> textured::Dielectric {
        let rough = roughness.as_ref().filter(|_| multiscatter);
        textured::Dielectric {
            losses: rough.map(|roughness| tables(range, roughness)),
            color: color.into(),
            roughness,
            absorption: None,
            film: None,
            eta,
        }
    }

    /// The glass with tables for all indices of refraction of a range. Tables that it has already are not computed again.
    pub(super) fn for_indices(self, range: [f32; 2]) -> textured::Dielectric {
        let losses = self.losses.as_ref().and(self.roughness.as_ref()).map(|roughness| tables(range, roughness));
        textured::Dielectric { losses, ..self }
    }

    /// Adds the absorption of the body: the transmittance over the distance d inside is e^(−σ d).
    ///
    /// - `absorption`: σ (1/m)
    pub fn absorbing(self, absorption: Rgb) -> textured::Dielectric {
        textured::Dielectric { absorption: Some(absorption), ..self }
    }

    /// The glass under a thin film. Its index of refraction is at least 1. Light that hits more than one facet is lost.
    pub fn under_film(self, film: FilmLayer) -> textured::Dielectric {
        clear_film::prepare();
        textured::Dielectric { film: Some(film), losses: None, ..self }
    }

    /// The colour of the surface times the transmittance of the path segment inside the body.
    fn color_at(&self, at: &HitContext) -> Spectrum {
        let color = Spectrum::from_albedo(self.color.at(&at.texture));
        match self.absorption.filter(|_| at.inside > 0.0) {
            None => color,
            Some(absorption) => color * Spectrum::from_coefficients(absorption).map(|sigma| float::exp(-sigma * at.inside)),
        }
    }
}

/// The tables for light that hits more than one facet.
///
/// - `range`: the least and the greatest index of refraction
fn tables(range: [f32; 2], roughness: &Roughness) -> TableRange<rough_dielectric::Losses> {
    TableRange::new(range, Scale::Index, |eta| rough_dielectric::losses(eta, roughness.domain(), roughness.distribution))
}

impl textured::Dielectric {
    /// The model at a hit, with the index of refraction `eta`.
    pub(super) fn with_index(&self, at: &HitContext, eta: f32) -> Bsdf<'static> {
        let color = self.color_at(at);
        let facets = self.roughness.as_ref().and_then(|roughness| roughness.at(&at.texture));
        let facets = facets.filter(|facets| RoughDielectric::is_rough(eta, facets.alpha));
        if let Some(film) = &self.film {
            let thickness = film.thickness.at(&at.texture);
            return Bsdf::FilmedDielectric(FilmedDielectric { eta, color, film_eta: film.eta, thickness, facets });
        }
        let Some(facets) = facets else { return Bsdf::Dielectric(Dielectric { eta, color }) };
        let losses = self.losses.as_ref().map(|losses| losses.at(eta));
        let more = losses.and_then(|losses| rough_dielectric::MultiScatter::new(losses, facets.alpha, eta));
        Bsdf::RoughDielectric(RoughDielectric { eta, color, facets, more })
    }
}

impl Lookup for textured::Dielectric {
    type Model = Bsdf<'static>;

    fn at(&self, at: &HitContext) -> Bsdf<'static> {
        self.with_index(at, self.eta.at(&at.texture))
    }

    fn textures(&self) -> Vec<&Texture> {
        let film = self.film.iter().filter_map(|film| film.thickness.texture());
        self.roughness.iter().flat_map(Roughness::textures).chain(self.eta.texture()).chain([&self.color]).chain(film).collect()
    }

    fn recentred(self, origin: DVec3) -> textured::Dielectric {
        let roughness = self.roughness.map(|roughness| roughness.recentred(origin));
        let film = self.film.map(|film| film.recentred(origin));
        textured::Dielectric { eta: self.eta.recentred(origin), color: self.color.recentred(origin), roughness, film, ..self }
    }
}

impl TexturedModel for textured::Dielectric {
    fn effects(&self) -> Effects {
        let smooth = Effects::REFRACTION | Effects::SPECULAR_REFLECTION;
        let film = if self.film.is_some() { Effects::THIN_FILM } else { Effects::NONE };
        film | self.roughness.as_ref().map_or(smooth, |roughness| roughness.effects(smooth))
    }

    fn passage(&self) -> Passage {
        Passage::Body
    }

    fn absorption(&self) -> Option<Rgb> {
        self.absorption
    }

    fn is_anisotropic(&self) -> bool {
        self.roughness.as_ref().is_some_and(Roughness::is_anisotropic)
    }

    /// Whether the model is the same at every hit. With absorption it depends on the path inside the body.
    fn is_uniform(&self) -> bool {
        self.absorption.is_none() && self.textures().into_iter().all(Texture::is_constant)
    }
}
