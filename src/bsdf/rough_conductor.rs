//! Rough metal: brushed, sandblasted or tarnished.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec2;

use super::microfacet::energy_loss::{Domain, Key};
use super::microfacet::{Distribution, EnergyLossTable, HalfVectorTerms, Microfacets, above, cos2_to_half, upward};
use super::table_cache::TableCache;
use super::{BsdfSample, Reflectance, ScatteringModel, TransportMode};
use crate::math::{Local, SolidAnglePdf, Spectrum, warp};

/// Reflection at metal with microscopic mirrors for facets.
///
/// f(wo, wi) = F(wo·h) D(h) G₂(wo, wi) / (4 |cos θo| |cos θi|)  +  f₂(wo, wi)      [sr⁻¹],    h half way between wo and wi
///
/// with Fresnel's F, and f₂ for light that facets reflect more than once (see [`energy_loss`](super::microfacet::energy_loss)) times
///
/// F₂ = F̄² Ē / (1 − F̄ (1 − Ē)),    F̄ = 2 ∫ F μ dμ,    Ē = 1 − m
///
/// because each further reflection has the factor F̄. Without f₂ rough metals are too dark: white metal of α = 1 (GGX) returns on average
/// only about 40 % of the light.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: visible normals, so that weight = F G₂/G₁ ≤ 1; with probability 1 − E(wo) cosine-weighted, for f₂
///
/// Source: Walter et al., *Microfacet Models for Refraction* (2007); Heitz (2014); Kulla and Conty (2017) with F₂ as given by
/// Fdez-Agüera, *A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting* (2019). Tests: row M2 and
/// row M4 of `pt torture`, rough_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    /// F as a function of the angle.
    pub reflectance: Reflectance,
    /// The distribution of the facets' normals.
    pub facets: Microfacets,
    /// The lobe f₂ of further reflections; `None` includes the first reflection only.
    pub more: Option<MultiScatter>,
}

/// The lobe f₂ of light that facets reflect more than once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiScatter {
    losses: &'static EnergyLossTable,
    /// F₂ / (π m)
    strength: Spectrum,
}

impl MultiScatter {
    /// Returns the lobe, or `None` for facets so smooth that no light is lost.
    ///
    /// - `mean_fresnel`: F̄, see [`Reflectance::mean`]
    pub fn new(losses: &'static EnergyLossTable, alpha: Vec2, mean_fresnel: Spectrum) -> Option<MultiScatter> {
        let lost = losses.mean_loss(alpha);
        let strength = mean_fresnel.map(|f| f * f * (1.0 - lost) / ((1.0 - f * lost) * PI * lost));
        strength.is_finite().then_some(MultiScatter { losses, strength })
    }
}

/// The table of 1 − E for white metal.
pub fn losses(domain: Domain, distribution: Distribution) -> &'static EnergyLossTable {
    static CACHE: TableCache<Key, EnergyLossTable> = TableCache::new();
    CACHE.get((distribution, domain.bits(), 0), || EnergyLossTable::tabulate(domain, distribution, returned))
}

/// G₂/G₁ of the mirror direction that `u` selects; 0 where it leads below the surface.
fn returned(facets: &Microfacets, wo: Local, u: Vec2) -> f32 {
    let (wi, _) = facets.mirror_visible(wo, u);
    if wi.cos() > 0.0 { HalfVectorTerms::new(facets, wo, wi).unmasked() } else { 0.0 }
}

impl ScatteringModel for RoughConductor {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        above(wo, wi).map_or(Spectrum::BLACK, |[wo, wi]| {
            let once = self.reflectance.at_square(cos2_to_half(wo, wi)) * HalfVectorTerms::new(&self.facets, wo, wi).scattered();
            self.more.map_or(once, |more| once + self.further(more, wi, self.lost(wo)))
        })
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let density = |[wo, wi]: [Local; 2]| density(HalfVectorTerms::new(&self.facets, wo, wi), wi, self.lost(wo));
        above(wo, wi).map_or(SolidAnglePdf::ZERO, density)
    }

    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let up = upward(wo);
        let (wi, weight, pdf) = match self.more {
            // One copy for each distribution, so that registers of one are not reserved for the other.
            None => match self.facets.distribution {
                Distribution::Ggx => self.sample_once(Microfacets { distribution: Distribution::Ggx, ..self.facets }, up, u),
                Distribution::Beckmann => self.sample_once(Microfacets { distribution: Distribution::Beckmann, ..self.facets }, up, u),
            },
            Some(more) => self.sample_all(more, up, choice, u),
        }?;
        BsdfSample::of_lobe(wi.on_the_side_of(wo), weight, pdf)
    }
}

impl RoughConductor {
    /// Samples the reflection at a visible facet. Returns the direction, its weight F G₂/G₁ and its density. `wo` is above the surface.
    #[inline(always)]
    fn sample_once(&self, facets: Microfacets, wo: Local, u: Vec2) -> Option<(Local, Spectrum, SolidAnglePdf)> {
        let (wi, cos2) = facets.mirror_visible(wo, u);
        above(wo, wi)?;
        let pair = HalfVectorTerms::new(&facets, wo, wi);
        Some((wi, self.reflectance.at_square(cos2) * pair.unmasked(), SolidAnglePdf::new(pair.density())))
    }

    /// Samples the reflection at a visible facet or the lobe f₂. Returns the direction, and its weight and density for both together.
    fn sample_all(&self, more: MultiScatter, wo: Local, choice: f32, u: Vec2) -> Option<(Local, Spectrum, SolidAnglePdf)> {
        let lost = self.lost(wo);
        let (wi, cos2) = if choice < lost {
            let wi = Local(warp::cosine_hemisphere(u));
            (wi, cos2_to_half(wo, wi))
        } else {
            self.facets.mirror_visible(wo, u)
        };
        above(wo, wi)?;
        let pair = HalfVectorTerms::new(&self.facets, wo, wi);
        let pdf = density(pair, wi, lost);
        let f = self.reflectance.at_square(cos2) * pair.scattered() + self.further(more, wi, lost);
        Some((wi, f / pdf.get(), pdf))
    }

    /// f₂ |cos θi| [sr⁻¹].
    ///
    /// - `lost`: see [`RoughConductor::lost`]
    #[inline]
    fn further(&self, more: MultiScatter, wi: Local, lost: f32) -> Spectrum {
        more.strength * (lost * more.losses.loss(wi, self.facets.alpha) * wi.cos())
    }

    /// The probability of sampling the lobe f₂: 1 − E(wo).
    #[inline]
    fn lost(&self, wo: Local) -> f32 {
        self.more.map_or(0.0, |m| m.losses.loss(wo, self.facets.alpha))
    }
}

/// The density of `wi` from visible facets and from the lobe f₂ together.
#[inline]
fn density(pair: HalfVectorTerms, wi: Local, lost: f32) -> SolidAnglePdf {
    SolidAnglePdf::new((1.0 - lost) * pair.density() + lost * FRAC_1_PI * wi.cos())
}
