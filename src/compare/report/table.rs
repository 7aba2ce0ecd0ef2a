//! The numbers: `convergence.csv` for tables, `convergence.json` for programs.

use std::fmt::Write as _;

use serde::Serialize;

use super::escape;
use crate::compare::{Comparison, Cost, Measurement, Method, Point, TARGETS};
use crate::error::{Error, Result};
use crate::measure::relative::EPSILON;

/// What the columns mean.
#[derive(Serialize)]
struct Formulas {
    mse: &'static str,
    relmse: &'static str,
    trimmed: &'static str,
    epsilon: String,
    error: &'static str,
    slope: &'static str,
    seconds: &'static str,
}

fn formulas() -> Formulas {
    Formulas {
        mse: "1/3P Σ ((x − r)² − v) over P pixels x and three colours, r the reference, v its own variance",
        relmse: "1/3P Σ ((x − r)² − v) / (r² + ε)",
        trimmed: "relmse without the 0.1 % of the pixels that add most",
        epsilon: format!("ε = {EPSILON} · mean(r)²"),
        error: "√relmse",
        slope: "b of relmse ~ seconds⁻ᵇ; 1 for Monte Carlo",
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

/// Comment lines (`#`) with the formulas, a header, a row for each measurement, and one for the mean of each checkpoint.
pub fn csv(comparison: &Comparison) -> Vec<u8> {
    let mut text = String::new();
    for line in formulas().lines() {
        text.push_str(&format!("# {line}\n"));
    }
    text.push_str("method,replicate,spp,seconds,mse,relmse,trimmed,mse_stderr,relmse_stderr,trimmed_stderr\n");
    for method in &comparison.methods {
        let name = escape::csv(&method.name);
        for Measurement { replicate, samples, seconds, mse, relmse, trimmed } in &method.measurements {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name},{replicate},{samples},{seconds},{mse},{relmse},{trimmed},,,");
        }
        for Point { samples, seconds, mse, relmse, trimmed } in &method.curve {
            let values = format!("{},{},{},{},{},{}", mse.0, relmse.0, trimmed.0, mse.1, relmse.1, trimmed.1);
            let _ = writeln!(text, "{name},mean,{samples},{seconds},{values}");
        }
    }
    text.into_bytes()
}

#[derive(Serialize)]
struct Document<'a> {
    scene: &'a str,
    reference: ReferenceRow<'a>,
    confidence: f64,
    formulas: Formulas,
    conclusions: &'a [String],
    methods: Vec<MethodRow<'a>>,
}

#[derive(Serialize)]
struct ReferenceRow<'a> {
    origin: &'a str,
    error: Option<f64>,
}

#[derive(Serialize)]
struct MethodRow<'a> {
    name: &'a str,
    integrator: &'a str,
    sampler: &'a str,
    slope: Option<Estimate>,
    bias: Option<Estimate>,
    prices: Vec<PriceRow>,
    lacks: &'a str,
    measurements: Vec<MeasurementRow>,
    points: Vec<PointRow>,
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

/// All but the target are null where no time buys the error.
#[derive(Serialize)]
struct PriceRow {
    error: f64,
    seconds: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    extrapolated: Option<bool>,
}

#[derive(Serialize)]
struct MeasurementRow {
    replicate: u32,
    spp: u64,
    seconds: f64,
    mse: f64,
    relmse: f64,
    trimmed: f64,
}

#[derive(Serialize)]
struct PointRow {
    spp: u64,
    seconds: f64,
    mse: Estimate,
    relmse: Estimate,
    trimmed: Estimate,
}

/// All of a comparison but its pictures. A value that is no number is `null`.
pub fn json(comparison: &Comparison) -> Result<Vec<u8>> {
    let document = Document {
        scene: &comparison.scene,
        reference: ReferenceRow { origin: &comparison.reference.origin, error: comparison.reference.error },
        confidence: comparison.confidence,
        formulas: formulas(),
        conclusions: &comparison.conclusions,
        methods: comparison.methods.iter().map(method).collect(),
    };
    let mut bytes = serde_json::to_vec_pretty(&document).map_err(|e| Error::Internal(format!("cannot write JSON: {e}")))?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn method(method: &Method) -> MethodRow<'_> {
    let price = |(error, cost): (f64, Option<Cost>)| PriceRow {
        error,
        seconds: cost.map(|c| c.seconds),
        low: cost.map(|c| c.low),
        high: cost.map(|c| c.high),
        extrapolated: cost.map(|c| c.extrapolated),
    };
    let measurement = |m: &Measurement| MeasurementRow {
        replicate: m.replicate,
        spp: m.samples,
        seconds: m.seconds,
        mse: m.mse,
        relmse: m.relmse,
        trimmed: m.trimmed,
    };
    let point =
        |p: &Point| PointRow { spp: p.samples, seconds: p.seconds, mse: p.mse.into(), relmse: p.relmse.into(), trimmed: p.trimmed.into() };
    MethodRow {
        name: &method.name,
        integrator: &method.integrator,
        sampler: &method.sampler,
        slope: method.slope.map(Into::into),
        bias: method.bias.map(Into::into),
        prices: TARGETS.into_iter().zip(method.prices.iter().copied()).map(price).collect(),
        lacks: &method.lacks,
        measurements: method.measurements.iter().map(measurement).collect(),
        points: method.curve.iter().map(point).collect(),
    }
}
