//! Rough glass: frosted glass, ice.

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;

use super::microfacet::energy_loss::{Domain, Key};
use super::microfacet::{Distribution, EnergyLossTable, LerpedTable, Microfacets};
use super::rough_interface::{RoughInterface, refracted, unmasked};
use super::table_cache::TableCache;
use super::{BsdfSample, Lobe, ScatteringModel, TransportMode};
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, fresnel, warp};

/// A rough interface between two clear media, with facets that reflect and refract.
///
/// reflection: f = F(wo·h) D(h) G₂ / (4 |cos θo| |cos θi|),    h half way between wo and wi          [sr⁻¹]
///
/// refraction: f = s (1 − F) D(h) G₂ |wo·h| |wi·h| / (|cos θo| |cos θi| (wo·h/η' + wi·h)²),    h along ±(wo + η' wi)
///
/// with η' the index on the side of wi over that on the side of wo. |wi·h| / (wo·h/η' + wi·h)² is the Jacobian |dh/dwi|. The factor s
/// is 1/η'² for radiance, because refraction changes the solid angle of the light, and 1 for importance. f₂ is added to both for light
/// that hits more than one facet (see [`energy_loss`](super::microfacet::energy_loss)):
///
/// f₂ = (1 − x) (1 − E(wo)) (1 − E(wi)) / (π m)  back,    s x (1 − E(wo)) (1 − E'(wi)) / (π m')  through
///
/// E' and m' are those of the other side. For light from the rarer side x = min(1 − F̄, m' n² / m), with F̄ = 2 ∫ F μ dμ. For light from
/// the denser side reciprocity gives x m / (m' n²), which the minimum keeps at most 1. In both, x and m are those of the rarer side, m' is
/// that of the denser side, and n > 1 is the ratio of the indices.
///
/// - `eta`: index of refraction inside (below the surface) over outside (where the normal points)
/// - sampling: visible normals, and reflection there with probability F, so that weight = colour · G₂/G₁ (· s);
///   with probability 1 − E(wo) cosine-weighted on either side, for f₂
///
/// Source: Walter et al., *Microfacet Models for Refraction through Rough Surfaces* (2007); Kulla and Conty (2017).
/// Tests: row M5 and row M4 of `pt torture`, rough_models_are_proved, radiance_is_compressed_and_restored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    /// η, the index of refraction inside over outside.
    pub eta: f32,
    /// The factor of all reflected and transmitted light: [0, 1]. Physical glass has 1.
    pub color: Spectrum,
    /// The distribution of the facets' normals.
    pub facets: Microfacets,
    /// The lobes f₂ of further hits; `None` includes the first hit only.
    pub more: Option<MultiScatter>,
}

/// The lobes f₂ of light that hits more than one facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiScatter {
    losses: LerpedTable<Losses>,
    /// m for light from outside and from inside.
    mean: [f32; 2],
    /// x for light from outside and from inside.
    through: [f32; 2],
}

/// The tables of 1 − E for light from outside and from inside, and F̄ for light from the rarer side.
#[derive(Debug, PartialEq)]
pub struct Losses {
    sides: [EnergyLossTable; 2],
    mean_fresnel: f32,
}

/// The tables of 1 − E for clear glass.
pub fn losses(eta: f32, domain: Domain, distribution: Distribution) -> &'static Losses {
    static CACHE: TableCache<Key, Losses> = TableCache::new();
    CACHE.get((distribution, domain.bits(), eta.to_bits()), || {
        let side = |eta| EnergyLossTable::tabulate(domain, distribution, |facets, wo, u| returned(facets, eta, wo, u));
        Losses { sides: [side(eta), side(1.0 / eta)], mean_fresnel: mean_reflectance(eta.max(1.0 / eta)) }
    })
}

/// F̄ for light from the rarer side.
fn mean_reflectance(eta: f32) -> f32 {
    const STEPS: usize = 64;
    let at = |i: usize| (i as f32 + 0.5) / STEPS as f32;
    (0..STEPS).map(|i| fresnel::dielectric(at(i), eta) * (2.0 * at(i) / STEPS as f32)).sum()
}

/// The share of white light that the visible facet selected by `u` reflects and transmits without masking.
fn returned(facets: &Microfacets, eta: f32, wo: Local, u: Vec2) -> f32 {
    let h = facets.sample_visible(wo, u);
    let cos = wo.0.dot(h.0);
    let reflectance = fresnel::dielectric(cos, eta);
    let back = Local(2.0 * cos * h.0 - wo.0);
    let through = refracted(wo, h, eta).filter(|wi| wi.cos() < 0.0);
    let back = if back.cos() > 0.0 { reflectance * unmasked(facets, wo, back) } else { 0.0 };
    back + through.map_or(0.0, |wi| (1.0 - reflectance) * unmasked(facets, wo, wi))
}

impl ScatteringModel for RoughDielectric {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        self.both(wo, wi, mode).map_or(Spectrum::BLACK, |(f, _)| self.color * f)
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        self.both(wo, wi, TransportMode::Importance).map_or(SolidAnglePdf::ZERO, |(_, pdf)| pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.cos() == 0.0 || self.color.is_black() {
            return None;
        }
        let (lost, through) = self.lost(wo);
        let wi = if choice < lost {
            let side = if choice < lost * through { -wo.cos() } else { wo.cos() };
            Local(warp::cosine_hemisphere(u) * 1f32.copysign(side))
        } else {
            let choice = (choice - lost) / (1.0 - lost);
            self.at_a_facet(wo, choice, u)?
        };
        let (f, pdf) = self.both(wo, wi, mode).filter(|(_, pdf)| pdf.get() > 0.0)?;
        let (lobe, eta) =
            if wo.same_side(wi) { (Lobe::Reflection, 1.0) } else { (Lobe::Transmission, self.interface().relative_index(wo)) };
        Some(BsdfSample { wi, weight: self.color * (f / pdf.get()), density: Density::Smooth(pdf), lobe, eta })
    }
}

impl RoughDielectric {
    /// Whether the interface bends light by more than f32 directions can resolve. Otherwise it counts as smooth.
    ///
    /// Facets of slope α deflect transmitted light by about α |η − 1|.
    pub fn is_rough(eta: f32, alpha: Vec2) -> bool {
        alpha.max_element() * (eta - 1.0).abs() >= super::microfacet::MIN_ALPHA
    }

    /// Samples the reflection or refraction at a visible facet; `None` where it leads to the wrong side of the surface.
    fn at_a_facet(&self, wo: Local, choice: f32, u: Vec2) -> Option<Local> {
        let (h, cos) = self.interface().visible(wo, u);
        if choice < fresnel::dielectric(cos, self.eta) { self.interface().reflected(wo, h) } else { self.interface().refracted(wo, h) }
    }

    /// f·|cos θi| without the colour, and the density of `wi`, including f₂.
    fn both(&self, wo: Local, wi: Local, mode: TransportMode) -> Option<(f32, SolidAnglePdf)> {
        if wo.cos() * wi.cos() == 0.0 {
            return None;
        }
        let reflects = wo.same_side(wi);
        let eta = self.interface().relative_index(wo);
        let spread = if reflects || mode == TransportMode::Importance { 1.0 } else { 1.0 / (eta * eta) };
        let (once_f, once_pdf) = self.interface().connection(wo, wi).map_or((0.0, 0.0), |at| {
            let reflectance = fresnel::dielectric(at.cos, self.eta);
            let pdf = at.pdf * if reflects { reflectance } else { 1.0 - reflectance };
            (pdf * at.unmasked, pdf)
        });
        let (lost, through) = self.lost(wo);
        let side = if reflects { 1.0 - through } else { through };
        let pdf = (1.0 - lost) * once_pdf + lost * side * FRAC_1_PI * wi.abs_cos();
        let more = self.more.map_or(0.0, |m| {
            let far = usize::from(wi.cos() < 0.0);
            lost * side * FRAC_1_PI * wi.abs_cos() * m.loss(far, wi, self.facets.alpha) / m.mean[far]
        });
        Some((spread * (once_f + more), SolidAnglePdf::new(pdf)))
    }

    /// 1 − E(wo), and the share x of it that is transmitted.
    fn lost(&self, wo: Local) -> (f32, f32) {
        let side = usize::from(wo.cos() < 0.0);
        self.more.map_or((0.0, 0.0), |m| (m.loss(side, wo, self.facets.alpha), m.through[side]))
    }

    fn interface(&self) -> RoughInterface<'_> {
        RoughInterface { eta: self.eta, facets: &self.facets }
    }
}

impl MultiScatter {
    /// Returns the lobes, or `None` for facets so smooth that no light is lost.
    pub fn new(losses: LerpedTable<Losses>, alpha: Vec2, eta: f32) -> Option<MultiScatter> {
        let mean = [0, 1].map(|side: usize| losses.value(|table| table.sides[side].mean_loss(alpha)));
        let mean_fresnel = losses.value(|table| table.mean_fresnel);
        let (rare, dense, n2) = if eta > 1.0 { (0, 1, eta * eta) } else { (1, 0, 1.0 / (eta * eta)) };
        let mut through = [0.0; 2];
        through[rare] = (1.0 - mean_fresnel).min(mean[dense] * n2 / mean[rare]);
        through[dense] = through[rare] * mean[rare] / (mean[dense] * n2);
        (mean.iter().chain(&through).all(|x| x.is_finite() && *x > 0.0)).then_some(MultiScatter { losses, mean, through })
    }

    /// 1 − E(w) for light from a side: 0 is outside, 1 inside.
    fn loss(&self, side: usize, w: Local, alpha: Vec2) -> f32 {
        self.losses.value(|table| table.sides[side].loss(w, alpha))
    }
}
