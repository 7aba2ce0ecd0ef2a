//! Facets between two clear media: the directions that they reflect and refract light to, whatever their reflectance.

use glam::Vec2;

use super::microfacet::{Microfacets, upward, upward_normal};
use crate::math::Local;

/// A rough interface between two clear media.
#[derive(Clone, Copy)]
pub(super) struct RoughInterface<'a> {
    /// η, the index of refraction inside over outside.
    pub eta: f32,
    /// The distribution of the facets' normals.
    pub facets: &'a Microfacets,
}

/// How a facet connects two directions.
pub(super) struct Connection {
    /// The cosine by which to look up the reflectance; the same if the directions are exchanged. For refraction it is that of the direction in
    /// the medium of lower index, for reflection that of either direction. It is negative if the direction is inside.
    pub cos: f32,
    /// The density of `wi` from visible normals, without the probability of the facet to reflect or refract: D(h) G₁/|cos θo| |dh/dwi| |wo·h|.
    pub pdf: f32,
    /// G₂/G₁, the share of the light from a visible facet that is not masked on its way out.
    pub unmasked: f32,
}

impl RoughInterface<'_> {
    /// How a facet sends light from `wi` to `wo`; `None` if none does.
    pub fn connection(self, wo: Local, wi: Local) -> Option<Connection> {
        if wo.same_side(wi) { self.reflection(wo, wi) } else { self.refraction(wo, wi) }
    }

    fn reflection(self, wo: Local, wi: Local) -> Option<Connection> {
        let (h, length) = upward_normal(wo.0 + wi.0)?;
        let cos = (0.5 * length).min(1.0).copysign(wo.cos());
        // dh/dwi = 1/(4 wi·h), and |wo·h| = |wi·h|.
        Some(self.at(wo, wi, h, cos, 0.25))
    }

    fn refraction(self, wo: Local, wi: Local) -> Option<Connection> {
        // The order is by side and not by wo and wi, so that both directions of the light give the same numbers.
        let (outside, inside) = if wo.cos() > 0.0 { (wo, wi) } else { (wi, wo) };
        let (h, length) = upward_normal(outside.0 + inside.0 * self.eta)?;
        let (cos_outside, cos_inside) = (outside.0.dot(h.0), inside.0.dot(h.0));
        if cos_outside <= 0.0 || cos_inside >= 0.0 {
            return None;
        }
        // Fresnel's equations are less steep from the rarer side.
        let cos = if self.eta > 1.0 { cos_outside } else { cos_inside };
        // n² |wi·h| / (wo·h + n wi·h)², with n the index on the side of wi; the sum is the length of the vector along h.
        let index = if wi.cos() < 0.0 { self.eta } else { 1.0 };
        Some(self.at(wo, wi, h, cos, -cos_outside * cos_inside * (index / length) * (index / length)))
    }

    /// - `jacobian`: the factor of D(h) in the density of `wi`, without G₁/|cos θo|
    fn at(self, wo: Local, wi: Local, h: Local, cos: f32, jacobian: f32) -> Connection {
        let (o, across) = (wo.abs_cos(), self.facets.projected_area(upward(wo)));
        // G₁/|cos θo| = 2/(|cos θo| + S)
        let pdf = 2.0 / (o + across) * self.facets.density(h) * jacobian;
        Connection { cos, pdf, unmasked: unmasked(self.facets, wo, wi) }
    }

    /// Samples a visible facet: its normal, on the side of `wo`, and the cosine between the two, below 0 for light from inside.
    pub fn visible(self, wo: Local, u: Vec2) -> (Local, f32) {
        let seen = self.facets.sample_visible(upward(wo), u);
        let h = Local(seen.0.with_z(seen.cos() * 1f32.copysign(wo.cos())));
        (h, wo.0.dot(h.0) * 1f32.copysign(wo.cos()))
    }

    /// The direction in which a facet reflects; `None` where it leads to the other side of the surface.
    pub fn reflected(self, wo: Local, h: Local) -> Option<Local> {
        Some(Local((2.0 * wo.0.dot(h.0) * h.0 - wo.0).normalize())).filter(|wi| wo.same_side(*wi))
    }

    /// The direction in which a facet refracts; `None` under total reflection, and where it leads to the same side of the surface.
    pub fn refracted(self, wo: Local, h: Local) -> Option<Local> {
        refracted(wo, h, self.eta).filter(|wi| wo.cos() * wi.cos() < 0.0)
    }

    /// The index of refraction on the other side over that on the side of `wo`.
    pub fn relative_index(self, wo: Local) -> f32 {
        if wo.cos() > 0.0 { self.eta } else { 1.0 / self.eta }
    }
}

/// G₂/G₁, the share of the light from a visible facet that is not masked on its way out.
pub(super) fn unmasked(facets: &Microfacets, wo: Local, wi: Local) -> f32 {
    let (o, i) = (wo.abs_cos(), wi.abs_cos());
    let (across_o, across_i) = (facets.projected_area(upward(wo)), facets.projected_area(upward(wi)));
    (o + across_o) / (o * (across_i / i) + across_o)
}

/// The direction of `wo` refracted at a facet; `None` under total reflection.
pub(super) fn refracted(wo: Local, h: Local, eta: f32) -> Option<Local> {
    let cos = wo.0.dot(h.0);
    let n = if wo.cos() < 0.0 { 1.0 / eta } else { eta };
    // sin² from the part along the facet: 1 − cos² would cancel for small angles.
    let across = (wo.0 - cos * h.0) / n;
    let sin2 = across.length_squared();
    (sin2 < 1.0).then(|| Local((-across - h.0 * (1.0 - sin2).sqrt().copysign(cos)).normalize()))
}
