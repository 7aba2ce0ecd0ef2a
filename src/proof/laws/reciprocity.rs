//! Law of reciprocity: light returns along its path.

use super::{Case, Input, Outcome, colors, random_inputs, show};
use crate::bsdf::TransportMode::{Importance, Radiance};
use crate::math::{Density, Local, Spectrum};
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::rounding::{near, rounded, rounding_sensitivity};
use crate::proof::{Model, at};

/// Relative tolerance for f: thirty roundings.
const TOLERANCE: f32 = 4e-6;

/// Tests the law `reciprocity`.
pub fn reciprocity(case: &Case) -> Outcome {
    let mut compared = 0u64;
    let mut refusal = None;
    for input in random_inputs(case, 4) {
        for (wi, eta) in partners(case.model, input) {
            compared += 1;
            refusal = refusal.or_else(|| reciprocity_at(case.model, input.wo, wi, eta).err());
        }
    }
    if case.model.reciprocal() {
        return Outcome::new(refusal, vec![format!("{compared} pairs of directions compared")]);
    }
    Outcome::exempt(match refusal {
        Some(example) => format!(
            "the model says that it is not, and it is not: at {}, expected {}, found {}",
            example.inputs, example.expected, example.found
        ),
        None => format!("the model says that it is not, though {compared} pairs of directions show no difference"),
    })
}

/// A sampled direction for `wo` with its index, and a random direction on the side of `wo`.
fn partners(model: &dyn Model, Input { wo, choice, u }: Input) -> Vec<(Local, f32)> {
    let sampled = model.sample(wo, choice, u, Radiance).filter(|sample| matches!(sample.density, Density::Smooth(_)));
    let anywhere = at(f64::from((1.0 - u.x) * wo.cos().signum()), f64::from(7.0 * u.y));
    sampled.map(|sample| (sample.wi, sample.eta)).into_iter().chain([(anywhere, 1.0)]).collect()
}

/// Tests the law `reciprocity` for one pair of directions.
///
/// With f = eval/|cos θi|: importance one way is radiance the other way, f*(a, b) = f(b, a), and importance is radiance without the
/// compression, f*(a, b) = η² f(a, b). Together f(b, a) = η² f(a, b), which for η = 1 is Helmholtz's f(a, b) = f(b, a).
///
/// - `eta`: the index on the side of `b` over that on the side of `a`, as a sample from `a` to `b` has it; 1 for reflection
///
/// # Errors
/// The counter-example.
///
/// Source: Veach, thesis (1997), §5.2.
pub fn reciprocity_at(model: &dyn Model, a: Local, b: Local, eta: f32) -> Result<(), CounterExample> {
    // Both sides are multiplied with both cosines, so that nothing is divided by them.
    let there = |a: Local, b: Local| model.eval(a, b, Importance) * a.abs_cos();
    let back = |a: Local, b: Local| model.eval(b, a, Radiance) * b.abs_cos();
    let radiance = |a: Local, b: Local| model.eval(a, b, Radiance) * (eta * eta * a.abs_cos());
    let forth = there(a, b);
    let slack = |f: &dyn Fn(Local, Local) -> Spectrum| {
        rounding_sensitivity(f(a, b), rounded(a).map(|a| f(a, b)).into_iter().chain(rounded(b).map(|b| f(a, b))))
    };
    let both = |f: &dyn Fn(Local, Local) -> Spectrum| {
        let value = f(a, b);
        near(forth, value, TOLERANCE, Spectrum::BLACK) || near(forth, value, TOLERANCE, slack(&there) + slack(f))
    };
    let refuse = |expected: String, found: String| {
        Err(CounterExample { inputs: format!("a = {}, b = {}, η = {eta:?}", show(a), show(b)), expected, found, sure: CERTAIN.into() })
    };
    let per_cosines = 1.0 / (a.abs_cos() * b.abs_cos());
    if !both(&back) {
        let ratio = back(a, b).average() / forth.average();
        let found = format!("f(b, a) = {}, {ratio} times that", colors(back(a, b) * per_cosines));
        return refuse(format!("f(b, a) = f*(a, b) = {}", colors(forth * per_cosines)), found);
    }
    if !both(&radiance) {
        let expected = format!("η² f(a, b) = f*(a, b) = {}", colors(forth * per_cosines));
        return refuse(expected, format!("η² f(a, b) = {}", colors(radiance(a, b) * per_cosines)));
    }
    Ok(())
}
