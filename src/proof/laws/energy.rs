//! Laws of energy: a model makes no light and, where that is claimed, loses none.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{Case, Outcome, chance, show};
use crate::measure::Mean;
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::{Furnace, SampledDirections};

/// Tolerance for the rounding of the albedo of a lossless model.
const ROUNDING: f64 = 1e-5;

/// Tests the law `energy`.
pub fn energy(case: &Case) -> Outcome {
    let level = case.level();
    let bright = |sampled: &&SampledDirections| sampled.albedo.iter().any(|mean| chance_above(mean, 1.0 + ROUNDING) < level);
    let refusal = case.sampled.iter().find(bright).map(|sampled| {
        let worst = *brightest(sampled);
        refuse(sampled, "an albedo of at most 1".into(), &worst, chance_above(&worst, 1.0 + ROUNDING), level)
    });
    Outcome::new(refusal, case.sampled.iter().map(albedo).collect())
}

/// Tests the law `furnace`.
pub fn furnace(case: &Case) -> Outcome {
    let Furnace::Lossless(tolerance) = case.options.furnace else {
        return Outcome::exempt("the model is not claimed to be lossless".into());
    };
    let level = case.level();
    let tolerance = tolerance.max(ROUNDING);
    let p = |mean: &Mean| chance_above(mean, 1.0 + tolerance).min(chance_below(mean, 1.0 - tolerance));
    let wrong =
        case.sampled.iter().flat_map(|sampled| sampled.albedo.iter().map(move |mean| (sampled, mean))).find(|(_, mean)| p(mean) < level);
    let refusal = wrong.map(|(sampled, mean)| refuse(sampled, format!("an albedo of 1 ± {tolerance}"), mean, p(mean), level));
    Outcome::new(refusal, vec![])
}

fn refuse(sampled: &SampledDirections, expected: String, found: &Mean, p: f64, level: f64) -> CounterExample {
    CounterExample {
        inputs: format!("wo = {}", show(sampled.wo)),
        expected,
        found: format!("{:.6} ± {:.1e}, the mean of the weights (importance)", found.value, found.standard_error()),
        sure: if p == 0.0 { CERTAIN.into() } else { chance(p, level, sampled.samples) },
    }
}

/// Probability of a mean at least this large if the true value is `limit`.
fn chance_above(mean: &Mean, limit: f64) -> f64 {
    let z = mean.z(limit);
    if z.is_nan() { 0.0 } else { Normal::standard().sf(z) }
}

fn chance_below(mean: &Mean, limit: f64) -> f64 {
    let z = mean.z(limit);
    if z.is_nan() { 0.0 } else { Normal::standard().cdf(z) }
}

fn brightest(sampled: &SampledDirections) -> &Mean {
    let [r, g, b] = &sampled.albedo;
    [g, b].into_iter().fold(r, |most, mean| if mean.value > most.value { mean } else { most })
}

fn albedo(sampled: &SampledDirections) -> String {
    let [r, g, b] = sampled.albedo.map(|mean| format!("{:.5} ± {:.0e}", mean.value, mean.standard_error()));
    let text = if r == g && g == b { r } else { [r, g, b].join(", ") };
    format!("cos θo {:>6.3}: albedo {text}", sampled.wo.cos())
}
