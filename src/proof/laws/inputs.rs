//! Law of inputs: every input gives a valid output.

use glam::Vec2;

use super::{Case, Input, MODES, Outcome, colors, random_inputs, show};
use crate::bsdf::{Lobe, TransportMode};
use crate::math::float::{ONE_MINUS_EPSILON, ROUNDING};
use crate::math::{Density, Local};
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::{Model, at};

/// The ends of [0, 1), their neighbours, a number that vanishes beside 1, and the middle, where maps of the square have seams.
const UNIFORM: [f32; 8] = [0.0, ROUNDING, 1e-30, 0.25, 0.5 - ROUNDING, 0.5, 0.5 + ROUNDING, ONE_MINUS_EPSILON];

/// Steep, oblique and grazing directions, and directions in the surface.
const COSINES: [f64; 10] = [1.0, 1.0 - 1e-7, 0.7, 0.1, 1e-3, 1e-5, 1e-7, 1e-20, 1e-38, 0.0];

/// Tests the law `inputs`.
pub fn inputs(case: &Case) -> Outcome {
    let directions = adversarial_directions();
    let mut tried = 0u64;
    let mut refusal = None;
    let mut ask = |wo: Local, wi: Local, choice: f32, u: Vec2| {
        for mode in MODES {
            tried += 1;
            if refusal.is_none() {
                refusal = inputs_at(case.model, wo, wi, choice, u, mode).err();
            }
        }
    };
    for &wo in &directions {
        for choice in UNIFORM {
            for u in UNIFORM.into_iter().flat_map(|x| UNIFORM.map(|y| Vec2::new(x, y))) {
                ask(wo, Local(-wo.0), choice, u);
            }
        }
        for &wi in &directions {
            ask(wo, wi, 0.5, Vec2::splat(0.5));
        }
    }
    for Input { wo, choice, u } in random_inputs(case, 2) {
        ask(wo, at(f64::from(2.0 * choice - 1.0), f64::from(7.0 * u.x)), choice, u);
    }
    Outcome::new(
        refusal,
        vec![format!("{tried} inputs: u at both ends, cosines down to 1e-38 and 0, both sides, opposed and equal directions")],
    )
}

fn adversarial_directions() -> Vec<Local> {
    let azimuths = [0.0, 2.0, 4.5];
    let both = COSINES.into_iter().flat_map(|c| [c, -c]);
    both.flat_map(|cosine| azimuths.map(|phi| at(cosine, phi))).collect()
}

/// Tests the law `inputs` for one input.
///
/// `eval` and `pdf` are finite and not negative, and `pdf` is not 0 where there is light. A sample is a unit direction on the side
/// of its lobe, with a finite weight, a density above 0, and a finite index above 0.
///
/// # Errors
/// The counter-example.
pub fn inputs_at(model: &dyn Model, wo: Local, wi: Local, choice: f32, u: Vec2, mode: TransportMode) -> Result<(), CounterExample> {
    let (f, pdf) = (model.eval(wo, wi, mode), model.pdf(wo, wi).get());
    let pair = || format!("wo = {}, wi = {}, {mode:?}", show(wo), show(wi));
    let refuse = |inputs: String, expected: &str, found: String| {
        Err(CounterExample { inputs, expected: expected.into(), found, sure: CERTAIN.into() })
    };
    if !f.is_valid() {
        return refuse(pair(), "eval finite and nowhere negative", format!("eval = {}", colors(f)));
    }
    if !(pdf >= 0.0 && pdf.is_finite()) {
        return refuse(pair(), "pdf finite and not negative", format!("pdf = {pdf:?}"));
    }
    // Subnormal numbers have lost digits.
    if f.max() >= f32::MIN_POSITIVE && pdf == 0.0 {
        return refuse(pair(), "pdf above 0 wherever eval is: sampling must find all light", format!("eval = {}, pdf = 0", colors(f)));
    }
    let Some(sample) = model.sample(wo, choice, u, mode) else { return Ok(()) };
    let wi = sample.wi;
    let sampled = || format!("{}, {mode:?}", Input { wo, choice, u });
    // Four roundings of the coordinates, squared and summed.
    let length = wi.0.as_dvec3().length();
    if (length - 1.0).abs() > f64::from(8.0 * f32::EPSILON) || length.is_nan() {
        return refuse(sampled(), "wi of length 1", format!("wi = {} of length {length}", show(wi)));
    }
    // A direction in the surface is on neither side.
    let sided = wo.cos() != 0.0 && wi.cos() != 0.0;
    if sided && wo.same_side(wi) != (sample.lobe == Lobe::Reflection) {
        return refuse(
            sampled(),
            "reflection on the side of wo, transmission on the other",
            format!("{:?} into wi = {}", sample.lobe, show(wi)),
        );
    }
    if !sample.weight.is_valid() {
        return refuse(sampled(), "a weight finite and nowhere negative", format!("weight {}", colors(sample.weight)));
    }
    if !(sample.eta > 0.0 && sample.eta.is_finite()) {
        return refuse(sampled(), "an index of refraction above 0", format!("eta {:?}", sample.eta));
    }
    match sample.density {
        Density::Smooth(pdf) if !(pdf.get() > 0.0 && pdf.get().is_finite()) => {
            refuse(sampled(), "the density of what was drawn finite and above 0", format!("density {:?}", pdf.get()))
        }
        _ => Ok(()),
    }
}
