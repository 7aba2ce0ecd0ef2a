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

pub mod blinn_phong;
pub mod compound;
pub mod conductor;
pub mod dielectric;
pub mod diffuse;
pub mod diffuse_transmission;
pub mod element;
pub mod material;
pub mod matte_cone;
pub mod metal;
pub mod microfacet;
pub mod mirror;
pub mod oren_nayar;
pub mod phong;
pub mod plastic;
pub mod principled;
pub mod rough_conductor;
pub mod rough_dielectric;
pub mod skin;
pub mod thin_dielectric;

use arrayvec::ArrayVec;
use glam::Vec2;

use crate::math::{Density, Local, SolidAnglePdf, Spectrum};

pub use blinn_phong::BlinnPhong;
pub use compound::{Coat, Coated, Compound, Met, Mix, Place, Share, Sheen, Sides};
pub use conductor::{Conductor, Reflectance};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use element::Element;
pub use material::{Material, Metallic, Passage};
pub use matte_cone::MatteCone;
pub use metal::Metal;
pub use mirror::Mirror;
pub use oren_nayar::OrenNayar;
pub use phong::Phong;
pub use plastic::Plastic;
pub use principled::Principled;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use skin::{Relief, Skin};
pub use thin_dielectric::ThinDielectric;

/// A scattering model at one point, its parameters looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf<'a> {
    Diffuse(Diffuse),
    Mirror(Mirror),
    Conductor(Conductor),
    Dielectric(Dielectric),
    MatteCone(MatteCone),
    OrenNayar(OrenNayar),
    Phong(Phong),
    BlinnPhong(BlinnPhong),
    Metal(Metal),
    Plastic(Plastic),
    DiffuseTransmission(DiffuseTransmission),
    RoughConductor(RoughConductor),
    RoughDielectric(RoughDielectric),
    ThinDielectric(ThinDielectric),
    Compound(Met<'a>),
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

impl<'a> Bsdf<'a> {
    /// f(wo, wi)·|cos θi|; 0 for delta lobes.
    pub fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        match self {
            Bsdf::Diffuse(b) => b.eval(wo, wi),
            Bsdf::MatteCone(b) => b.eval(wo, wi),
            Bsdf::OrenNayar(b) => b.eval(wo, wi),
            Bsdf::Phong(b) => b.eval(wo, wi),
            Bsdf::BlinnPhong(b) => b.eval(wo, wi),
            Bsdf::Metal(b) => b.eval(wo, wi),
            Bsdf::Plastic(b) => b.eval(wo, wi),
            Bsdf::DiffuseTransmission(b) => b.eval(wo, wi),
            Bsdf::RoughConductor(b) => b.eval(wo, wi),
            Bsdf::RoughDielectric(b) => b.eval(wo, wi, mode),
            Bsdf::Compound(b) => b.eval(wo, wi, mode),
            Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) => Spectrum::BLACK,
        }
    }

    /// The density with which [`Bsdf::sample`] returns `wi`; 0 for delta lobes.
    pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        match self {
            Bsdf::Diffuse(b) => b.pdf(wo, wi),
            Bsdf::MatteCone(b) => b.pdf(wo, wi),
            Bsdf::OrenNayar(b) => b.pdf(wo, wi),
            Bsdf::Phong(b) => b.pdf(wo, wi),
            Bsdf::BlinnPhong(b) => b.pdf(wo, wi),
            Bsdf::Metal(b) => b.pdf(wo, wi),
            Bsdf::Plastic(b) => b.pdf(wo, wi),
            Bsdf::DiffuseTransmission(b) => b.pdf(wo, wi),
            Bsdf::RoughConductor(b) => b.pdf(wo, wi),
            Bsdf::RoughDielectric(b) => b.pdf(wo, wi),
            Bsdf::Compound(b) => b.pdf(wo, wi),
            Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) => SolidAnglePdf::ZERO,
        }
    }

    /// A direction for `wo`, from the uniform numbers `choice` (which lobe) and `u` (where in it).
    ///
    /// `None` where nothing is scattered.
    pub fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        // What is long is out of line: in here it would cost the short models stack and saved registers.
        match self {
            Bsdf::Diffuse(b) => b.sample(wo, u),
            Bsdf::MatteCone(b) => b.sample(wo, u),
            Bsdf::Mirror(b) => b.sample(wo),
            Bsdf::Conductor(b) => b.sample(wo),
            Bsdf::Dielectric(b) => b.sample(wo, choice, mode),
            Bsdf::OrenNayar(b) => b.sample(wo, u),
            Bsdf::Phong(b) => b.sample(wo, u),
            Bsdf::BlinnPhong(b) => b.sample(wo, u),
            Bsdf::Metal(b) => b.sample(wo, u),
            Bsdf::Plastic(b) => b.sample(wo, choice, u),
            Bsdf::DiffuseTransmission(b) => b.sample(wo, choice, u),
            Bsdf::RoughConductor(b) => b.sample(wo, choice, u),
            Bsdf::RoughDielectric(b) => b.sample(wo, choice, u, mode),
            Bsdf::ThinDielectric(b) => b.sample(wo, choice),
            Bsdf::Compound(b) => b.sample(wo, choice, u, mode),
        }
    }

    /// The single directions into which a share of the light goes, with that share as weight.
    pub fn delta_lobes(&self, wo: Local, mode: TransportMode) -> impl Iterator<Item = BsdfSample> + use<> {
        let lobes = match self {
            Bsdf::MatteCone(b) => [b.delta_lobe(wo), None],
            Bsdf::Metal(b) => [b.delta_lobe(wo), None],
            Bsdf::Plastic(b) => [b.delta_lobe(wo), None],
            Bsdf::Mirror(b) => [b.sample(wo), None],
            Bsdf::Conductor(b) => [b.sample(wo), None],
            Bsdf::Dielectric(b) => b.delta_lobes(wo, mode),
            Bsdf::ThinDielectric(b) => b.delta_lobes(wo),
            Bsdf::Diffuse(_) | Bsdf::OrenNayar(_) | Bsdf::Phong(_) | Bsdf::BlinnPhong(_) | Bsdf::DiffuseTransmission(_) => [None, None],
            Bsdf::RoughConductor(_) | Bsdf::RoughDielectric(_) => [None, None],
            Bsdf::Compound(b) => return b.delta_lobes(wo, mode).0.into_iter(),
        };
        DeltaLobes::from(lobes).0.into_iter()
    }

    /// The same surface of a body that took light on the way to it; a metal has no inside.
    fn dimmed(self, left: Spectrum) -> Bsdf<'a> {
        match self {
            Bsdf::Dielectric(b) => Bsdf::Dielectric(Dielectric { color: b.color * left, ..b }),
            Bsdf::RoughDielectric(b) => Bsdf::RoughDielectric(RoughDielectric { color: b.color * left, ..b }),
            other => other,
        }
    }

    /// What materials of this model are called in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Bsdf::Diffuse(_) => "diffuse",
            Bsdf::Mirror(_) => "mirror",
            Bsdf::Conductor(_) | Bsdf::RoughConductor(_) => "conductor",
            Bsdf::Dielectric(_) | Bsdf::RoughDielectric(_) => "dielectric",
            Bsdf::MatteCone(_) => "matte_cone",
            Bsdf::OrenNayar(_) => "oren_nayar",
            Bsdf::Phong(_) => "phong",
            Bsdf::BlinnPhong(_) => "blinn_phong",
            Bsdf::Metal(_) => "metal",
            Bsdf::Plastic(_) => "plastic",
            Bsdf::DiffuseTransmission(_) => "diffuse_transmission",
            Bsdf::ThinDielectric(_) => "thin_dielectric",
            Bsdf::Compound(met) => met.compound.name(),
        }
    }

    /// Whether there is anything that [`Bsdf::eval`] sees.
    pub fn has_smooth_lobe(&self) -> bool {
        match self {
            Bsdf::Diffuse(_) | Bsdf::OrenNayar(_) | Bsdf::Phong(_) | Bsdf::BlinnPhong(_) => true,
            Bsdf::Plastic(_) | Bsdf::DiffuseTransmission(_) | Bsdf::RoughConductor(_) | Bsdf::RoughDielectric(_) => true,
            Bsdf::MatteCone(b) => !b.is_mirror(),
            Bsdf::Metal(b) => !b.is_mirror(),
            Bsdf::Compound(b) => b.has_smooth_lobe(),
            Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) => false,
        }
    }

    /// Whether f(wo, wi) = f(wi, wo) (transmission: up to η²); `false` is a fact of the model, stated, not a bug.
    pub fn reciprocal(&self) -> bool {
        match self {
            Bsdf::Diffuse(_) | Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) => true,
            Bsdf::OrenNayar(_) | Bsdf::Plastic(_) | Bsdf::DiffuseTransmission(_) => true,
            Bsdf::RoughConductor(_) | Bsdf::RoughDielectric(_) | Bsdf::ThinDielectric(_) => true,
            Bsdf::MatteCone(b) => b.is_mirror(),
            Bsdf::Metal(b) => b.is_mirror(),
            Bsdf::Phong(_) | Bsdf::BlinnPhong(_) => false,
            Bsdf::Compound(b) => b.reciprocal(),
        }
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
