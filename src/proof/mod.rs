//! Tests of the laws of scattering, for pt's own models and those of other crates.
//!
//! Implement [`Model`] and call [`prove`]. The [`Report`] has one block per law and, where a law is broken, a counter-example: the
//! inputs with all their digits, the expected result, the result, and its certainty. `examples/prove_my_bsdf.rs` is a full example.
//!
//! | law | what it demands | finds |
//! |---|---|---|
//! | `inputs` | finite and sensible for every input, also the worst | NaN at grazing angles, holes at the corners of the square |
//! | `weight` | weight = f·\|cos θi\| / pdf, and the density is `pdf`'s | a cosine missing in one place |
//! | `integral` | ∫ pdf + failures + delta lobes = 1 | a wrong normalisation |
//! | `chi2` | samples follow `pdf` | the density of another half vector |
//! | `jacobian` | pdf = probability of the lobe / \|∂ω/∂u\| | a missing Jacobian, and where |
//! | `reciprocity` | f(a, b) = f(b, a), f/η² through the surface | a cosine too few or too many, η not inverted |
//! | `energy` | albedo ≤ 1 | a model that emits light |
//! | `furnace` | albedo = 1, where that is claimed | lost energy |
//! | `delta` | delta lobes match the sampling, and lead back | a wrong Fresnel reflectance |
//!
//! The laws of one input ([`inputs_at`], [`weight_at`], [`reciprocity_at`]) are functions of their own. With the feature
//! `proptest`, `pt::proof::strategies` generates their inputs, so that a counter-example shrinks to a simple one.
//!
//! Statistical laws share [`Options::alpha`] (Šidák): over all laws, incidences and models of a suite together, a right model is
//! refused with that probability. Seeds are fixed, so that a result can be repeated.

mod chi2;
mod laws;
mod model;
mod options;
mod quadrature;
mod rect;
mod report;
mod rounding;
mod sampled_directions;
#[cfg(feature = "proptest")]
pub mod strategies;

use rayon::prelude::*;

use crate::measure::sidak;

pub use chi2::{Chi2, chi2};
pub use laws::{LAWS, Law, inputs_at, reciprocity_at, weight_at};
pub use model::Model;
pub use options::{Furnace, Options, at, incidences};
pub use rect::Rect;
pub use report::{CERTAIN, CounterExample, Finding, Report, Verdict};
pub use sampled_directions::{Division, FINE, SampledDirections, SampledLobe};

/// A model under test, with the directions sampled from it at each incidence.
pub struct Case<'a> {
    /// The model.
    pub model: &'a dyn Model,
    /// Settings of the test.
    pub options: &'a Options,
    /// Sampled directions, for each incidence.
    pub sampled: Vec<SampledDirections>,
}

/// Three divisions, an integral, three coefficients of an albedo, reflection and transmission.
const TESTS_PER_INCIDENCE: usize = 9;

impl<'a> Case<'a> {
    /// Samples the model at every incidence.
    pub fn new(model: &'a dyn Model, options: &'a Options) -> Case<'a> {
        let sampled =
            options.incidences.par_iter().enumerate().map(|(i, &wo)| SampledDirections::new(model, wo, i as u64, options)).collect();
        Case { model, options, sampled }
    }

    /// Level of each single statistical test.
    pub fn level(&self) -> f64 {
        sidak(self.options.alpha, self.sampled.len() * TESTS_PER_INCIDENCE * self.options.suite.max(1))
    }

    /// Tests every law.
    pub fn report(&self) -> Report {
        let findings = LAWS.par_iter().map(|law| law.test(self)).collect();
        Report { model: format!("{:?}", self.model), alpha: self.options.alpha, findings }
    }
}

/// Tests a model against every law.
///
/// Tests: pt's own models pass; five deliberate bugs are refused; false alarms are as frequent as they may be.
pub fn prove(model: &dyn Model, options: &Options) -> Report {
    Case::new(model, options).report()
}
