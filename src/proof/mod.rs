//! Proves that a scattering model is what it says: for pt's own models, and for anyone's.
//!
//! Implement [`Model`] and call [`prove`]; the [`Report`] prints one block per law, and where a law is
//! broken, a counter-example: the inputs with all their digits, what was expected, what was found, and
//! how sure that is. `examples/prove_my_bsdf.rs` does so in full.
//!
//! | law | what it demands | finds |
//! |---|---|---|
//! | `inputs` | finite and sensible for every input, also the worst | NaN at grazing angles, holes at the corners of the square |
//! | `weight` | weight = f·\|cos θi\| / pdf, and the density is `pdf`'s | a cosine missing in one place |
//! | `integral` | ∫ pdf + failures + delta lobes = 1 | a wrong normalisation |
//! | `chi2` | samples follow `pdf` | the density of another half vector |
//! | `jacobian` | pdf = chance of the lobe / \|∂ω/∂u\| | a forgotten Jacobian, and where |
//! | `reciprocity` | f(a, b) = f(b, a), f/η² through the surface | a cosine too few or too many, η not inverted |
//! | `energy` | albedo ≤ 1 | a model that shines |
//! | `furnace` | albedo = 1, where that is claimed | energy lost |
//! | `delta` | delta lobes are what sampling chooses from, and lead back | a wrong Fresnel share |
//!
//! The laws of one input ([`inputs_at`], [`weight_at`], [`reciprocity_at`]) are functions of their own. With the feature
//! `proptest`, `pt::proof::strategies` generates their inputs, so that a counter-example shrinks to a simple one.
//!
//! Statistical laws share [`Options::alpha`] (Šidák): a right model is refused with that probability over all
//! laws, incidences and models of a suite together. Seeds are fixed, so that a proof once found stays.

mod chi2;
mod drawn;
mod laws;
mod model;
mod options;
mod quadrature;
mod rect;
mod report;
#[cfg(feature = "proptest")]
pub mod strategies;

use rayon::prelude::*;

use crate::measure::sidak;

pub use chi2::{Chi2, chi2};
pub use drawn::{Division, Drawn, DrawnLobe, FINE};
pub use laws::{LAWS, Law, inputs_at, reciprocity_at, weight_at};
pub use model::Model;
pub use options::{Furnace, Options, at, incidences};
pub use rect::Rect;
pub use report::{CERTAIN, CounterExample, Finding, Report, Verdict};

/// A model under proof, with what was drawn from it at each incidence.
pub struct Case<'a> {
    pub model: &'a dyn Model,
    pub options: &'a Options,
    pub drawn: Vec<Drawn>,
}

/// Three divisions, an integral, three coefficients of an albedo, reflection and transmission.
const TESTS_PER_INCIDENCE: usize = 9;

impl<'a> Case<'a> {
    pub fn new(model: &'a dyn Model, options: &'a Options) -> Case<'a> {
        let drawn = options.incidences.par_iter().enumerate().map(|(i, &wo)| Drawn::new(model, wo, i as u64, options)).collect();
        Case { model, options, drawn }
    }

    /// Of each single statistical test.
    pub fn level(&self) -> f64 {
        sidak(self.options.alpha, self.drawn.len() * TESTS_PER_INCIDENCE * self.options.suite.max(1))
    }

    /// The outcome of every law.
    pub fn report(&self) -> Report {
        let findings = LAWS.par_iter().map(|law| law.test(self)).collect();
        Report { model: format!("{:?}", self.model), alpha: self.options.alpha, findings }
    }
}

/// Puts a model to every law.
///
/// Tests: pt's own models pass; five deliberate bugs are refused; false alarms are as frequent as they may be.
pub fn prove(model: &dyn Model, options: &Options) -> Report {
    Case::new(model, options).report()
}
