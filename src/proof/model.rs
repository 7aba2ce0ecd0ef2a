//! Interface of a model under test.

use std::fmt::Debug;

use glam::Vec2;

use crate::bsdf::{Bsdf, BsdfSample, TransportMode};
use crate::math::{Local, SolidAnglePdf, Spectrum};

/// A scattering model under test, of pt or of another crate.
///
/// The conventions are those of [`pt::bsdf`](crate::bsdf): directions are unit, local, and point away from the surface; the cosine
/// is inside `eval`; `eval` and `pdf` are 0 for delta lobes. Reports name the model by its `Debug` text.
pub trait Model: Debug + Send + Sync {
    /// f(wo, wi)·|cos θi| [sr⁻¹].
    fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum;

    /// Density with which [`sample`](Model::sample) returns `wi` [sr⁻¹].
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf;

    /// Samples a direction for `wo`; `None` if this sample fails.
    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample>;

    /// All delta lobes, with their share of the light as weight.
    fn delta_lobes(&self, _wo: Local, _mode: TransportMode) -> Vec<BsdfSample> {
        vec![]
    }

    /// Whether the model claims f(a, b) = f(b, a), up to η² through the surface.
    fn reciprocal(&self) -> bool {
        true
    }

    /// Whether `sample` reaches each direction from only one `u`, with `choice` selecting the lobe.
    ///
    /// The density is then exactly the probability of the lobe over the Jacobian. If several ways lead to one direction, it is
    /// larger.
    fn one_to_one(&self) -> bool {
        false
    }
}

impl Model for Bsdf<'_> {
    fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        Bsdf::eval(self, wo, wi, mode)
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        Bsdf::pdf(self, wo, wi)
    }

    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        Bsdf::sample(self, wo, choice, u, mode)
    }

    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> Vec<BsdfSample> {
        Bsdf::delta_lobes(self, wo, mode).collect()
    }

    fn reciprocal(&self) -> bool {
        Bsdf::reciprocal(self)
    }

    fn one_to_one(&self) -> bool {
        matches!(self, Bsdf::Diffuse(_) | Bsdf::OrenNayar(_) | Bsdf::Phong(_))
    }
}
