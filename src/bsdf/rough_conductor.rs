//! Brushed, blasted, tarnished metal.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec2;

use super::microfacet::albedo::{Domain, Key, Shelf};
use super::microfacet::{Albedo, Distribution, Microfacets, Pair, half, mirrored, upward};
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
    let wi = mirrored(wo, facets.sample_visible(wo, u));
    half(wo, wi).map_or(0.0, |(h, _)| Pair::new(facets, wo, wi, h).unmasked())
}

impl RoughConductor {
    pub fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        self.both(wo, wi).map_or(Spectrum::BLACK, |(f, _)| f)
    }

    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let Some((h, _)) = half(wo, wi) else { return SolidAnglePdf::ZERO };
        self.density(wo, wi, Pair::new(&self.facets, wo, wi, h).density)
    }

    pub fn sample(&self, wo: Local, choice: f32, u: Vec2) -> Option<BsdfSample> {
        let up = upward(wo);
        let wi = if choice < self.lost(wo) { Local(warp::cosine_hemisphere(u)) } else { mirrored(up, self.facets.sample_visible(up, u)) };
        let wi = Local(wi.0.with_z(wi.cos() * 1f32.copysign(wo.cos())));
        let (f, pdf) = self.both(wo, wi).filter(|(_, pdf)| pdf.get() > 0.0)?;
        Some(BsdfSample { wi, weight: f / pdf.get(), density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    /// f·|cos θi| and the density of `wi`.
    fn both(&self, wo: Local, wi: Local) -> Option<(Spectrum, SolidAnglePdf)> {
        let (h, cos) = half(wo, wi)?;
        let pair = Pair::new(&self.facets, wo, wi, h);
        let once = self.reflectance.at(cos) * pair.scattered;
        let more = self.more.map_or(Spectrum::BLACK, |m| {
            let alpha = self.facets.alpha;
            m.strength * (m.losses.loss(wo, alpha) * m.losses.loss(wi, alpha) * wi.abs_cos())
        });
        Some((once + more, self.density(wo, wi, pair.density)))
    }

    fn density(&self, wo: Local, wi: Local, once: f32) -> SolidAnglePdf {
        let lost = self.lost(wo);
        SolidAnglePdf::new((1.0 - lost) * once + lost * FRAC_1_PI * wi.abs_cos())
    }

    /// The chance that the lobe of later reflections is sampled.
    fn lost(&self, wo: Local) -> f32 {
        self.more.map_or(0.0, |m| m.losses.loss(wo, self.facets.alpha))
    }
}
