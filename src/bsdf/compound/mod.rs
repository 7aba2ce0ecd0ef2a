//! Compounds: materials made of other materials.
//!
//! A compound at a hit is a reference to the material; its parts are looked up when they are needed. So the models of plain
//! materials stay small plain data, and nothing is allocated at a hit.
//!
//! To add a compound, write a file in this folder, and a variant of [`Compound`] with its match arms.

pub mod coated;
pub mod dispersive;
mod layer_stack;
pub mod mix;
pub mod sheen;
pub mod two_sided;

use glam::{DVec3, Vec2};

use super::{Bsdf, BsdfSample, DeltaLobes, HitContext, Material, Passage, TransportMode};
use crate::effects::Effects;
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::{Density, Local, Rgb, SolidAnglePdf, Spectrum, Wavelength};
use crate::texture::Texture;

pub use coated::{Coat, Coated};
pub use dispersive::Dispersive;
use layer_stack::LayerStack;
pub use mix::{Mix, Share};
pub use sheen::Sheen;
pub use two_sided::TwoSided;

/// A material made of other materials.
#[derive(Clone, Debug, PartialEq)]
pub enum Compound {
    /// Some of one material and some of another.
    Mix(Mix),
    /// A material under a clear coat.
    Coated(Coated),
    /// A material under a layer of fibres.
    Sheen(Sheen),
    /// Different materials on the two sides of a surface.
    TwoSided(TwoSided),
    /// Glass whose index of refraction depends on the wavelength.
    Dispersive(Dispersive),
}

/// A compound at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompoundAt<'a> {
    /// The material.
    pub compound: &'a Compound,
    /// The context in which its parts are looked up.
    pub hit: HitContext,
}

/// Scattering by a compound at a hit; the conventions are those of [`Bsdf`].
trait Scatter {
    /// f(wo, wi)·|cos θi| [sr⁻¹], times the transmittance of the layers above.
    ///
    /// - `above`: the layers that light passes through on its way in and out
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&LayerStack>) -> Spectrum;
    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf;
    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample>;
    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes;
    fn has_smooth_lobe(&self, at: &HitContext) -> bool;
    fn reciprocal(&self, at: &HitContext) -> bool;

    /// The materials that the compound is made of.
    fn parts(&self) -> Vec<&Material>;
    /// The textures of the compound's own parameters.
    fn textures(&self) -> Vec<&Texture>;

    /// The effects of the compound itself, without those of its parts.
    fn own_effects(&self) -> Effects {
        Effects::NONE
    }

    fn is_anisotropic(&self) -> bool {
        self.parts().into_iter().any(Material::is_anisotropic)
    }

    /// Turns a sample of a part into a sample of the compound.
    ///
    /// - `chance`: the probability that the part was chosen
    /// - `share`: the factor of the part in the compound for a direction
    ///
    /// A delta lobe belongs to the part alone. For any other direction all parts contribute to the weight and the density.
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

/// Calls a method of the compound's variant.
macro_rules! of_each {
    ($compound:expr, $member:ident => $call:expr) => {
        match $compound {
            Compound::Mix($member) => $call,
            Compound::Coated($member) => $call,
            Compound::Sheen($member) => $call,
            Compound::TwoSided($member) => $call,
            Compound::Dispersive($member) => $call,
        }
    };
}

// Not inlined, so that plain materials do not pay for the recursion.
impl CompoundAt<'_> {
    /// f(wo, wi)·|cos θi| [sr⁻¹]; 0 for delta lobes.
    #[inline(never)]
    pub fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        of_each!(self.compound, member => member.eval(&self.hit, wo, wi, mode, None))
    }

    /// [`CompoundAt::eval`] times the transmittance of the layers above.
    #[inline(never)]
    fn beneath(&self, above: Option<&LayerStack>, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        of_each!(self.compound, member => member.eval(&self.hit, wo, wi, mode, above))
    }

    /// Probability density with which `sample` returns `wi` [sr⁻¹]; 0 for delta lobes.
    #[inline(never)]
    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        of_each!(self.compound, member => member.pdf(&self.hit, wo, wi))
    }

    /// Samples a direction for `wo`; the conventions are those of [`Bsdf::sample`].
    #[inline(never)]
    pub fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        of_each!(self.compound, member => member.sample(&self.hit, wo, choice, u, mode))
    }

    /// The delta lobes for `wo`: single directions with their share of the light as weight.
    #[inline(never)]
    pub(in crate::bsdf) fn delta_lobes(&self, wo: Local, mode: TransportMode) -> DeltaLobes {
        of_each!(self.compound, member => member.delta_lobes(&self.hit, wo, mode))
    }

    /// Whether `eval` is not 0 everywhere.
    #[inline(never)]
    pub fn has_smooth_lobe(&self) -> bool {
        of_each!(self.compound, member => member.has_smooth_lobe(&self.hit))
    }

    /// Whether f(wo, wi) = f(wi, wo), up to the factor η² for transmission.
    pub fn reciprocal(&self) -> bool {
        of_each!(self.compound, member => member.reciprocal(&self.hit))
    }
}

impl<'a> Bsdf<'a> {
    /// The model for light of a wavelength. Only compounds depend on it.
    pub fn at_wavelength(self, wavelength: Wavelength) -> Bsdf<'a> {
        match self {
            Bsdf::Compound(at) => at.compound.bsdf_at(&HitContext { wavelength: Some(wavelength), ..at.hit }),
            plain => plain,
        }
    }
}

impl Compound {
    /// The `type` of the material in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Compound::Mix(_) => "mix",
            Compound::Coated(_) => "coated",
            Compound::Sheen(_) => "sheen",
            Compound::TwoSided(_) => "two_sided",
            Compound::Dispersive(_) => "dielectric",
        }
    }

    /// The compound at a hit. Where a mix has only one of its materials, the result is the model of that one; where light has a wavelength,
    /// dispersive glass is plain glass.
    pub fn bsdf_at(&self, at: &HitContext) -> Bsdf<'_> {
        if let (Compound::Dispersive(glass), Some(_)) = (self, at.wavelength) {
            return glass.model(at);
        }
        if let Compound::Mix(mix) = self
            && let Some(only) = mix.only(at)
        {
            return at.bsdf_of(only);
        }
        Bsdf::Compound(CompoundAt { compound: self, hit: *at })
    }

    /// Whether scattering depends on the directions of the surface's tangents.
    pub fn is_anisotropic(&self) -> bool {
        of_each!(self, member => member.is_anisotropic())
    }

    /// The effects that simulating the compound and its parts needs.
    pub fn effects(&self) -> Effects {
        let parts = self.parts().into_iter().map(Material::effects).fold(Effects::NONE, Effects::union);
        let (own, textures) = of_each!(self, member => (member.own_effects(), member.textures()));
        textures.into_iter().map(Texture::effects).fold(parts | own, Effects::union)
    }

    /// Whether light passes through the surface, and what is behind it: the largest value of the parts.
    pub fn passage(&self) -> Passage {
        self.parts().into_iter().map(Material::passage).max().unwrap_or(Passage::Blocked)
    }

    /// σ of the body behind the surface (1/m), if one of the parts has it.
    pub fn absorption(&self) -> Option<Rgb> {
        self.parts().into_iter().find_map(Material::absorption)
    }

    /// The materials that the compound is made of.
    pub fn parts(&self) -> Vec<&Material> {
        of_each!(self, member => member.parts())
    }

    /// The compound after the world has been moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Compound {
        match self {
            Compound::Mix(m) => Compound::Mix(m.recentred(origin)),
            Compound::Coated(m) => Compound::Coated(m.recentred(origin)),
            Compound::Sheen(m) => Compound::Sheen(m.recentred(origin)),
            Compound::TwoSided(m) => Compound::TwoSided(m.recentred(origin)),
            Compound::Dispersive(m) => Compound::Dispersive(m.recentred(origin)),
        }
    }
}

/// Chooses the second of two alternatives with probability `second`. Returns the choice and the rest of the uniform number, which is
/// uniform again.
fn choose(choice: f32, second: f32) -> (bool, f32) {
    let (chosen, rest) = if choice < second { (true, choice / second) } else { (false, (choice - second) / (1.0 - second)) };
    (chosen, rest.min(ONE_MINUS_EPSILON))
}
