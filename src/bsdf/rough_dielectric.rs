//! Rough glass: frosted glass, ice.

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;

use super::microfacet::energy_loss::{Domain, Key};
use super::microfacet::{Distribution, EnergyLossTable, LerpedTable, Microfacets, upward, upward_normal};
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
/// E' and m' are those of the other side. For light from the rarer side x is 1 − F̄, with F̄ = 2 ∫ F μ dμ. For light from the denser side
/// reciprocity gives x m / (m' n²), with x and m of the rarer side, m' of the denser one and n their ratio of indices, above 1.
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

/// G₂/G₁, the share of the light from a visible facet that is not masked on its way out.
fn unmasked(facets: &Microfacets, wo: Local, wi: Local) -> f32 {
    let (o, i) = (wo.abs_cos(), wi.abs_cos());
    let (across_o, across_i) = (facets.projected_area(upward(wo)), facets.projected_area(upward(wi)));
    (o + across_o) / (o * (across_i / i) + across_o)
}

/// The direction of `wo` refracted at a facet; `None` under total reflection.
fn refracted(wo: Local, h: Local, eta: f32) -> Option<Local> {
    let cos = wo.0.dot(h.0);
    let n = if wo.cos() < 0.0 { 1.0 / eta } else { eta };
    // sin² from the part along the facet: 1 − cos² would cancel for small angles.
    let across = (wo.0 - cos * h.0) / n;
    let sin2 = across.length_squared();
    (sin2 < 1.0).then(|| Local((-across - h.0 * (1.0 - sin2).sqrt().copysign(cos)).normalize()))
}

/// Terms of a pair of directions at a facet that are equal for light in both directions.
struct Meeting {
    /// The normal of the facet.
    h: Local,
    /// F at the facet.
    reflectance: f32,
    /// The factor of D(h) in the density of `wi` from visible normals, without G₁/|cos θo| and Fresnel's factor.
    jacobian: f32,
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
        let (lobe, eta) = if wo.same_side(wi) { (Lobe::Reflection, 1.0) } else { (Lobe::Transmission, self.relative_index(wo)) };
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
        let seen = self.facets.sample_visible(upward(wo), u);
        let h = Local(seen.0.with_z(seen.cos() * 1f32.copysign(wo.cos())));
        let cos = wo.0.dot(h.0) * 1f32.copysign(wo.cos());
        if choice < fresnel::dielectric(cos, self.eta) {
            Some(Local((2.0 * wo.0.dot(h.0) * h.0 - wo.0).normalize())).filter(|wi| wo.same_side(*wi))
        } else {
            refracted(wo, h, self.eta).filter(|wi| wo.cos() * wi.cos() < 0.0)
        }
    }

    /// f·|cos θi| without the colour, and the density of `wi`, including f₂.
    fn both(&self, wo: Local, wi: Local, mode: TransportMode) -> Option<(f32, SolidAnglePdf)> {
        if wo.cos() * wi.cos() == 0.0 {
            return None;
        }
        let reflects = wo.same_side(wi);
        let eta = self.relative_index(wo);
        let spread = if reflects || mode == TransportMode::Importance { 1.0 } else { 1.0 / (eta * eta) };
        let (once_f, once_pdf) = if reflects { self.reflection(wo, wi) } else { self.refraction(wo, wi) }.unwrap_or((0.0, 0.0));
        let (lost, through) = self.lost(wo);
        let side = if reflects { 1.0 - through } else { through };
        let pdf = (1.0 - lost) * once_pdf + lost * side * FRAC_1_PI * wi.abs_cos();
        let more = self.more.map_or(0.0, |m| {
            let far = usize::from(wi.cos() < 0.0);
            lost * side * FRAC_1_PI * wi.abs_cos() * m.loss(far, wi, self.facets.alpha) / m.mean[far]
        });
        Some((spread * (once_f + more), SolidAnglePdf::new(pdf)))
    }

    fn reflection(&self, wo: Local, wi: Local) -> Option<(f32, f32)> {
        let (h, length) = upward_normal(wo.0 + wi.0)?;
        let cos = (0.5 * length).min(1.0).copysign(wo.cos());
        // dh/dwi = 1/(4 wi·h), and |wo·h| = |wi·h|.
        Some(self.by(wo, wi, Meeting { h, reflectance: fresnel::dielectric(cos, self.eta), jacobian: 0.25 }, true))
    }

    fn refraction(&self, wo: Local, wi: Local) -> Option<(f32, f32)> {
        // The order is by side and not by wo and wi, so that both directions of the light give the same numbers.
        let (outside, inside) = if wo.cos() > 0.0 { (wo, wi) } else { (wi, wo) };
        let (h, length) = upward_normal(outside.0 + inside.0 * self.eta)?;
        let (cos_outside, cos_inside) = (outside.0.dot(h.0), inside.0.dot(h.0));
        if cos_outside <= 0.0 || cos_inside >= 0.0 {
            return None;
        }
        // Fresnel's equations from the rarer side, where they are less steep.
        let reflectance =
            if self.eta > 1.0 { fresnel::dielectric(cos_outside, self.eta) } else { fresnel::dielectric(cos_inside, self.eta) };
        // n² |wi·h| / (wo·h + n wi·h)², with n the index on the side of wi; the sum is the length of the vector along h.
        let index = if wi.cos() < 0.0 { self.eta } else { 1.0 };
        let jacobian = -cos_outside * cos_inside * (index / length) * (index / length);
        Some(self.by(wo, wi, Meeting { h, reflectance, jacobian }, false))
    }

    /// f·|cos θi| for importance and the density of `wi`, from the facets with the normal h.
    fn by(&self, wo: Local, wi: Local, at: Meeting, reflects: bool) -> (f32, f32) {
        let share = if reflects { at.reflectance } else { 1.0 - at.reflectance };
        let (o, across) = (wo.abs_cos(), self.facets.projected_area(upward(wo)));
        // G₁/|cos θo| = 2/(|cos θo| + S)
        let pdf = 2.0 / (o + across) * self.facets.density(at.h) * at.jacobian * share;
        (pdf * unmasked(&self.facets, wo, wi), pdf)
    }

    /// 1 − E(wo), and the share x of it that is transmitted.
    fn lost(&self, wo: Local) -> (f32, f32) {
        let side = usize::from(wo.cos() < 0.0);
        self.more.map_or((0.0, 0.0), |m| (m.loss(side, wo, self.facets.alpha), m.through[side]))
    }

    fn relative_index(&self, wo: Local) -> f32 {
        if wo.cos() > 0.0 { self.eta } else { 1.0 / self.eta }
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
