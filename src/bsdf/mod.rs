//! How a surface scatters light.
//!
//! Conventions, stated once for every model:
//! - `wo`, `wi` are unit, local (+z is the shading normal), and point away from the surface
//! - `eval` returns f(wo, wi)·|cos θi| [sr⁻¹]: the cosine is always inside
//! - `sample` returns weight = f·|cos θi| / pdf, for the `wi` it chose
//! - a delta lobe is seen by `sample` and `delta_lobes` only: `eval` and `pdf` are 0 for it
//!
//! To add a plain model: a file beside these with its formulas ([`ScatteringModel`]) and its parameters (`parameters!`), and a row
//! in `table.rs`.

pub mod blinn_phong;
pub mod compound;
pub mod conductor;
pub mod description;
pub mod dielectric;
pub mod diffuse;
pub mod diffuse_transmission;
pub mod element;
pub mod lommel_seeliger;
pub mod material;
pub mod matte_cone;
pub mod metal;
pub mod microfacet;
pub mod mirror;
pub mod oren_nayar;
pub mod parameter;
pub mod phong;
pub mod plastic;
pub mod principled;
pub mod rough_conductor;
pub mod rough_dielectric;
pub mod surface_material;
mod table;
pub mod thin_dielectric;

use arrayvec::ArrayVec;
use glam::Vec2;

use crate::effects::Effects;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum};
use crate::texture::Texture;

pub use blinn_phong::BlinnPhong;
pub use compound::{Coat, Coated, Compound, CompoundAt, Mix, Share, Sheen, TwoSided};
pub use conductor::{Conductor, Metallic, Reflectance};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use element::Element;
pub use lommel_seeliger::LommelSeeliger;
pub use material::{HitContext, Passage};
pub use matte_cone::MatteCone;
pub use metal::Metal;
pub use mirror::Mirror;
pub use oren_nayar::OrenNayar;
pub use parameter::Lookup;
pub use phong::Phong;
pub use plastic::Plastic;
pub use principled::Principled;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use surface_material::{NormalModifier, SurfaceMaterial};
pub use table::{Bsdf, Material, described, textured};
pub use thin_dielectric::ThinDielectric;

/// What is transported: radiance (from the camera) is compressed by refraction, importance (from a light) is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    Radiance,
    Importance,
}

/// A direction drawn from a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    pub wi: Local,
    /// f · |cos θi| / pdf
    pub weight: Spectrum,
    pub density: Density,
    pub lobe: Lobe,
    /// Index of refraction on the side of `wi` over that on the side of `wo`; 1 for reflection.
    pub eta: f32,
}

/// Which way a sample went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    Reflection,
    Transmission,
}

/// The single directions into which a model sends a share of the light; plain models two at most.
#[derive(Clone, Debug, Default)]
struct DeltaLobes(ArrayVec<BsdfSample, MAX_DELTA_LOBES>);

/// The most of them: a scene that asks for more is refused.
pub const MAX_DELTA_LOBES: usize = 8;

impl DeltaLobes {
    /// Another one, of which the whole takes `share`; lobes into one direction are one.
    fn add(&mut self, lobe: BsdfSample, share: Spectrum) {
        let weight = lobe.weight * share;
        let same = self.0.iter_mut().find(|known| known.wi == lobe.wi && known.eta == lobe.eta);
        match same {
            Some(known) => known.weight += weight,
            None if weight.is_black() => {}
            None => self.0.push(BsdfSample { weight, ..lobe }),
        }
    }
}

impl<const N: usize> From<[Option<BsdfSample>; N]> for DeltaLobes {
    fn from(lobes: [Option<BsdfSample>; N]) -> DeltaLobes {
        DeltaLobes(lobes.into_iter().flatten().collect())
    }
}

/// A scattering model at a point: plain numbers and formulas.
///
/// What a model leaves alone holds for most: a smooth lobe, no delta lobes, reciprocity. Models write their formulas here.
pub trait ScatteringModel {
    /// f(wo, wi)·|cos θi| [sr⁻¹]; 0 for delta lobes.
    fn eval(&self, _wo: Local, _wi: Local, _mode: TransportMode) -> Spectrum {
        Spectrum::BLACK
    }

    /// The density with which `sample` returns `wi` [sr⁻¹]; 0 for delta lobes.
    fn pdf(&self, _wo: Local, _wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::ZERO
    }

    /// A direction for `wo`, from uniform numbers: `choice` chooses a lobe, `u` a direction in it.
    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample>;

    /// The single directions into which a share of the light goes, with that share as weight.
    fn delta_lobes(&self, _wo: Local, _mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [None, None]
    }

    /// Whether there is anything that `eval` sees.
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    /// Whether f(wo, wi) = f(wi, wo), for transmission up to η².
    fn reciprocal(&self) -> bool {
        true
    }

    /// The model for parameters as textures have them, which may ask for more light than there is.
    fn energy_conserving(self) -> Self
    where
        Self: Sized,
    {
        self
    }
}

/// The effects of a lobe by its width, which makes a mirror where it is 0.
fn lobe_effects(width: &Texture) -> Effects {
    match width {
        Texture::Constant(none) if none.is_black() => Effects::SPECULAR_REFLECTION,
        Texture::Constant(_) => Effects::INTERREFLECTION,
        _ => Effects::SPECULAR_REFLECTION | Effects::INTERREFLECTION,
    }
}

/// A model with textures for parameters, beyond the lookup of these.
pub trait TexturedModel: Lookup {
    /// What simulating it takes, textures apart.
    fn effects(&self) -> Effects;

    /// What becomes of light that goes on behind the surface.
    fn passage(&self) -> Passage {
        Passage::Blocked
    }

    /// Whether it matters where the axes of the surface point.
    fn is_anisotropic(&self) -> bool {
        false
    }

    /// Whether the model is the same at every hit.
    fn is_uniform(&self) -> bool {
        self.textures().into_iter().all(Texture::is_constant)
    }

    /// The effect of its textures.
    fn texture_effects(&self) -> Effects {
        if self.textures().into_iter().all(Texture::is_constant) { Effects::NONE } else { Effects::TEXTURES }
    }
}

impl BsdfSample {
    /// A reflection from a smooth lobe; `None` where nothing is reflected or `wi` lies outside the lobe.
    fn of_lobe(wi: Local, weight: Spectrum, pdf: SolidAnglePdf) -> Option<BsdfSample> {
        let found = !weight.is_black() && pdf.get() > 0.0;
        found.then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    /// A mirror direction with the share `weight`.
    fn reflected(wi: Local, weight: Spectrum) -> BsdfSample {
        BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Reflection, eta: 1.0 }
    }
}
