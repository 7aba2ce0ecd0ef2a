//! Law of delta lobes: the list is complete, each weight is the probability of sampling the lobe times the weight of the sample,
//! and light returns along its path.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{Case, Outcome, chance, colors, random_inputs, show};
use crate::bsdf::{BsdfSample, TransportMode};
use crate::math::{Local, Spectrum};
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::rounding::{near, same_direction};
use crate::proof::{Model, SampledDirections};

/// Tolerance for the rounding of a lobe's weight.
const ROUNDING: f64 = 1e-5;

/// Tests the law `delta`.
pub fn delta(case: &Case) -> Outcome {
    let lobes: usize = case.sampled.iter().map(|sampled| sampled.lobes.len()).sum();
    let level = case.level();
    let mut refusal = case.sampled.iter().find_map(|sampled| unlisted(sampled).or_else(|| wrong_share(sampled, level)));
    let mut traced = 0u64;
    for input in random_inputs(case, 3) {
        for lobe in case.model.delta_lobes(input.wo, TransportMode::Importance) {
            traced += 1;
            refusal = refusal.or_else(|| retrace(case.model, input.wo, &lobe));
        }
    }
    if lobes == 0 && traced == 0 && refusal.is_none() {
        return Outcome::exempt("no delta lobes".into());
    }
    Outcome::new(refusal, vec![format!("{lobes} lobes at {} incidences, {traced} followed back", case.sampled.len())])
}

fn unlisted(sampled: &SampledDirections) -> Option<CounterExample> {
    sampled.stray.map(|sample| CounterExample {
        inputs: format!("wo = {}", show(sampled.wo)),
        expected: format!("one of the {} lobes that delta_lobes lists", sampled.lobes.len()),
        found: format!("a delta sample into wi = {}", show(sample.wi)),
        sure: CERTAIN.into(),
    })
}

fn wrong_share(sampled: &SampledDirections, level: f64) -> Option<CounterExample> {
    sampled.lobes.iter().find_map(|lobe| {
        let share = f64::from(lobe.listed.weight.average());
        let off = (lobe.weight.value - share).abs() - ROUNDING * share.max(lobe.weight.value);
        // An improbable lobe may not be sampled at all; then its variance is taken to be that of the listed weight.
        let spread = lobe.weight.standard_error().max((share * (1.0 - share).max(0.0) / sampled.samples as f64).sqrt());
        let p = if off > 0.0 { 2.0 * Normal::standard().sf(off / spread) } else { 1.0 };
        (p < level || p.is_nan()).then(|| CounterExample {
            inputs: format!("wo = {}, the lobe into wi = {}", show(sampled.wo), show(lobe.listed.wi)),
            expected: format!("chance · weight of its samples = the listed share {share:.6}"),
            found: format!("{:.6} ± {:.1e}", lobe.weight.value, lobe.weight.standard_error()),
            sure: chance(p, level, sampled.samples),
        })
    })
}

/// Checks that a reciprocal model leads from `lobe.wi` back to `wo`, with the same share of importance (Stokes) and the inverse
/// index.
fn retrace(model: &dyn Model, wo: Local, lobe: &BsdfSample) -> Option<CounterExample> {
    if !model.reciprocal() {
        return None;
    }
    // A cosine rounded by one part in 2²⁴ turns a refracted direction by that, divided by the other cosine, and changes the Fresnel
    // reflectance as much.
    let index = lobe.eta.max(1.0 / lobe.eta);
    let tolerance = 64.0 * f32::EPSILON * index * index / wo.abs_cos().min(lobe.wi.abs_cos());
    if tolerance > 0.01 {
        return None;
    }
    let back = model.delta_lobes(lobe.wi, TransportMode::Importance);
    let found = back.iter().find(|back| back.lobe == lobe.lobe && (back.wi.0 - wo.0).abs().max_element() <= tolerance);
    let refuse = |expected: String, found: String| {
        let inputs = format!("wo = {}, its {:?} lobe into wi = {}", show(wo), lobe.lobe, show(lobe.wi));
        Some(CounterExample { inputs, expected, found, sure: CERTAIN.into() })
    };
    let Some(back) = found else {
        let all: Vec<String> = back.iter().map(|lobe| show(lobe.wi)).collect();
        return refuse(
            "a lobe from wi back into wo".into(),
            format!("lobes into {}", if all.is_empty() { "nothing".into() } else { all.join(", ") }),
        );
    };
    if !near(back.weight, lobe.weight, tolerance, Spectrum::gray(tolerance)) {
        return refuse(format!("the same share of importance back: {}", colors(lobe.weight)), colors(back.weight));
    }
    if (back.eta * lobe.eta - 1.0).abs() > 8.0 * f32::EPSILON {
        return refuse(format!("the index {} inverted on the way back", lobe.eta), format!("{}", back.eta));
    }
    let radiance = model.delta_lobes(wo, TransportMode::Radiance).into_iter().find(|r| same_direction(r.wi, lobe.wi));
    let weight = radiance.map_or(Spectrum::BLACK, |r| r.weight);
    let squared = lobe.eta * lobe.eta;
    if !near(weight * squared, lobe.weight, 16.0 * f32::EPSILON, Spectrum::BLACK) {
        return refuse(format!("radiance = importance / η² = {}", colors(lobe.weight / squared)), colors(weight));
    }
    None
}
