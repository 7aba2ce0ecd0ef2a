//! Materials made of materials.
//!
//! A compound at a point is a reference to its description: the parts are looked up when they are asked for, so that the
//! models of plain materials stay small plain data, and nothing is allocated at a hit.
//!
//! To add one: a file beside these, a variant in [`Compound`] and its arms.

pub mod coated;
pub mod mix;
pub mod sheen;
pub mod two_sided;
mod veil;

use glam::{DVec3, Vec2};

use super::{Bsdf, BsdfSample, DeltaLobes, HitContext, Material, Passage, TransportMode};
use crate::effects::Effects;
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum};
use crate::texture::Texture;

pub use coated::{Coat, Coated};
pub use mix::{Mix, Share};
pub use sheen::Sheen;
pub use two_sided::TwoSided;
use veil::Veil;

#[derive(Clone, Debug, PartialEq)]
pub enum Compound {
    Mix(Mix),
    Coated(Coated),
    Sheen(Sheen),
    TwoSided(TwoSided),
}

/// A compound at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompoundAt<'a> {
    pub compound: &'a Compound,
    pub hit: HitContext,
}

/// What a compound does to light at a place; the conventions are those of [`Bsdf`].
trait Scatter {
    /// - `above`: the layers that its light goes through, both ways; what is seen of it is weakened by them
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&Veil>) -> Spectrum;
    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf;
    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample>;
    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes;
    fn has_smooth_lobe(&self, at: &HitContext) -> bool;
    fn reciprocal(&self, at: &HitContext) -> bool;

    /// The materials it is made of.
    fn parts(&self) -> Vec<&Material>;
    /// Its own parameters.
    fn textures(&self) -> Vec<&Texture>;

    /// What it adds to the effects of its parts.
    fn own_effects(&self) -> Effects {
        Effects::NONE
    }

    fn is_anisotropic(&self) -> bool {
        self.parts().into_iter().any(Material::is_anisotropic)
    }

    /// A sample of a part, as one of the whole.
    ///
    /// - `chance`: of the part to be chosen
    /// - `share`: what the whole takes of it into that direction
    ///
    /// Into a single direction the part leads alone; elsewhere all of the whole counts.
    fn of_part(
        &self,
        at: &HitContext,
        wo: Local,
        sample: BsdfSample,
        chance: f32,
        share: impl FnOnce(Local) -> Spectrum,
        mode: TransportMode,
    ) -> Option<BsdfSample>
    where
        Self: Sized,
    {
        if sample.density == Density::Delta {
            let weight = sample.weight * share(sample.wi) / chance;
            return (!weight.is_black()).then_some(BsdfSample { weight, ..sample });
        }
        let pdf = self.pdf(at, wo, sample.wi);
        let weight = self.eval(at, wo, sample.wi, mode, None) / pdf.get();
        (pdf.get() > 0.0).then_some(BsdfSample { weight, density: Density::Smooth(pdf), ..sample })
    }
}

/// Calls the member's own.
macro_rules! of_each {
    ($compound:expr, $member:ident => $call:expr) => {
        match $compound {
            Compound::Mix($member) => $call,
            Compound::Coated($member) => $call,
            Compound::Sheen($member) => $call,
            Compound::TwoSided($member) => $call,
        }
    };
}

// Out of line, so that plain materials do not pay for the recursion.
impl CompoundAt<'_> {
    #[inline(never)]
    pub fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        of_each!(self.compound, member => member.eval(&self.hit, wo, wi, mode, None))
    }

    /// What the layers above it let pass of [`CompoundAt::eval`].
    #[inline(never)]
    fn beneath(&self, above: Option<&Veil>, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        of_each!(self.compound, member => member.eval(&self.hit, wo, wi, mode, above))
    }

    #[inline(never)]
    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        of_each!(self.compound, member => member.pdf(&self.hit, wo, wi))
    }

    #[inline(never)]
    pub fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        of_each!(self.compound, member => member.sample(&self.hit, wo, choice, u, mode))
    }

    #[inline(never)]
    pub(in crate::bsdf) fn delta_lobes(&self, wo: Local, mode: TransportMode) -> DeltaLobes {
        of_each!(self.compound, member => member.delta_lobes(&self.hit, wo, mode))
    }

    #[inline(never)]
    pub fn has_smooth_lobe(&self) -> bool {
        of_each!(self.compound, member => member.has_smooth_lobe(&self.hit))
    }

    pub fn reciprocal(&self) -> bool {
        of_each!(self.compound, member => member.reciprocal(&self.hit))
    }
}

impl Compound {
    pub fn name(&self) -> &'static str {
        match self {
            Compound::Mix(_) => "mix",
            Compound::Coated(_) => "coated",
            Compound::Sheen(_) => "sheen",
            Compound::TwoSided(_) => "two_sided",
        }
    }

    /// The compound at a place; where only one of two is there, that one.
    pub fn bsdf_at(&self, at: &HitContext) -> Bsdf<'_> {
        if let Compound::Mix(mix) = self
            && let Some(only) = mix.only(at)
        {
            return at.bsdf_of(only);
        }
        Bsdf::Compound(CompoundAt { compound: self, hit: *at })
    }

    pub fn is_anisotropic(&self) -> bool {
        of_each!(self, member => member.is_anisotropic())
    }

    pub fn effects(&self) -> Effects {
        let parts = self.parts().into_iter().map(Material::effects).fold(Effects::NONE, Effects::union);
        let (own, textures) = of_each!(self, member => (member.own_effects(), member.textures()));
        let textured = textures.into_iter().any(|texture| !texture.is_constant());
        parts | own | if textured { Effects::TEXTURES } else { Effects::NONE }
    }

    /// What becomes of light that goes on behind the surface: what becomes of it behind any of the parts.
    pub fn passage(&self) -> Passage {
        self.parts().into_iter().map(Material::passage).max().unwrap_or(Passage::Blocked)
    }

    /// The materials it is made of.
    pub fn parts(&self) -> Vec<&Material> {
        of_each!(self, member => member.parts())
    }

    /// The same compound after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Compound {
        match self {
            Compound::Mix(m) => Compound::Mix(m.recentred(origin)),
            Compound::Coated(m) => Compound::Coated(m.recentred(origin)),
            Compound::Sheen(m) => Compound::Sheen(m.recentred(origin)),
            Compound::TwoSided(m) => Compound::TwoSided(m.recentred(origin)),
        }
    }
}

/// Whether a uniform number chooses the second of two, and what is left of it: uniform again.
fn choose(choice: f32, second: f32) -> (bool, f32) {
    let (chosen, rest) = if choice < second { (true, choice / second) } else { (false, (choice - second) / (1.0 - second)) };
    (chosen, rest.min(ONE_MINUS_EPSILON))
}
