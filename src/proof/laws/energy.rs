//! Light is not made, and where that is claimed, not lost.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{Case, Outcome, chance, show};
use crate::measure::Mean;
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::{Drawn, Furnace};

/// What rounding may add to the albedo of a model that loses nothing.
const ROUNDING: f64 = 1e-5;

pub fn energy(case: &Case) -> Outcome {
    let level = case.level();
    let bright = |drawn: &&Drawn| drawn.albedo.iter().any(|mean| chance_above(mean, 1.0 + ROUNDING) < level);
    let refusal = case.drawn.iter().find(bright).map(|drawn| {
        let worst = *brightest(drawn);
        refuse(drawn, "an albedo of at most 1".into(), &worst, chance_above(&worst, 1.0 + ROUNDING), level)
    });
    Outcome::new(refusal, case.drawn.iter().map(albedo).collect())
}

pub fn furnace(case: &Case) -> Outcome {
    let Furnace::Lossless(tolerance) = case.options.furnace else {
        return Outcome::exempt("the model is not claimed to be lossless".into());
    };
    let level = case.level();
    let tolerance = tolerance.max(ROUNDING);
    let p = |mean: &Mean| chance_above(mean, 1.0 + tolerance).min(chance_below(mean, 1.0 - tolerance));
    let wrong = case.drawn.iter().flat_map(|drawn| drawn.albedo.iter().map(move |mean| (drawn, mean))).find(|(_, mean)| p(mean) < level);
    let refusal = wrong.map(|(drawn, mean)| refuse(drawn, format!("an albedo of 1 ± {tolerance}"), mean, p(mean), level));
    Outcome::new(refusal, vec![])
}

fn refuse(drawn: &Drawn, expected: String, found: &Mean, p: f64, level: f64) -> CounterExample {
    CounterExample {
        inputs: format!("wo = {}", show(drawn.wo)),
        expected,
        found: format!("{:.6} ± {:.1e}, the mean of the weights (importance)", found.value, found.standard_error()),
        sure: if p == 0.0 { CERTAIN.into() } else { chance(p, level, drawn.samples) },
    }
}

/// How likely so large a mean is, or a larger one, if the truth is `limit`.
fn chance_above(mean: &Mean, limit: f64) -> f64 {
    let z = mean.z(limit);
    if z.is_nan() { 0.0 } else { Normal::standard().sf(z) }
}

fn chance_below(mean: &Mean, limit: f64) -> f64 {
    let z = mean.z(limit);
    if z.is_nan() { 0.0 } else { Normal::standard().cdf(z) }
}

fn brightest(drawn: &Drawn) -> &Mean {
    let [r, g, b] = &drawn.albedo;
    [g, b].into_iter().fold(r, |most, mean| if mean.value > most.value { mean } else { most })
}

fn albedo(drawn: &Drawn) -> String {
    let [r, g, b] = drawn.albedo.map(|mean| format!("{:.5} ± {:.0e}", mean.value, mean.standard_error()));
    let text = if r == g && g == b { r } else { [r, g, b].join(", ") };
    format!("cos θo {:>6.3}: albedo {text}", drawn.wo.cos())
}
