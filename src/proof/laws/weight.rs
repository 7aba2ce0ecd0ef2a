//! Law of weights: the weight and density of a sample agree with `eval` and `pdf`.

use super::{Case, Input, MODES, Outcome, colors, random_inputs, show};
use crate::bsdf::TransportMode;
use crate::math::{Density, Local, Spectrum};
use crate::proof::Model;
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::rounding::{near, rounding_sensitivity, shifted};
use glam::Vec2;

/// Relative tolerance of weights and densities: some hundred roundings, far below what a picture shows.
const TOLERANCE: f32 = 1e-4;

/// Tests the law `weight`.
pub fn weight(case: &Case) -> Outcome {
    let mut smooth = 0u64;
    let mut refusal = None;
    for input in random_inputs(case, 1) {
        for mode in MODES {
            let Input { wo, choice, u } = input;
            let sample = case.model.sample(wo, choice, u, mode);
            smooth += u64::from(sample.is_some_and(|s| matches!(s.density, Density::Smooth(_))));
            refusal = refusal.or_else(|| weight_at(case.model, wo, choice, u, mode).err());
        }
    }
    Outcome::new(refusal, vec![format!("{smooth} samples with a density compared")])
}

/// Tests the law `weight` for one input: density = pdf(wo, wi) and weight · density = eval(wo, wi), to 10⁻⁴.
///
/// Where the functions jump or are steep, their values may be those of a direction that differs by a few roundings.
///
/// # Errors
/// The counter-example.
pub fn weight_at(model: &dyn Model, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Result<(), CounterExample> {
    let Some(sample) = model.sample(wo, choice, u, mode) else { return Ok(()) };
    let Density::Smooth(density) = sample.density else { return Ok(()) };
    let wi = sample.wi;
    let refuse = |expected: String, found: String| {
        let inputs = format!("{}, {mode:?}, which gave wi = {}", Input { wo, choice, u }, show(wi));
        Err(CounterExample { inputs, expected, found, sure: CERTAIN.into() })
    };
    let pdf = |wi| Spectrum::gray(model.pdf(wo, wi).get());
    let claimed = Spectrum::gray(density.get());
    if !agrees(claimed, pdf, wi) {
        return refuse(format!("density = pdf(wo, wi) = {}", colors(pdf(wi))), format!("density {}", colors(claimed)));
    }
    let eval = |wi| model.eval(wo, wi, mode);
    let product = sample.weight * density.get();
    if !agrees(product, eval, wi) {
        let expected = format!("weight · density = eval(wo, wi) = {}", colors(eval(wi)));
        let ratio = product.average() / eval(wi).average();
        let found = format!("{} = weight {} · density {}, {ratio} times eval", colors(product), colors(sample.weight), colors(claimed));
        return refuse(expected, found);
    }
    Ok(())
}

/// Returns whether a value equals that of the function at `wi`, or lies within the range of its values next to `wi`.
fn agrees(value: Spectrum, of: impl Fn(Local) -> Spectrum, wi: Local) -> bool {
    let centre = of(wi);
    near(value, centre, TOLERANCE, Spectrum::BLACK)
        || near(value, centre, TOLERANCE, rounding_sensitivity(centre, shifted(wi, 4.0).map(of)))
}
