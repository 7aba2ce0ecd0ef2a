//! Microfacet theory: a rough surface as many microscopic mirrors.
//!
//! The rough models have in common the distribution of the facets' normals, their masking and shadowing, and the sampling of visible
//! normals.
//!
//! - `alpha`: the roughness along the local x and y axes; for Beckmann the root mean square slope times √2.
//!   Users set `roughness` r, and α = r²: the width of a highlight is proportional to α, and equal steps
//!   of r look equal.
//! - All directions here are in the hemisphere of the normal: z > 0.

mod beckmann;
mod ggx;

pub mod energy_loss;
pub mod keys;
pub mod roughness;
pub mod table_range;

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec2Swizzles, Vec3};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::Local;

pub use energy_loss::EnergyLossTable;
pub(super) use keys::roughness_keys;
pub use keys::{AlphaKey, RoughnessKeys, roughened};
pub use roughness::Roughness;
pub use table_range::{LerpedTable, Scale, TableRange};

/// The distribution of the facets' normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Distribution {
    /// The distribution of Trowbridge and Reitz: highlights with long tails, as measured ones have.
    #[default]
    Ggx,
    /// Gaussian slopes: highlights with short tails.
    Beckmann,
}

/// Facets of a distribution, with independent heights (Smith's model).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    /// α along x and y, each at least [`MIN_ALPHA`].
    pub alpha: Vec2,
    /// The distribution of normals.
    pub distribution: Distribution,
}

/// The smallest α. A smoother surface counts as a mirror, because the directions of f32 unit vectors are about a sixteenth of this apart.
pub const MIN_ALPHA: f32 = 1e-6;

impl Microfacets {
    /// The facets of a roughness; `None` where the surface counts as smooth.
    pub fn new(alpha: Vec2, distribution: Distribution) -> Option<Microfacets> {
        (alpha.max_element() >= MIN_ALPHA).then(|| Microfacets { alpha: alpha.max(Vec2::splat(MIN_ALPHA)), distribution })
    }

    /// D(h), the area of facets with the normal h per area of the surface and solid angle [sr⁻¹].
    ///
    /// ∫ D(h) cos θh dh = 1
    ///
    /// - `h`: a vector along the normal, of any length
    ///
    /// Tests: row M6 and row M1 of `pt torture`.
    #[inline]
    pub fn density(&self, h: Local) -> f32 {
        // sin² from the coordinates: 1 − cos² would cancel for a small alpha.
        let per_area = 1.0 / (self.alpha.x * self.alpha.y);
        // h/α with a single division, which does not depend on the direction and can start early.
        let slopes = h.0.truncate() * (self.alpha.yx() * per_area);
        let (slope2, cos2) = (slopes.length_squared(), h.cos() * h.cos());
        let length2 = h.0.length_squared();
        let profile = match self.distribution {
            Distribution::Ggx => ggx::profile(slope2, cos2, length2),
            Distribution::Beckmann => beckmann::profile(slope2, cos2, length2),
        };
        profile * (FRAC_1_PI * per_area)
    }

    /// S(w) = cos θ (1 + 2 Λ(w)), the projected area of all facets, front and back, along w per area of the surface.
    ///
    /// The part (cos θ + S)/2 of it faces w, and cos θ is visible. Smith's functions follow without a division by cos θ, and hold down to
    /// cos θ = 0, where Λ is infinite:
    ///
    /// - Λ(w) = (S/cos θ − 1)/2
    /// - G₁(w) = 1/(1 + Λ) = 2 cos θ / (cos θ + S)
    /// - G₂(a, b) = 1/(1 + Λ(a) + Λ(b)) = 2 cos a cos b / (cos a S(b) + cos b S(a)), with height-correlated masking and shadowing
    ///
    /// Source: Smith (1967); Heitz, *Understanding the Masking-Shadowing Function* (2014). Tests: row M1 of `pt torture`.
    #[inline]
    pub fn projected_area(&self, w: Local) -> f32 {
        let sine2 = (self.alpha * w.0.truncate()).length_squared();
        match self.distribution {
            Distribution::Ggx => ggx::projected_area(w.cos(), sine2),
            Distribution::Beckmann => beckmann::projected_area(w.cos(), sine2),
        }
    }

    /// Samples the normal of a facet that is visible from `wo`, with density G₁(wo) |wo·h| D(h) / cos θo.
    ///
    /// It is sampled in the space where the surface is stretched to roughness 1, in which directions are w ∝ (αx x, αy y, z). Normals
    /// transform back by the same factors.
    pub fn sample_visible(&self, wo: Local, u: Vec2) -> Local {
        Local(self.along_visible(wo, u).normalize())
    }

    /// A vector of any length along a visible normal, see [`Microfacets::sample_visible`].
    #[inline(always)]
    fn along_visible(&self, wo: Local, u: Vec2) -> Vec3 {
        let stretched = wo.0 * self.alpha.extend(1.0);
        let normal = match self.distribution {
            Distribution::Ggx => ggx::sample_visible(stretched, u),
            Distribution::Beckmann => beckmann::sample_visible(stretched.normalize(), u),
        };
        normal * self.alpha.extend(1.0)
    }

    /// Reflects `wo` at a sampled visible facet. Returns the direction, and the square of its cosine to the facet's normal.
    #[inline(always)]
    pub(super) fn mirror_visible(&self, wo: Local, u: Vec2) -> (Local, f32) {
        let along = self.along_visible(wo, u);
        let cos = wo.0.dot(along);
        let part = cos / along.length_squared();
        let w = along * (2.0 * part) - wo.0;
        // The length is so close to 1 that a step of Newton's method for 1/√x is as precise as a root and a division.
        (Local(w * (1.5 - 0.5 * w.length_squared())), cos * part)
    }
}

/// The terms of microfacet reflection for two directions above the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfVectorTerms {
    /// D/2 of the half vector [sr⁻¹].
    half_density: f32,
    /// cos θo + S(wo) = 2 cos θo / G₁
    one_way: f32,
    /// cos θo S(wi)/cos θi + S(wo) = 2 cos θo / G₂
    both_ways: f32,
}

impl HalfVectorTerms {
    #[inline(always)]
    pub fn new(facets: &Microfacets, wo: Local, wi: Local) -> HalfVectorTerms {
        let (o, i, across_o, across_i) = (wo.cos(), wi.cos(), facets.projected_area(wo), facets.projected_area(wi));
        HalfVectorTerms {
            half_density: 0.5 * facets.density(Local(wo.0 + wi.0)),
            one_way: o + across_o,
            // S(i)/cos i first, because products of two cosines may underflow.
            both_ways: o * (across_i / i) + across_o,
        }
    }

    /// f·cos θi without Fresnel's factor: cos θi G₂ D / (4 cos θo cos θi) [sr⁻¹].
    pub fn scattered(&self) -> f32 {
        self.half_density / self.both_ways
    }

    /// The density of reflecting `wo` at a visible facet: G₁(wo) D / (4 cos θo) [sr⁻¹].
    pub fn density(&self) -> f32 {
        self.half_density / self.one_way
    }

    /// G₂/G₁, the share of the light from visible facets that is not masked on its way out.
    pub fn unmasked(&self) -> f32 {
        self.one_way / self.both_ways
    }
}

/// The cosine between either of two directions and their half vector.
#[inline]
pub(super) fn cos_to_half(wo: Local, wi: Local) -> f32 {
    cos2_to_half(wo, wi).sqrt().min(1.0)
}

/// The square of the cosine between either of two directions and their half vector.
#[inline]
pub(super) fn cos2_to_half(wo: Local, wi: Local) -> f32 {
    // |wo + wi| = 2 wo·h = 2 wi·h, so that the result is symmetric.
    0.25 * (wo.0 + wi.0).length_squared()
}

/// Two directions on one side of the surface, mirrored to above it; `None` for directions on opposite sides.
#[inline]
pub(super) fn above(wo: Local, wi: Local) -> Option<[Local; 2]> {
    wo.same_side(wi).then(|| [upward(wo), upward(wi)])
}

/// A direction, mirrored to above the surface if it is below.
pub(super) fn upward(w: Local) -> Local {
    Local(w.0.with_z(w.abs_cos()))
}

/// The unit vector along `sum` or opposite to it, with z > 0, and the length of `sum`; `None` for a vector of length 0.
pub(super) fn upward_normal(sum: Vec3) -> Option<(Local, f32)> {
    let length = sum.length();
    (length > 0.0).then(|| (Local(sum * (1f32.copysign(sum.z) / length)), length))
}
