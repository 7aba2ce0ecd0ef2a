//! How a surface scatters light.
//!
//! Conventions, stated once for every model:
//! - `wo`, `wi` are unit, local (+z is the shading normal), and point away from the surface
//! - `eval` returns f(wo, wi)·|cos θi| [sr⁻¹]: the cosine is always inside
//! - `sample` returns weight = f·|cos θi| / pdf, for the `wi` it chose
//! - a delta lobe is seen by `sample` and `delta_lobes` only: `eval` and `pdf` are 0 for it
//!
//! To add a model: a file beside these, a variant in [`Bsdf`] and an arm in each `match` below,
//! a variant in [`Material`].

pub mod conductor;
pub mod dielectric;
pub mod diffuse;
pub mod material;
pub mod matte_cone;
pub mod mirror;

use glam::Vec2;

use crate::math::{Density, Local, SolidAnglePdf, Spectrum};

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use material::Material;
pub use matte_cone::MatteCone;
pub use mirror::Mirror;

/// A scattering model at one point, its parameters looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Conductor(Conductor),
    Dielectric(Dielectric),
    MatteCone(MatteCone),
}

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

/// At most two: reflection and transmission.
pub type DeltaLobes = std::iter::Flatten<std::array::IntoIter<Option<BsdfSample>, 2>>;

impl Bsdf {
    /// f(wo, wi)·|cos θi|; 0 for delta lobes.
    pub fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        match self {
            Bsdf::Diffuse(b) => b.eval(wo, wi),
            Bsdf::MatteCone(b) => b.eval(wo, wi),
            Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) => Spectrum::BLACK,
        }
    }

    /// The density with which [`Bsdf::sample`] returns `wi`; 0 for delta lobes.
    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        match self {
            Bsdf::Diffuse(b) => b.pdf(wo, wi),
            Bsdf::MatteCone(b) => b.pdf(wo, wi),
            Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) => SolidAnglePdf::ZERO,
        }
    }

    /// A direction for `wo`, from the uniform numbers `choice` (which lobe) and `u` (where in it).
    ///
    /// `None` where nothing is scattered.
    pub fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        match self {
            Bsdf::Diffuse(b) => b.sample(wo, u),
            Bsdf::MatteCone(b) => b.sample(wo, u),
            Bsdf::Mirror(b) => b.sample(wo),
            Bsdf::Conductor(b) => b.sample(wo),
            Bsdf::Dielectric(b) => b.sample(wo, choice, mode),
        }
    }

    /// The single directions into which a share of the light goes, with that share as weight.
    pub fn delta_lobes(&self, wo: Local, mode: TransportMode) -> DeltaLobes {
        let lobes = match self {
            Bsdf::Diffuse(_) => [None, None],
            Bsdf::MatteCone(b) => [b.delta_lobe(wo), None],
            Bsdf::Mirror(b) => [b.sample(wo), None],
            Bsdf::Conductor(b) => [b.sample(wo), None],
            Bsdf::Dielectric(b) => b.delta_lobes(wo, mode),
        };
        lobes.into_iter().flatten()
    }

    /// Whether there is anything that [`Bsdf::eval`] sees.
    pub fn has_smooth_lobe(&self) -> bool {
        match self {
            Bsdf::Diffuse(_) => true,
            Bsdf::MatteCone(b) => !b.is_mirror(),
            Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) => false,
        }
    }

    /// Whether f(wo, wi) = f(wi, wo) (transmission: up to η²); `false` is a fact of the model, stated, not a bug.
    pub fn reciprocal(&self) -> bool {
        match self {
            Bsdf::Diffuse(_) | Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) => true,
            Bsdf::MatteCone(b) => b.is_mirror(),
        }
    }
}

impl BsdfSample {
    /// A mirror direction with the share `weight`.
    fn reflected(wi: Local, weight: Spectrum) -> BsdfSample {
        BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Reflection, eta: 1.0 }
    }
}
