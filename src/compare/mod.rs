//! What accuracy costs in time, method against method: `pt compare`.
//!
//! Every method renders the same scene several times, each time with other random numbers, interleaved so that a
//! machine that slows down slows all of them. At doubling checkpoints each picture is measured against a reference.

mod conclude;
pub mod curve;
pub mod report;
pub mod run;

use crate::film::Image;
use crate::measure::Metric;

pub use crate::measure::words::TARGETS;
pub use conclude::conclusions;
pub use run::{Contestant, Effort, run};

/// All that was measured, for the report to tell.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Of the scene file, without folder and extension.
    pub scene: String,
    pub reference: Reference,
    pub methods: Vec<Method>,
    /// What else was measured.
    pub metrics: Vec<Metric>,
    /// Of all intervals.
    pub confidence: f64,
    /// What it comes to, a sentence each.
    pub conclusions: Vec<String>,
}

/// What the pictures are measured against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// With `StdErr.R`, `StdErr.G`, `StdErr.B` where it knows its own errors: they are subtracted.
    pub image: Image,
    /// Where it comes from: a file, or how it was computed.
    pub origin: String,
    /// √relMSE of itself, where it knows.
    pub error: Option<f64>,
}

/// One way to render the scene, and how it did.
#[derive(Clone, Debug)]
pub struct Method {
    /// `nee`, or `nee · sobol` where samplers are compared too.
    pub name: String,
    pub integrator: String,
    pub sampler: String,
    /// One per replicate and checkpoint.
    pub measurements: Vec<Measurement>,
    /// What the checkpoints say together, in order of samples.
    pub curve: Vec<Point>,
    /// After the last checkpoint, the mean of all replicates, with the standard errors that their spread tells.
    pub image: Image,
    /// Of one replicate after the last checkpoint: what a user would get.
    pub sample: Image,
    /// relMSE ~ seconds⁻ᵇ: b and its standard error; `None` for fewer than three checkpoints.
    pub slope: Option<(f64, f64)>,
    /// √relMSE at which more samples stop helping: bias. With its standard error; `None` where none can be seen.
    pub bias: Option<(f64, f64)>,
    /// The time that an error takes: one for each of [`TARGETS`].
    pub prices: Vec<Option<Cost>>,
    /// Effects that the scene calls for and the method leaves out, in words; empty for none.
    pub lacks: String,
}

/// Seconds that an error takes, with the interval that holds them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    pub seconds: f64,
    pub low: f64,
    pub high: f64,
    /// Beyond the last checkpoint: foretold, not measured.
    pub extrapolated: bool,
}

/// One picture at one checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    pub replicate: u32,
    /// Per pixel.
    pub samples: u64,
    /// Of rendering, with all threads.
    pub seconds: f64,
    /// Σ(x − r)²/3P, the reference's own variance subtracted; so it may be negative where both are equally good.
    pub mse: f64,
    /// The same over r² + ε.
    pub relmse: f64,
    /// relMSE without the worst 0.1 % of the pixels.
    pub trimmed: f64,
    /// By each of [`Comparison::metrics`]; the reference counts as the truth.
    pub others: Vec<f64>,
}

/// All replicates of a method at one checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub samples: u64,
    /// Mean of the replicates.
    pub seconds: f64,
    /// Mean over the replicates, and its standard error.
    pub mse: (f64, f64),
    pub relmse: (f64, f64),
    pub trimmed: (f64, f64),
    pub others: Vec<(f64, f64)>,
}
