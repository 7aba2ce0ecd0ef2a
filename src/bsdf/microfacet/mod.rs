//! Rough surfaces as many tiny mirrors, too small to be seen one by one.
//!
//! What the models share: the distribution of the facets' normals, how much of them is in sight, and how
//! those in sight are sampled.
//!
//! - `alpha`: the roughness along the local x and y axes, the root mean square slope times √2 for Beckmann.
//!   Users set `roughness` r, and α = r²: the width of the highlight is proportional to α, and equal steps
//!   of r look equal.
//! - Directions are in the hemisphere of the normal here: z > 0.

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

/// How the facets of a rough surface lean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Distribution {
    /// Trowbridge and Reitz's: highlights with long tails, as measured ones have.
    #[default]
    Ggx,
    /// Gaussian slopes: highlights that end soon.
    Beckmann,
}

/// Facets of a distribution, with heights that do not depend on each other (Smith).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    /// Along x and y, each at least [`MIN_ALPHA`].
    pub alpha: Vec2,
    pub distribution: Distribution,
}

/// Smoother than this is a mirror: unit vectors of f32 have no finer directions than a sixteenth of it.
pub const MIN_ALPHA: f32 = 1e-6;

impl Microfacets {
    /// `None` where the surface is as good as smooth.
    pub fn new(alpha: Vec2, distribution: Distribution) -> Option<Microfacets> {
        (alpha.max_element() >= MIN_ALPHA).then(|| Microfacets { alpha: alpha.max(Vec2::splat(MIN_ALPHA)), distribution })
    }

    /// D(h): area of facets with the normal h, per area of the surface and solid angle [sr⁻¹].
    ///
    /// ∫ D(h) cos θh dh = 1
    ///
    /// - `h`: along the normal, of any length
    ///
    /// Tests: distribution_of_normals, weak_furnace.
    #[inline]
    pub fn density(&self, h: Local) -> f32 {
        // sin² by the coordinates themselves: 1 − cos² would have no digits left of a small alpha.
        let per_area = 1.0 / (self.alpha.x * self.alpha.y);
        // h/α by one division, which waits for no direction.
        let slopes = h.0.truncate() * (self.alpha.yx() * per_area);
        let (slope2, cos2) = (slopes.length_squared(), h.cos() * h.cos());
        let length2 = h.0.length_squared();
        let profile = match self.distribution {
            Distribution::Ggx => ggx::profile(slope2, cos2, length2),
            Distribution::Beckmann => beckmann::profile(slope2, cos2, length2),
        };
        profile * (FRAC_1_PI * per_area)
    }

    /// S(w) = cos θ (1 + 2 Λ(w)): the area of facets, front and back, that lies across w, per area of the surface.
    ///
    /// Of it, (cos θ + S)/2 faces w and cos θ is in sight. Smith's functions follow without a division by
    /// cos θ, and hold down to cos θ = 0, where Λ is infinite:
    ///
    /// - Λ(w) = (S/cos θ − 1)/2
    /// - G₁(w) = 1/(1 + Λ) = 2 cos θ / (cos θ + S)
    /// - G₂(a, b) = 1/(1 + Λ(a) + Λ(b)) = 2 cos a cos b / (cos a S(b) + cos b S(a)), facets at equal heights being hidden together
    ///
    /// Source: Smith (1967); Heitz, *Understanding the Masking-Shadowing Function* (2014). Tests: weak furnace (M1).
    #[inline]
    pub fn projected_area(&self, w: Local) -> f32 {
        let sine2 = (self.alpha * w.0.truncate()).length_squared();
        match self.distribution {
            Distribution::Ggx => ggx::projected_area(w.cos(), sine2),
            Distribution::Beckmann => beckmann::projected_area(w.cos(), sine2),
        }
    }

    /// The normal of a facet in sight from `wo`, drawn with density G₁(wo) |wo·h| D(h) / cos θo.
    ///
    /// In the space where the surface is stretched to roughness 1, w ∝ (αx x, αy y, z); normals go back the same way.
    pub fn sample_visible(&self, wo: Local, u: Vec2) -> Local {
        Local(self.along_visible(wo, u).normalize())
    }

    /// The same, of any length.
    #[inline(always)]
    fn along_visible(&self, wo: Local, u: Vec2) -> Vec3 {
        let stretched = wo.0 * self.alpha.extend(1.0);
        let normal = match self.distribution {
            Distribution::Ggx => ggx::sample_visible(stretched, u),
            Distribution::Beckmann => beckmann::sample_visible(stretched.normalize(), u),
        };
        normal * self.alpha.extend(1.0)
    }

    /// `wo` mirrored at a facet in sight, and the square of the cosine of either to its normal.
    #[inline(always)]
    pub(super) fn mirror_visible(&self, wo: Local, u: Vec2) -> (Local, f32) {
        let along = self.along_visible(wo, u);
        let cos = wo.0.dot(along);
        let part = cos / along.length_squared();
        let w = along * (2.0 * part) - wo.0;
        // As near to 1 as its length is, a step of Newton's for 1/√x is as good as a root and a division.
        (Local(w * (1.5 - 0.5 * w.length_squared())), cos * part)
    }
}

/// What two directions above the surface make of facets that mirror one into the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfVectorTerms {
    /// D/2 of their normal [sr⁻¹].
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
            // S(i)/cos i first: products of two cosines may underflow.
            both_ways: o * (across_i / i) + across_o,
        }
    }

    /// cos θi G₂ D / (4 cos θo cos θi), without Fresnel's factor [sr⁻¹].
    pub fn scattered(&self) -> f32 {
        self.half_density / self.both_ways
    }

    /// G₁(wo) D / (4 cos θo), the density of mirroring `wo` at a facet in sight [sr⁻¹].
    pub fn density(&self) -> f32 {
        self.half_density / self.one_way
    }

    /// G₂/G₁: what is not masked on its way out.
    pub fn unmasked(&self) -> f32 {
        self.one_way / self.both_ways
    }
}

/// The cosine of either of two directions to the normal half way between them.
#[inline]
pub(super) fn cos_to_half(wo: Local, wi: Local) -> f32 {
    cos2_to_half(wo, wi).sqrt().min(1.0)
}

/// Its square.
#[inline]
pub(super) fn cos2_to_half(wo: Local, wi: Local) -> f32 {
    // |wo + wi| = 2 wo·h = 2 wi·h: the same from both ends.
    0.25 * (wo.0 + wi.0).length_squared()
}

/// Two directions on one side of the surface, or their mirror images above it.
#[inline]
pub(super) fn above(wo: Local, wi: Local) -> Option<[Local; 2]> {
    wo.same_side(wi).then(|| [upward(wo), upward(wi)])
}

/// The same direction, or its mirror image above the surface.
pub(super) fn upward(w: Local) -> Local {
    Local(w.0.with_z(w.abs_cos()))
}

/// The unit vector along `sum`, turned to z > 0, and the length of `sum`; `None` for no direction at all.
pub(super) fn upward_normal(sum: Vec3) -> Option<(Local, f32)> {
    let length = sum.length();
    (length > 0.0).then(|| (Local(sum * (1f32.copysign(sum.z) / length)), length))
}
