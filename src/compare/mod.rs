//! Comparison of methods on one scene, or on several versions of a scene: what accuracy costs in time (`pt compare`).
//!
//! Every method renders the scene several times with different random numbers. The methods take turns, so that a machine that slows
//! down slows all of them. At doubling checkpoints each picture is measured against a reference.

mod bias;
mod commands;
mod conclude;
mod configs;
mod curve;
mod given;
mod method;
mod price;
mod provenance;
mod reference;
mod reference_renderer;
pub mod replay;
mod replicates;
pub mod report;
pub mod run;
mod snapshot;
mod spectrum;
#[cfg(test)]
mod synthetic;

use std::sync::Arc;

use crate::film::{FilmSpec, Image};
use crate::integrator::Integrator;
use crate::measure::Metric;
use crate::sampler::SamplerSpec;
use crate::scene::Scene;

pub use crate::measure::format::TARGETS;
pub use commands::{Commands, Conclusion};
pub use conclude::conclusions;
pub use configs::configs;
pub use given::{GivenPicture, given};
pub use provenance::Provenance;
pub use reference::Reference;
pub use reference_renderer::{CachedReference, ReferenceRenderer};
pub use run::{Budget, Follower, run};
pub use snapshot::Snapshot;
pub use spectrum::{Ring, error_spectrum};

/// Results of a comparison, as the report needs them.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Name of the scene file, without folder and extension.
    pub scene: String,
    /// Reference of all measurements.
    pub reference: Reference,
    /// The methods.
    pub methods: Vec<Method>,
    /// Additional error measures.
    pub metrics: Vec<Metric>,
    /// Confidence of all intervals.
    pub confidence: f64,
    /// Conclusions.
    pub conclusions: Vec<Conclusion>,
    /// How the comparison was made.
    pub provenance: Provenance,
}

/// A way to render a scene.
#[derive(Clone)]
pub struct MethodConfig {
    /// Name in the report.
    pub name: String,
    /// What it renders.
    pub scene: Arc<dyn Scene>,
    /// Film of its pictures, whose pixels are those of all other methods.
    pub spec: FilmSpec,
    /// File of the scene, quoted for a shell; `None` for the scene of the comparison.
    pub scene_file: Option<String>,
    /// Name of the integrator.
    pub integrator_name: String,
    /// Name of the sampler.
    pub sampler_name: String,
    /// The integrator.
    pub integrator: Arc<dyn Integrator>,
    /// The sampler.
    pub sampler: SamplerSpec,
    /// Samples per pixel at most, if fewer than [`Budget::samples`].
    pub most: Option<u64>,
    /// Effects that the scene needs and the integrator leaves out, in words.
    pub lacks: String,
}

/// A way to render the scene, with its results.
#[derive(Clone, Debug)]
pub struct Method {
    /// `nee`, or `nee · sobol` if samplers are compared too.
    pub name: String,
    /// Name of the integrator.
    pub integrator: String,
    /// Name of the sampler.
    pub sampler: String,
    /// Measurements, one per replicate and checkpoint.
    pub measurements: Vec<Measurement>,
    /// Statistics of the checkpoints, in order of samples.
    pub curve: Vec<CheckpointStats>,
    /// Mean of all replicates after the last checkpoint, with standard errors from their variance.
    pub image: Image,
    /// Picture of one replicate after the last checkpoint, as a user would get it.
    pub sample: Image,
    /// Pictures of that replicate at its last checkpoints, in order of samples; the last one is [`Method::sample`].
    pub snapshots: Vec<Snapshot>,
    /// Spectrum of the errors of the replicates after the last checkpoint, from short periods to long ones.
    pub spectrum: Vec<Ring>,
    /// Exponent s in √relMSE ~ secondsˢ, with its standard error; `None` for fewer than three checkpoints.
    pub slope: Option<(f64, f64)>,
    /// Bias: √relMSE that more samples do not remove, with its standard error; `None` if none can be detected.
    pub bias: Option<(f64, f64)>,
    /// √relMSE that the bias does not exceed, whether one can be detected or not; `None` if nothing is known of it.
    pub bias_bound: Option<f64>,
    /// Time that an error takes, for each of [`TARGETS`], or the reason why none is stated.
    pub prices: Vec<Result<Cost, NoPrice>>,
    /// Effects that the scene needs and the method leaves out, in words; empty if there are none.
    pub lacks: String,
    /// File of the scene that it renders, quoted for a shell; `None` for the scene of the comparison, of which the reference is.
    pub scene_file: Option<String>,
    /// Files of its pictures, quoted for a shell; empty for a method that is rendered. The samples of such pictures are not known:
    /// numbers of samples are then places in the order of time.
    pub files: Vec<String>,
}

impl Method {
    /// Samples per pixel of a checkpoint; `None` for pictures from files.
    pub fn spp(&self, samples: u64) -> Option<u64> {
        self.files.is_empty().then_some(samples)
    }
}

/// Time that an error takes, with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Render time (seconds).
    pub seconds: f64,
    /// Lower end of the interval (seconds); 0 for a bound.
    pub low: f64,
    /// Upper end of the interval (seconds).
    pub high: f64,
    /// How the time is known.
    pub kind: CostKind,
}

/// How a time is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CostKind {
    /// It lies between checkpoints.
    Measured,
    /// It lies beyond the last checkpoint.
    Extrapolated,
    /// The first checkpoint is there already: the time is an upper bound.
    AtMost,
}

/// Reason why no time is stated for an error. The module `price` has the criteria.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoPrice {
    /// The method's bias is at least as large: it never gets there.
    Bias,
    /// The method leaves something out, and the data do not exclude a bias as large as the error.
    Lacks,
    /// The reference is not known to be closer to the truth than the error.
    Reference,
    /// A few pixels hold most of the method's error.
    FewPixels,
    /// The error does not fall with time.
    Rising,
    /// The replicates disagree on the time.
    Spread,
    /// There is a single picture, whose error has no interval.
    Single,
}

impl NoPrice {
    /// The reason in a few words, for tables.
    pub fn name(self) -> &'static str {
        match self {
            NoPrice::Bias => "never: bias",
            NoPrice::Lacks => "not known to get there",
            NoPrice::Reference => "reference too coarse",
            NoPrice::FewPixels => "not established: few pixels",
            NoPrice::Rising => "not established: error grows",
            NoPrice::Spread => "not established: renders differ",
            NoPrice::Single => "not established: one picture",
        }
    }
}

/// Errors of one picture at one checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Index of the replicate.
    pub replicate: u32,
    /// Samples per pixel.
    pub samples: u64,
    /// Render time, with all threads.
    pub seconds: f64,
    /// Σ(x − r)²/3P, less the reference's own variance; it may be negative if both pictures are equally good.
    pub mse: f64,
    /// Relative error: the squares of `mse` are divided by r² + ε.
    pub relmse: f64,
    /// relMSE without the largest 0.1 % of the pixels.
    pub trimmed: f64,
    /// Values of [`Comparison::metrics`], which take the reference as the truth.
    pub others: Vec<f64>,
}

/// Statistics of all replicates of a method at one checkpoint. Each pair is a mean and its standard error.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckpointStats {
    /// Samples per pixel.
    pub samples: u64,
    /// Mean render time.
    pub seconds: f64,
    /// Mean squared error.
    pub mse: (f64, f64),
    /// Relative mean squared error.
    pub relmse: (f64, f64),
    /// Trimmed relMSE.
    pub trimmed: (f64, f64),
    /// Values of [`Comparison::metrics`].
    pub others: Vec<(f64, f64)>,
}
