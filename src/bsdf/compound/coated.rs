//! A clear coat over any material: varnish, glaze, lacquer.

use glam::{DVec3, Vec2};

use super::layer_stack::{Cover, NODES, nodes};
use super::{Compound, LayerStack, Scatter, choose};
use crate::bsdf::clear_film;
use crate::bsdf::description::{Description, MaterialRef, Prepare, given};
use crate::bsdf::microfacet::energy_loss::{Domain, Key};
use crate::bsdf::microfacet::{
    Distribution, EnergyLossTable, HalfVectorTerms, LerpedTable, Microfacets, Roughness, RoughnessKeys, Scale, TableRange, above,
    cos_to_half, roughness_keys, upward,
};
use crate::bsdf::table_cache::TableCache;
use crate::bsdf::{Bsdf, BsdfSample, ClearFilm, DeltaLobes, Diffuse, FilmLayer, HitContext, Lobe, Material, OrenNayar, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, float, fresnel};
use crate::texture::{Number, Texture, TextureContext};

/// A material with a clear coat, on both sides of the surface.
///
/// f = f_coat + T(wo, wi) c · f_base
///
/// f_coat is the reflection at the coat's facets, with the albedo E(w). T is the transmittance of the coat on the way in and out, see
/// `LayerStack`, with p = 1 − E:
///
/// T = 1 − max(E(wo), E(wi))                          for a base in general,
///
/// T = (1 − E(wo)) (1 − E(wi)) / (1 − Ē)              for a Lambertian base, also under layers of its own
///
/// The coat reflects the share K = 1 − (1 − Ē)/η² of the light from a Lambertian base back to it, which makes colours deeper: T has the
/// further factor (1 − K)/(1 − ρ · color · K), unless the base keeps its colour ([`Coat::keep_base_color`]). The same factor is used for an
/// Oren–Nayar base. For other bases this reflection is neglected.
///
/// No light is lost over white matte bases and mirrors. Some is lost over wide lobes that are not matte: up to 5 % over an Oren–Nayar
/// base, 6 % over rough metal, and 0.7 % for plastic under another coat, because of its own highlight.
///
/// c is the absorption inside the coat on the way down and up: c(wo, wi) = color^((1/cos θ'o + 1/cos θ'i)/2).
///
/// Under a thin film the coat reflects the film's colours, but the base gets only what is left of the greatest reflectance that a film of
/// any thickness has: E is its albedo, the same for all colours. What the film reflects less than that is lost.
///
/// - sampling: the coat or the base in proportion to the light from wo that each returns
///
/// Source: Wolff (1994) and Kelemen and Szirmay-Kalos (2001) for T over a matte base; Estevez and Kulla, *Production Friendly
/// Microfacet Sheen* (2017), §5, for T in general. Tests: coated_white_is_white_along_the_surface,
/// layers_on_white_are_white, a_coat_over_matte_is_plastic, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Coated {
    /// The material under the coat.
    pub base: Material,
    /// The coat.
    pub coat: Coat,
}

/// A clear layer without thickness.
#[derive(Clone, Debug, PartialEq)]
pub struct Coat {
    /// η, the index of refraction over that outside: at least 1.
    eta: Number,
    /// The transmittance of the coat straight down and up: [0, 1].
    color: Texture,
    /// The roughness with its tables of [`losses`]; `None` for a smooth coat.
    roughness: Option<(Roughness, TableRange<EnergyLossTable>)>,
    /// The thin film on the coat.
    film: Option<FilmLayer>,
    /// 1 − F̄ of a smooth coat, if `eta` is constant.
    smooth_mean: Option<f32>,
    /// Whether a matte base keeps its own colour, without the deepening by light that the coat reflects back.
    keep_base_color: bool,
    /// 1 − E at the nodes of the quadrature over layers, if the coat is uniform.
    passed_at_nodes: Option<[f32; NODES]>,
}

/// A coat at a hit.
struct Layer<'a> {
    surface: Surface,
    /// The thickness of the film (nm).
    thickness: f32,
    color: Spectrum,
    facets: Option<(Microfacets, LerpedTable<EnergyLossTable>)>,
    /// 1 − Ē
    mean: f32,
    keep_base_color: bool,
    passed_at_nodes: Option<&'a [f32; NODES]>,
}

impl Coat {
    /// A clear coat.
    ///
    /// - `eta`: index of refraction over that outside, at least 1
    /// - `color`: transmittance straight down and up
    /// - `roughness`: the roughness; `None` for a smooth coat
    pub fn new(eta: impl Into<Number>, color: impl Into<Texture>, roughness: Option<Roughness>) -> Coat {
        Coat::under_film(eta, color, roughness, None)
    }

    /// A clear coat with a thin film on it, if there is one; the other parameters are those of [`Coat::new`].
    pub fn under_film(eta: impl Into<Number>, color: impl Into<Texture>, roughness: Option<Roughness>, film: Option<FilmLayer>) -> Coat {
        let (eta, film_eta) = (eta.into(), film.as_ref().map(|film| film.eta));
        if film.is_some() {
            clear_film::prepare();
        }
        let surface = |eta| Surface { eta, film: film_eta };
        let tables = |roughness: Roughness| {
            let losses = TableRange::new(eta.range(), Scale::Index, |eta| losses(surface(eta), roughness.domain(), roughness.distribution));
            (roughness, losses)
        };
        let roughness = roughness.map(tables);
        let smooth_mean = eta.constant().map(|eta| surface(eta).passed_mean());
        let coat = Coat { eta, color: color.into(), roughness, film, smooth_mean, keep_base_color: false, passed_at_nodes: None };
        Coat { passed_at_nodes: coat.is_uniform().then(|| coat.at(&HitContext::ANYWHERE.texture).passed_at_nodes()), ..coat }
    }

    /// Whether the reflectance of the coat is the same everywhere.
    fn is_uniform(&self) -> bool {
        let mut widths = self.roughness.iter().flat_map(|(roughness, _)| roughness.textures());
        self.eta.constant().is_some() && widths.all(Texture::is_constant)
    }

    /// Lets a matte base keep its own colour. Otherwise a coat makes colours deeper.
    pub fn keep_base_color(self) -> Coat {
        Coat { keep_base_color: true, ..self }
    }

    fn at(&self, at: &TextureContext) -> Layer<'_> {
        let eta = self.eta.at(at);
        let (film, thickness) = self.film.as_ref().map_or((None, 0.0), |film| (Some(film.eta), film.thickness.at(at)));
        let surface = Surface { eta, film };
        let facets = self.roughness.as_ref().and_then(|(roughness, losses)| Some((roughness.at(at)?, losses.at(eta))));
        let smooth_mean = self.smooth_mean.unwrap_or_else(|| surface.passed_mean());
        let mean =
            facets.map_or(smooth_mean, |(facets, losses)| 2.0 * losses.value(|table| table.mean_loss(facets.alpha)) + smooth_mean - 1.0);
        Layer {
            surface,
            thickness,
            color: Spectrum::from_albedo(self.color.at(at)),
            facets,
            mean,
            keep_base_color: self.keep_base_color,
            passed_at_nodes: self.passed_at_nodes.as_ref(),
        }
    }

    fn textures(&self) -> impl Iterator<Item = &Texture> {
        let roughness = self.roughness.iter().flat_map(|(roughness, _)| roughness.textures());
        let film = self.film.iter().filter_map(|film| film.thickness.texture());
        roughness.chain(self.eta.texture()).chain([&self.color]).chain(film)
    }

    fn recentred(self, origin: DVec3) -> Coat {
        let roughness = self.roughness.map(|(roughness, losses)| (roughness.recentred(origin), losses));
        let film = self.film.map(|film| film.recentred(origin));
        Coat { eta: self.eta.recentred(origin), color: self.color.recentred(origin), roughness, film, ..self }
    }
}

/// The surface of a coat, as far as it decides how much light passes.
#[derive(Clone, Copy)]
struct Surface {
    /// The index of refraction of the coat.
    eta: f32,
    /// That of the film on it.
    film: Option<f32>,
}

impl Surface {
    /// F, the reflectance of a smooth coat; under a film the greatest for any thickness.
    fn reflectance(self, cos: f32) -> f32 {
        self.film.map_or_else(|| fresnel::dielectric(cos, self.eta), |film| ClearFilm::greatest(cos, film, self.eta))
    }

    /// 1 − F̄ of a smooth coat.
    fn passed_mean(self) -> f32 {
        const STEPS: usize = 32;
        let Some(film) = self.film else { return 1.0 - fresnel::dielectric_mean(self.eta) };
        let at = |i: usize| (i as f32 + 0.5) / STEPS as f32;
        1.0 - (0..STEPS).map(|i| ClearFilm::greatest(at(i), film, self.eta) * (2.0 * at(i) / STEPS as f32)).sum::<f32>()
    }
}

/// The table of (1 − (E − F))/2, with the reflectance F of a smooth coat. E itself may vary too fast with the angle for the table.
fn losses(surface: Surface, domain: Domain, distribution: Distribution) -> &'static EnergyLossTable {
    static CACHE: TableCache<(Key, Option<u32>), EnergyLossTable> = TableCache::new();
    CACHE.get(((distribution, domain.bits(), surface.eta.to_bits()), surface.film.map(f32::to_bits)), || {
        EnergyLossTable::tabulate(domain, distribution, |facets, wo, u| {
            let (wi, cos2) = facets.mirror_visible(wo, u);
            let rough =
                if wi.cos() > 0.0 { surface.reflectance(cos2.sqrt()) * HalfVectorTerms::new(facets, wo, wi).unmasked() } else { 0.0 };
            0.5 + 0.5 * (rough - surface.reflectance(wo.cos()))
        })
    })
}

impl Layer<'_> {
    /// The reflectance of a smooth coat for red, green and blue. Colours of a film more saturated than Rec. 709 can show may have one
    /// coefficient that is greater than the reflectance of any wavelength; it is limited to the greatest of them, so that no light is made.
    fn colored(&self, cos: f32) -> Spectrum {
        let greatest = self.surface.reflectance(cos);
        let Some(eta) = self.surface.film else { return Spectrum::gray(greatest) };
        let film = ClearFilm { eta, thickness: self.thickness, base: Spectrum::gray(self.surface.eta) };
        film.at(cos).map(|share| share.min(greatest))
    }

    /// E(w), the albedo of the coat alone.
    fn reflected(&self, w: Local) -> f32 {
        let smooth = self.surface.reflectance(w.abs_cos());
        self.facets.map_or(smooth, |(facets, losses)| {
            let loss = losses.value(|table| table.loss(w, facets.alpha));
            (1.0 + smooth - 2.0 * loss).clamp(0.0, 1.0)
        })
    }

    /// T c for a delta lobe of the base.
    fn through(&self, wo: Local, wi: Local) -> Spectrum {
        self.attenuated(wo, wi) * LayerStack::new(self, None, wo, wi).glossy()
    }

    /// (1 − K)/(1 − ρ · color · K) for a matte base; 1 for other bases, and where the base keeps its colour.
    fn deepened(&self, base: &Bsdf) -> Spectrum {
        let (Bsdf::Diffuse(Diffuse { albedo }) | Bsdf::OrenNayar(OrenNayar { albedo, .. })) = base else { return Spectrum::ONE };
        let thrown_back = 1.0 - self.mean / (self.surface.eta * self.surface.eta);
        let deepened = |rho: f32| (1.0 - thrown_back) / (1.0 - rho * thrown_back);
        if self.keep_base_color { Spectrum::ONE } else { (*albedo * self.color).map(deepened) }
    }

    /// c = color^((1/cos θ'o + 1/cos θ'i)/2), the absorption inside the coat.
    fn attenuated(&self, wo: Local, wi: Local) -> Spectrum {
        if self.color == Spectrum::ONE {
            return Spectrum::ONE;
        }
        let cos2 = |w: Local| 1.0 - (1.0 - w.0.z * w.0.z).max(0.0) / (self.surface.eta * self.surface.eta);
        let ways = 0.5 * (cos2(wo).max(MIN_COS2).sqrt().recip() + cos2(wi).max(MIN_COS2).sqrt().recip());
        self.color.map(|c| if c > 0.0 { float::powf(c, ways) } else { 0.0 })
    }

    /// f_coat·|cos θi| and the density of `wi`.
    fn reflection(&self, wo: Local, wi: Local) -> Option<(Spectrum, f32)> {
        let (facets, _) = self.facets.as_ref()?;
        let [wo, wi] = above(wo, wi)?;
        let pair = HalfVectorTerms::new(facets, wo, wi);
        Some((self.colored(cos_to_half(wo, wi)) * pair.scattered(), pair.density()))
    }

    /// The probabilities of sampling coat and base, in proportion to the light that each returns. Each is computed by itself, because 1
    /// minus the other would round to 0 for a small share.
    fn chances(&self, base: &Bsdf, wo: Local) -> [f32; 2] {
        let coat = self.reflected(wo);
        let below = match base {
            Bsdf::Diffuse(Diffuse { albedo }) => albedo.max(),
            _ => 1.0,
        };
        let base = (1.0 - coat) * below;
        let sum = coat + base;
        if sum > 0.0 { [coat / sum, base / sum] } else { [0.0, 1.0] }
    }
}

impl Cover for Layer<'_> {
    fn passed(&self, w: Local) -> f32 {
        1.0 - self.reflected(w)
    }

    fn mean(&self) -> f32 {
        self.mean
    }

    fn passed_at_nodes(&self) -> [f32; NODES] {
        self.passed_at_nodes.copied().unwrap_or_else(|| nodes().map(|w| self.passed(w)))
    }
}

/// The smallest cos² of a direction inside the coat: paths are at most 1000 times as long as the coat is thick. (For η = 1 paths along
/// the surface would be unbounded.)
const MIN_COS2: f32 = 1e-6;

impl Coated {
    fn at(&self, at: &HitContext) -> (Layer<'_>, Bsdf<'_>) {
        (self.coat.at(&at.texture), at.bsdf_of(&self.base))
    }

    pub(super) fn recentred(self, origin: DVec3) -> Coated {
        Coated { base: self.base.recentred(origin), coat: self.coat.recentred(origin) }
    }
}

impl Scatter for Coated {
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&LayerStack>) -> Spectrum {
        let (layer, base) = self.at(at);
        let below = base.beneath(Some(&LayerStack::new(&layer, above, wo, wi)), wo, wi, mode);
        let below = if below.is_black() { below } else { below * layer.deepened(&base) * layer.attenuated(wo, wi) };
        let reflected = layer.reflection(wo, wi).map_or(Spectrum::BLACK, |(f, _)| f * above.map_or(1.0, LayerStack::glossy));
        below + reflected
    }

    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf {
        let (layer, base) = self.at(at);
        let [coat, below] = layer.chances(&base, wo);
        let reflected = layer.reflection(wo, wi).map_or(0.0, |(_, pdf)| pdf);
        SolidAnglePdf::new(coat * reflected + below * base.pdf(wo, wi).get())
    }

    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (layer, base) = self.at(at);
        let [chance, below] = layer.chances(&base, wo);
        let (coat, choice) = choose(choice, chance);
        if !coat {
            let sample = base.sample(wo, choice, u, mode)?;
            return self.of_part(at, wo, sample, below, |wi| layer.through(wo, wi), mode);
        }
        let Some((facets, _)) = layer.facets else {
            let wi = Local(fresnel::reflect(wo.0));
            let reflected = BsdfSample::reflected(wi, layer.colored(wo.abs_cos()));
            return self.of_part(at, wo, reflected, chance, |_| Spectrum::ONE, mode);
        };
        let up = upward(wo);
        let (wi, _) = facets.mirror_visible(up, u);
        let wi = Local(wi.0.with_z(wi.cos() * 1f32.copysign(wo.cos())));
        let pdf = Density::Smooth(SolidAnglePdf::ZERO);
        let sample = BsdfSample { wi, weight: Spectrum::ONE, density: pdf, lobe: Lobe::Reflection, eta: 1.0 };
        self.of_part(at, wo, sample, chance, |_| Spectrum::ONE, mode).filter(|_| wo.same_side(wi))
    }

    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes {
        let (layer, base) = self.at(at);
        let mut lobes = DeltaLobes::default();
        if layer.facets.is_none() {
            lobes.add(BsdfSample::reflected(Local(fresnel::reflect(wo.0)), layer.colored(wo.abs_cos())), Spectrum::ONE);
        }
        for lobe in base.delta_lobes(wo, mode) {
            lobes.add(lobe, layer.through(wo, lobe.wi));
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &HitContext) -> bool {
        let (layer, base) = self.at(at);
        layer.facets.is_some() || base.has_smooth_lobe()
    }

    fn reciprocal(&self, at: &HitContext) -> bool {
        at.bsdf_of(&self.base).reciprocal()
    }

    fn parts(&self) -> Vec<&Material> {
        vec![&self.base]
    }

    fn textures(&self) -> Vec<&Texture> {
        self.coat.textures().collect()
    }

    fn own_effects(&self) -> Effects {
        let (film, smooth) = (self.coat.film.as_ref().map_or(Effects::NONE, |_| Effects::THIN_FILM), Effects::SPECULAR_REFLECTION);
        film | self.coat.roughness.as_ref().map_or(smooth, |(roughness, _)| roughness.effects(smooth))
    }

    fn is_anisotropic(&self) -> bool {
        self.base.is_anisotropic() || self.coat.roughness.as_ref().is_some_and(|(roughness, _)| roughness.is_anisotropic())
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;
    use crate::bsdf::microfacet::{AlphaKey, Distribution};
    use crate::format::{CoatIndex, Textured, Varying};

    /// A clear coat on any material: varnish, glaze, lacquer. No energy is lost over matte bases and mirrors, also with other coats in
    /// between. Some is lost over other materials with wide lobes: up to 5 % over white `oren_nayar`, and up to 6 % over white rough
    /// metal.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Coated {
        /// The material under the coat. Colours of a matte one look deeper, because the coat reflects light back to it.
        #[serde(rename = "ground")]
        pub base: MaterialRef,
        /// The index of refraction of the coat over that outside.
        #[serde(default = "glassy")]
        pub eta: Varying<CoatIndex>,
        /// The share of light that is left after passing straight down through the coat and up again.
        #[serde(default = "Textured::white")]
        pub color: Textured,
        /// The roughness of the coat: 0 is smooth, 1 the roughest. The width of highlights, alpha, is its square, so that equal steps look
        /// equal. Values below 0.001 count as smooth. A colour counts by its mean.
        #[serde(default = "Textured::black")]
        pub roughness: Textured,
        /// The anisotropy: 0 gives round highlights, 1 highlights ten times as long as wide, along the first texture coordinate. A colour
        /// counts by its mean.
        #[serde(default = "Textured::black")]
        pub anisotropy: Textured,
        /// The width of highlights itself, in place of `roughness` and `anisotropy`; `[along u, along v]` for different widths.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub alpha: Option<AlphaKey>,
        /// The distribution of the facets' normals on a rough surface.
        #[serde(default)]
        pub distribution: Distribution,
    }

    fn glassy() -> Varying<CoatIndex> {
        Varying::Same(CoatIndex::known(1.5))
    }
}

impl Description for described::Coated {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let own = [("eta/by", self.eta.by()), ("color", Some(&self.color))];
        own.into_iter().filter_map(given).chain(roughness_keys!(self).textures()).collect()
    }

    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![("ground", &self.base)]
    }

    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        Some(roughness_keys!(self))
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let color = builder.texture("color", &self.color);
        let coat = Coat::new(builder.number("eta", &self.eta), color, roughness_keys!(self).prepare(builder));
        Compound::Coated(Coated { base: builder.part("ground", &self.base), coat }).into()
    }
}
