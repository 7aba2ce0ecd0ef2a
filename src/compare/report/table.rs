//! Numbers of a comparison: `convergence.csv` for tables, `convergence.json` for programs.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use crate::compare::{CheckpointStats, Comparison, Cost, CostKind, Measurement, Method, NoPrice, Provenance, Reference, Ring, TARGETS};
use crate::error::{Error, Result};
use crate::measure::Metric;
use crate::measure::error::EPSILON;
use crate::output;
use crate::output::page;

/// Formulas of the columns.
#[derive(Serialize)]
struct Formulas {
    mse: &'static str,
    relmse: &'static str,
    trimmed: &'static str,
    epsilon: String,
    error: &'static str,
    slope: &'static str,
    spectrum: &'static str,
    seconds: &'static str,
}

fn formulas() -> Formulas {
    Formulas {
        mse: "1/3P Σ ((x − r)² − v) over P pixels x and three colours, r the reference, v its own variance",
        relmse: "1/3P Σ ((x − r)² − v) / (r² + ε)",
        trimmed: "relmse without the 0.1 % of the pixels that add most",
        epsilon: format!("ε = {EPSILON} · mean(r)²"),
        error: "√relmse",
        slope: "s of error ~ secondsˢ; −1/2 for Monte Carlo",
        spectrum: "power |FFT(x − r)|²/N over N pixels, less the noise of r, over mean(r)², averaged over rings of periods (pixels) up to √2 times as long",
        seconds: "of rendering, wall clock, all threads; spp are samples per pixel",
    }
}

impl Formulas {
    fn lines(&self) -> [String; 5] {
        [
            format!("mse = {}", self.mse),
            format!("relmse = {}, {}", self.relmse, self.epsilon),
            format!("trimmed = {}", self.trimmed),
            format!("seconds: {}", self.seconds),
            "replicate `mean`: the mean of all replicates and, in the last columns, its standard errors".into(),
        ]
    }
}

/// Returns the CSV: comment lines (`#`) with the formulas, a header, a row for each measurement, and one for the mean of each
/// checkpoint.
pub fn csv(comparison: &Comparison) -> Vec<u8> {
    let mut text = String::new();
    for line in formulas().lines() {
        text.push_str(&format!("# {line}\n"));
    }
    for metric in &comparison.metrics {
        text.push_str(&format!("# {} = {}\n", metric.name(), metric.formula()));
    }
    let own = ["mse", "relmse", "trimmed"].map(str::to_owned).into_iter();
    let columns: Vec<String> = own.chain(comparison.metrics.iter().map(Metric::name)).collect();
    let joined = |suffix: &str| columns.iter().map(|name| page::csv(&format!("{name}{suffix}"))).collect::<Vec<_>>().join(",");
    text.push_str(&format!("method,replicate,spp,seconds,{},{}\n", joined(""), joined("_stderr")));
    for method in &comparison.methods {
        let name = page::csv(&method.name);
        // Empty where the samples are not known.
        let spp = |samples: u64| method.spp(samples).map_or(String::new(), |samples| samples.to_string());
        for Measurement { replicate, samples, seconds, mse, relmse, trimmed, others } in &method.measurements {
            let values = row([*mse, *relmse, *trimmed].into_iter().chain(others.iter().copied()));
            let no_errors = ",".repeat(columns.len());
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name},{replicate},{},{seconds},{values}{no_errors}", spp(*samples));
        }
        for CheckpointStats { samples, seconds, mse, relmse, trimmed, others } in &method.curve {
            let values = || [*mse, *relmse, *trimmed].into_iter().chain(others.iter().copied());
            let (means, errors) = (row(values().map(|value| value.0)), row(values().map(|value| value.1)));
            let _ = writeln!(text, "{name},mean,{},{seconds},{means},{errors}", spp(*samples));
        }
    }
    text.into_bytes()
}

fn row(values: impl Iterator<Item = f64>) -> String {
    values.map(|value| value.to_string()).collect::<Vec<_>>().join(",")
}

#[derive(Serialize)]
struct Document<'a> {
    scene: &'a str,
    reference: ReferenceRow<'a>,
    confidence: f64,
    formulas: Formulas,
    /// Additional measures by name, with their formulas.
    metrics: BTreeMap<String, String>,
    conclusions: Vec<ConclusionRow<'a>>,
    methods: Vec<MethodRow<'a>>,
    provenance: &'a Provenance,
}

#[derive(Serialize)]
struct ConclusionRow<'a> {
    text: &'a str,
    /// Command that shows it.
    command: Option<&'a str>,
}

#[derive(Serialize)]
struct ReferenceRow<'a> {
    origin: &'a str,
    /// The reference's own relative error and its interval; null if they cannot be stated.
    error: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    /// Whether the error can be stated; null if nothing is known of it.
    established: Option<bool>,
}

fn reference(reference: &Reference, confidence: f64) -> ReferenceRow<'_> {
    let stated = reference.error.and_then(|error| error.stated(confidence).ok());
    ReferenceRow {
        origin: &reference.origin,
        error: stated.map(|error| error.value),
        low: stated.map(|error| error.low),
        high: stated.map(|error| error.high),
        established: reference.error.map(|error| error.refusal().is_none()),
    }
}

#[derive(Serialize)]
struct MethodRow<'a> {
    name: &'a str,
    integrator: &'a str,
    sampler: &'a str,
    /// Hash of the mean of all replicates.
    hash: String,
    /// Files of pictures that were given.
    files: &'a [String],
    slope: Option<Estimate>,
    bias: Option<Estimate>,
    /// Error that the bias does not exceed.
    bias_bound: Option<f64>,
    prices: Vec<PriceRow>,
    lacks: &'a str,
    measurements: Vec<MeasurementRow>,
    points: Vec<PointRow>,
    spectrum: Vec<RingRow>,
}

#[derive(Serialize)]
struct RingRow {
    /// Pixels.
    period: f64,
    power: Estimate,
    frequencies: usize,
}

#[derive(Serialize)]
struct Estimate {
    value: f64,
    stderr: f64,
}

impl From<(f64, f64)> for Estimate {
    fn from((value, stderr): (f64, f64)) -> Estimate {
        Estimate { value, stderr }
    }
}

/// Either the time or the reason why none is stated is null.
#[derive(Serialize)]
struct PriceRow {
    error: f64,
    seconds: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    extrapolated: Option<bool>,
    /// Whether the time is only an upper bound.
    at_most: Option<bool>,
    reason: Option<&'static str>,
}

#[derive(Serialize)]
struct MeasurementRow {
    replicate: u32,
    /// Null for pictures from files, as in `points`.
    spp: Option<u64>,
    seconds: f64,
    mse: f64,
    relmse: f64,
    trimmed: f64,
    #[serde(flatten)]
    others: BTreeMap<String, f64>,
}

#[derive(Serialize)]
struct PointRow {
    spp: Option<u64>,
    seconds: f64,
    mse: Estimate,
    relmse: Estimate,
    trimmed: Estimate,
    #[serde(flatten)]
    others: BTreeMap<String, Estimate>,
}

/// Returns all of a comparison except its pictures as JSON. A value that is not finite is `null`.
pub fn json(comparison: &Comparison) -> Result<Vec<u8>> {
    let document = Document {
        scene: &comparison.scene,
        reference: reference(&comparison.reference, comparison.confidence),
        confidence: comparison.confidence,
        formulas: formulas(),
        metrics: comparison.metrics.iter().map(|metric| (metric.name(), metric.formula())).collect(),
        conclusions: comparison.conclusions.iter().map(|one| ConclusionRow { text: &one.text, command: one.command.as_deref() }).collect(),
        methods: comparison.methods.iter().map(|one| method(one, &comparison.metrics)).collect(),
        provenance: &comparison.provenance,
    };
    let mut bytes = serde_json::to_vec_pretty(&document).map_err(|e| Error::Internal(format!("cannot write JSON: {e}")))?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn method<'m>(method: &'m Method, metrics: &[Metric]) -> MethodRow<'m> {
    let row = |error: f64, cost: Option<Cost>, reason: Option<NoPrice>| PriceRow {
        error,
        seconds: cost.map(|c| c.seconds),
        low: cost.map(|c| c.low),
        high: cost.map(|c| c.high),
        extrapolated: cost.map(|c| c.kind == CostKind::Extrapolated),
        at_most: cost.map(|c| c.kind == CostKind::AtMost),
        reason: reason.map(NoPrice::name),
    };
    let price = |(error, price): (f64, Result<Cost, NoPrice>)| row(error, price.ok(), price.err());
    let measurement = |m: &Measurement| MeasurementRow {
        replicate: m.replicate,
        spp: method.spp(m.samples),
        seconds: m.seconds,
        mse: m.mse,
        relmse: m.relmse,
        trimmed: m.trimmed,
        others: metrics.iter().map(Metric::name).zip(m.others.iter().copied()).collect(),
    };
    let point = |p: &CheckpointStats| PointRow {
        spp: method.spp(p.samples),
        seconds: p.seconds,
        mse: p.mse.into(),
        relmse: p.relmse.into(),
        trimmed: p.trimmed.into(),
        others: metrics.iter().map(Metric::name).zip(p.others.iter().copied().map(Estimate::from)).collect(),
    };
    let ring = |ring: &Ring| RingRow { period: ring.period, power: (ring.power, ring.deviation).into(), frequencies: ring.frequencies };
    MethodRow {
        name: &method.name,
        integrator: &method.integrator,
        sampler: &method.sampler,
        files: &method.files,
        hash: output::hash(&method.image).to_string(),
        slope: method.slope.map(Into::into),
        bias: method.bias.map(Into::into),
        bias_bound: method.bias_bound,
        prices: TARGETS.into_iter().zip(method.prices.iter().copied()).map(price).collect(),
        lacks: &method.lacks,
        measurements: method.measurements.iter().map(measurement).collect(),
        points: method.curve.iter().map(point).collect(),
        spectrum: method.spectrum.iter().map(ring).collect(),
    }
}
