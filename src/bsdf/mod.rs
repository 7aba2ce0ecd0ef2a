//! Scattering models (BSDFs): how a surface reflects and transmits light.
//!
//! Conventions of all models:
//! - `wo`, `wi` are unit, local (+z is the shading normal), and point away from the surface
//! - `eval` returns f(wo, wi)·|cos θi| [sr⁻¹]: the cosine is always inside
//! - `sample` returns weight = f·|cos θi| / pdf, for the `wi` it chose
//! - delta lobes appear in `sample` and `delta_lobes` only: `eval` and `pdf` are 0 for them
//!
//! To add a plain model, write a file in this folder with its formulas ([`ScatteringModel`]) and its parameters (`parameters!`), and
//! a row in `table.rs`.

pub mod blinn_phong;
pub mod clear_film;
pub mod compound;
pub mod conductor;
pub mod description;
pub mod dielectric;
pub mod diffuse;
pub mod diffuse_transmission;
pub mod dispersion;
pub mod element;
pub mod film;
pub mod filmed_dielectric;
pub mod glass;
pub mod interface;
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
mod rough_interface;
pub mod surface_material;
mod table;
mod table_cache;
pub mod thin_dielectric;
pub mod thin_film;

use arrayvec::ArrayVec;
use glam::Vec2;

use crate::effects::Effects;
use crate::math::{Density, Local, Rgb, SolidAnglePdf, Spectrum};
use crate::texture::Texture;

pub use blinn_phong::BlinnPhong;
pub use clear_film::{ClearFilm, FilmLayer};
pub use compound::{Coat, Coated, Compound, CompoundAt, Dispersive, Mix, Share, Sheen, TwoSided};
pub use conductor::{Conductor, Metallic, Reflectance};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use dispersion::Dispersion;
pub use element::Element;
pub use filmed_dielectric::FilmedDielectric;
pub use glass::Glass;
pub use interface::Interface;
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
pub use surface_material::{MaterialId, NormalModifier, SurfaceMaterial};
pub use table::{Bsdf, Material, described, textured};
pub use thin_dielectric::ThinDielectric;
pub use thin_film::ThinFilm;

/// The quantity that a path transports. Refraction scales radiance by the squared ratio of the indices, but not importance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// Radiance: the path comes from the camera.
    Radiance,
    /// Importance: the path comes from a light.
    Importance,
}

/// A direction drawn from a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The sampled direction.
    pub wi: Local,
    /// The weight of the sample: f · |cos θi| / pdf, or the share of the light for a delta lobe.
    pub weight: Spectrum,
    /// The density of the direction, or the mark of a delta lobe.
    pub density: Density,
    /// The side of the surface that the direction leads to.
    pub lobe: Lobe,
    /// The index of refraction on the side of `wi` over that on the side of `wo`; 1 for reflection.
    pub eta: f32,
}

/// The side of the surface that a sample leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Reflection, to the side of `wo`.
    Reflection,
    /// Transmission, to the other side.
    Transmission,
    /// Scattering at a point of a medium, which has no sides.
    Medium,
}

/// The delta lobes of a model: single directions that each get a share of the light. Plain models have at most two.
#[derive(Clone, Debug, Default)]
struct DeltaLobes(ArrayVec<BsdfSample, MAX_DELTA_LOBES>);

/// The largest number of delta lobes of a material. A scene with more in one material is refused.
pub const MAX_DELTA_LOBES: usize = 8;

impl DeltaLobes {
    /// Adds the share `share` of a lobe. Lobes with the same direction are merged.
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

/// A scattering model at a point, with numbers for parameters.
///
/// The default methods describe a reciprocal model with a smooth lobe and without delta lobes.
pub trait ScatteringModel {
    /// f(wo, wi)·|cos θi| [sr⁻¹]; 0 for delta lobes.
    fn eval(&self, _wo: Local, _wi: Local, _mode: TransportMode) -> Spectrum {
        Spectrum::BLACK
    }

    /// Probability density with which `sample` returns `wi` [sr⁻¹]; 0 for delta lobes.
    fn pdf(&self, _wo: Local, _wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::ZERO
    }

    /// Samples a direction for `wo` with uniform numbers: `choice` selects a lobe, `u` a direction in it. Returns `None` where nothing
    /// is scattered.
    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample>;

    /// The delta lobes for `wo`: single directions with their share of the light as weight.
    fn delta_lobes(&self, _wo: Local, _mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [None, None]
    }

    /// Whether `eval` is not 0 everywhere.
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    /// Whether f(wo, wi) = f(wi, wo), up to the factor η² for transmission.
    fn reciprocal(&self) -> bool {
        true
    }

    /// Limits parameters from textures so that the model returns no more light than it receives.
    fn energy_conserving(self) -> Self
    where
        Self: Sized,
    {
        self
    }
}

/// The effects of a lobe with a textured width. Where the width is 0 it is a mirror.
fn lobe_effects(width: &Texture) -> Effects {
    match width {
        Texture::Constant(none) if none.is_black() => Effects::SPECULAR_REFLECTION,
        Texture::Constant(_) => Effects::GLOSSY_REFLECTION,
        _ => Effects::SPECULAR_REFLECTION | Effects::GLOSSY_REFLECTION,
    }
}

/// A model with textures for parameters: its properties that hold at every point.
pub trait TexturedModel: Lookup {
    /// The effects that simulating the model needs, without those of its textures.
    fn effects(&self) -> Effects;

    /// Whether light passes through the surface, and what is behind it.
    fn passage(&self) -> Passage {
        Passage::Blocked
    }

    /// σ of the body behind the surface (1/m), if it is part of the model.
    fn absorption(&self) -> Option<Rgb> {
        None
    }

    /// Whether scattering depends on the directions of the surface's tangents.
    fn is_anisotropic(&self) -> bool {
        false
    }

    /// Whether the model has the same parameters at every hit.
    fn is_uniform(&self) -> bool {
        self.textures().into_iter().all(Texture::is_constant)
    }

    /// The effects of the model's textures.
    fn texture_effects(&self) -> Effects {
        self.textures().into_iter().map(Texture::effects).fold(Effects::NONE, Effects::union)
    }
}

impl BsdfSample {
    /// Returns a reflection from a smooth lobe, or `None` where nothing is reflected or `wi` lies outside of the lobe.
    fn of_lobe(wi: Local, weight: Spectrum, pdf: SolidAnglePdf) -> Option<BsdfSample> {
        let found = !weight.is_black() && pdf.get() > 0.0;
        found.then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    /// Returns a reflection into a single direction with the share `weight`.
    fn reflected(wi: Local, weight: Spectrum) -> BsdfSample {
        BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Reflection, eta: 1.0 }
    }
}
