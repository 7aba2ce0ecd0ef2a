//! Law of the Jacobian: the density of a map is one over its stretch.

use glam::{DVec2, DVec3, Vec2};

use super::{Case, Input, Outcome, random_inputs, show};
use crate::bsdf::{BsdfSample, TransportMode};
use crate::math::float::{ONE_MINUS_EPSILON, ROUNDING};
use crate::math::{Density, Local};
use crate::proof::Model;
use crate::proof::report::{CERTAIN, CounterExample};

/// Half the step of u for derivatives. They are computed again with half of it, and the difference is the error.
const STEP: f64 = 1.0 / 512.0;
/// Largest error at which a point is used. Beyond it the point is near a seam, or the lobe is too narrow for f32.
const LARGEST_ERROR: f64 = 0.02;
/// Allowance for what the estimate of the error may miss.
const MARGIN: f64 = 2e-3;

/// pdf · |J| of one sample, and the probability of its lobe.
#[derive(Clone, Copy)]
struct Stretch {
    input: Input,
    wi: Local,
    pdf: f64,
    jacobian: f64,
    share: f64,
    error: f64,
}

/// Tests the law `jacobian`.
pub fn jacobian(case: &Case) -> Outcome {
    let tried = random_inputs(case, 5).filter(|input| input.wo.abs_cos() > 1e-3).take(POINTS);
    let points: Vec<Stretch> = tried.filter_map(|input| stretch(case.model, input)).collect();
    if points.is_empty() {
        return Outcome::exempt("no sample has a density, or none where the map is smooth".into());
    }
    let exact = case.model.one_to_one();
    let mut suspects = points.iter().filter(|point| point.is_wrong(exact)).map(|point| point.again(case.model));
    let refusal = suspects.find(|point| point.is_wrong(exact)).map(|point| point.refuse(exact));
    let demand = if exact { "equal" } else { "at least (other ways may lead to the same direction)" };
    Outcome::new(refusal, vec![format!("{} points where the map is smooth; pdf · |J| / chance must be {demand} 1", points.len())])
}

/// Number of points. Each takes some hundred samples.
const POINTS: usize = 2000;

impl Stretch {
    /// Finds the probability of the lobe again, with many more choices. That is too slow for every point, but not for one that
    /// seems to break the law.
    fn again(&self, model: &dyn Model) -> Stretch {
        Stretch { share: chance_of(model, self.input, self.wi, FINE_CELLS), ..*self }
    }

    fn product(&self) -> f64 {
        self.pdf * self.jacobian / self.share
    }

    fn is_wrong(&self, exact: bool) -> bool {
        let off = self.product() - 1.0;
        let tolerance = 4.0 * self.error + MARGIN;
        off.is_nan() || off < -tolerance || (exact && off > tolerance)
    }

    fn refuse(&self, exact: bool) -> CounterExample {
        let relation = if exact { "=" } else { "≥" };
        CounterExample {
            inputs: format!("{}, which gave wi = {}", self.input, show(self.wi)),
            expected: format!(
                "pdf {relation} chance / |∂ω/∂u| = {:.6} / {:.6e} = {:.6e}",
                self.share,
                self.jacobian,
                self.share / self.jacobian
            ),
            found: format!("pdf = {:.6e}, {:.4} times that (derivative known to {:.1e})", self.pdf, self.product(), self.error),
            sure: CERTAIN.into(),
        }
    }
}

fn stretch(model: &dyn Model, input: Input) -> Option<Stretch> {
    let Input { wo, choice, u } = input;
    if u.min_element() < 2.0 * STEP as f32 || u.max_element() > 1.0 - 2.0 * STEP as f32 {
        return None;
    }
    let map = |choice: f32, u: Vec2| smooth(model.sample(wo, choice, u, TransportMode::Importance)?);
    let (wi, pdf) = map(choice, u)?;
    let derivative = |along: DVec2, step: f64| {
        let end = |sign: f64| map(choice, (u.as_dvec2() + sign * step * along).as_vec2()).map(|(w, _)| w.0.as_dvec3());
        Some((end(1.0)? - end(-1.0)?) / (2.0 * step))
    };
    let area = |step: f64| -> Option<(f64, DVec3, DVec3)> {
        let (du, dv) = (derivative(DVec2::X, step)?, derivative(DVec2::Y, step)?);
        // dω = |ω · (∂ω/∂u × ∂ω/∂v)|: the rounding of a coordinate near 1 does not count along ω.
        Some((wi.0.as_dvec3().dot(du.cross(dv)).abs(), du, dv))
    };
    let ((wide, ..), (jacobian, du, dv)) = (area(STEP)?, area(0.5 * STEP)?);
    // Rounded on both sides of a step.
    let noise = f64::from(f32::EPSILON) / STEP * (du.length() + dv.length()) / jacobian;
    let error = ((wide - jacobian) / jacobian).abs() + noise;
    let settled = error < LARGEST_ERROR && jacobian > 0.0;
    settled.then(|| Stretch { input, wi, pdf: f64::from(pdf), jacobian, share: chance_of(model, input, wi, CELLS), error })
}

fn smooth(sample: BsdfSample) -> Option<(Local, f32)> {
    match sample.density {
        Density::Smooth(pdf) => Some((sample.wi, pdf.get())),
        Density::Delta => None,
    }
}

/// Measure of the choices that lead to the same direction as `input`.
fn chance_of(model: &dyn Model, Input { wo, choice, u }: Input, wi: Local, cells: usize) -> f64 {
    let found = |c: f32| model.sample(wo, c, u, TransportMode::Importance).and_then(smooth);
    share(|c| found(c).map(|(w, _)| w) == Some(wi), choice, cells)
}

const CELLS: usize = 32;
/// Number of intervals of the fine search. What falls between them is far below [`MARGIN`].
const FINE_CELLS: usize = 1 << 14;

/// Measure of the choices that are the `same` as `own`: intervals, whose ends are found by bisection.
///
/// There are several intervals where a model chooses among models with the same lobe. An interval, or a gap, that is narrower than
/// a cell of the grid may be missed; the demanded density is then too small, or too large.
fn share(same: impl Fn(f32) -> bool, own: f32, cells: usize) -> f64 {
    const HALVINGS: u32 = 24;
    let grid = |k: usize| (k as f32 / cells as f32).min(ONE_MINUS_EPSILON);
    let mut nodes: Vec<f32> = (0..=cells).map(grid).chain([own]).collect();
    nodes.sort_by(f32::total_cmp);
    let inside: Vec<bool> = nodes.iter().map(|&choice| same(choice)).collect();
    let edge = |mut a: f32, mut b: f32, at_a: bool| {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            *(if same(middle) == at_a { &mut a } else { &mut b }) = middle;
        }
        0.5 * (f64::from(a) + f64::from(b))
    };
    let cell = |k: usize| {
        let (a, b) = (nodes[k], nodes[k + 1]);
        match (inside[k], inside[k + 1]) {
            (true, true) => f64::from(b) - f64::from(a),
            (false, false) => 0.0,
            (true, false) => edge(a, b, true) - f64::from(a),
            (false, true) => f64::from(b) - edge(a, b, false),
        }
    };
    (0..nodes.len() - 1).map(cell).sum::<f64>() + f64::from(ROUNDING)
}
