//! Brushed, blasted, tarnished metal.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec2;

use super::microfacet::albedo::{Domain, Key, Shelf};
use super::microfacet::{Albedo, Distribution, Microfacets, Pair, above, cos_to_half, upward};
use super::{BsdfSample, Lobe, Reflectance};
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, warp};

/// Reflection at a metal whose facets are tiny mirrors.
///
/// f(wo, wi) = F(wo·h) D(h) G₂(wo, wi) / (4 |cos θo| |cos θi|)  +  f₂(wo, wi)      [sr⁻¹],    h half way between wo and wi
///
/// with Fresnel's F, and f₂ for light that facets reflect more than once (see
/// [`albedo`](super::microfacet::albedo)), darker by
///
/// F₂ = F̄² Ē / (1 − F̄ (1 − Ē)),    F̄ = 2 ∫ F μ dμ,    Ē = 1 − m
///
/// as each further reflection costs F̄. Without f₂ rough metals are too dark: white ones of α = 1 return half of the light.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: normals in sight, so that weight = F G₂/G₁ ≤ 1; with probability 1 − E(wo) the cosine, for f₂
///
/// Source: Walter et al., *Microfacet Models for Refraction* (2007); Heitz (2014); Kulla and Conty (2017) with F₂ as given by
/// Fdez-Agüera, *A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting* (2019). Tests: tables M1–M9.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    pub reflectance: Reflectance,
    pub facets: Microfacets,
    /// Later reflections; `None` follows the first alone.
    pub more: Option<MoreReflections>,
}

/// The lobe of light that was reflected more than once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoreReflections {
    losses: &'static Albedo,
    /// F₂ / (π m)
    strength: Spectrum,
}

impl MoreReflections {
    /// - `mean_fresnel`: F̄, see [`Reflectance::mean`]
    ///
    /// `None` for facets so smooth that nothing is lost.
    pub fn new(losses: &'static Albedo, alpha: Vec2, mean_fresnel: Spectrum) -> Option<MoreReflections> {
        let lost = losses.mean_loss(alpha);
        let strength = mean_fresnel.map(|f| f * f * (1.0 - lost) / ((1.0 - f * lost) * PI * lost));
        strength.is_finite().then_some(MoreReflections { losses, strength })
    }
}

/// The table of white metal.
pub fn losses(domain: Domain, distribution: Distribution) -> &'static Albedo {
    static SHELF: Shelf<Key, Albedo> = Shelf::new();
    SHELF.get((distribution, domain.bits(), 0), || Albedo::tabulate(domain, distribution, returned))
}

/// G₂/G₁ of the mirror direction that `u` chooses; 0 where it leads into the surface.
fn returned(facets: &Microfacets, wo: Local, u: Vec2) -> f32 {
    let (wi, _) = facets.mirror_visible(wo, u);
    if wi.cos() > 0.0 { Pair::new(facets, wo, wi).unmasked() } else { 0.0 }
}

impl RoughConductor {
    pub fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        above(wo, wi).map_or(Spectrum::BLACK, |[wo, wi]| self.both(wo, wi, cos_to_half(wo, wi), self.lost(wo)).0)
    }

    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let density = |[wo, wi]: [Local; 2]| density(Pair::new(&self.facets, wo, wi), wi, self.lost(wo));
        above(wo, wi).map_or(SolidAnglePdf::ZERO, density)
    }

    pub fn sample(&self, wo: Local, choice: f32, u: Vec2) -> Option<BsdfSample> {
        let up = upward(wo);
        let lost = self.lost(up);
        let (wi, cos) = if choice < lost {
            let wi = Local(warp::cosine_hemisphere(u));
            (wi, cos_to_half(up, wi))
        } else {
            self.facets.mirror_visible(up, u)
        };
        let [up, above] = above(up, wi)?;
        let (f, pdf) = self.both(up, above, cos, lost);
        // Its inverse, while Fresnel is still at work.
        let weight = f * (1.0 / pdf.get());
        let wi = wi.on_the_side_of(wo);
        (pdf.get() > 0.0).then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    /// f·|cos θi| and the density of `wi`, for directions above the surface.
    ///
    /// - `cos`: to the normal half way between them
    /// - `lost`: see [`RoughConductor::lost`]
    #[inline(always)]
    fn both(&self, wo: Local, wi: Local, cos: f32, lost: f32) -> (Spectrum, SolidAnglePdf) {
        let pair = Pair::new(&self.facets, wo, wi);
        let once = self.reflectance.at(cos) * pair.scattered;
        let f = self.more.map_or(once, |m| once + m.strength * (lost * m.losses.loss(wi, self.facets.alpha) * wi.cos()));
        (f, density(pair, wi, lost))
    }

    /// The chance that the lobe of later reflections is sampled: 1 − E(wo).
    #[inline]
    fn lost(&self, wo: Local) -> f32 {
        self.more.map_or(0.0, |m| m.losses.loss(wo, self.facets.alpha))
    }
}

/// Of `wi`, by a facet in sight or by the lobe of later reflections.
#[inline]
fn density(pair: Pair, wi: Local, lost: f32) -> SolidAnglePdf {
    SolidAnglePdf::new((1.0 - lost) * pair.density + lost * FRAC_1_PI * wi.cos())
}
