//! Laws of scattering, one file each.
//!
//! To add one: a file beside these with a function from a [`Case`] to an [`Outcome`], and a row in [`LAWS`].

mod delta;
mod distribution;
mod energy;
mod inputs;
mod jacobian;
mod reciprocity;
mod weight;

use glam::{Vec2, Vec3};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::report::{CounterExample, Finding, Verdict};
use super::{Case, options};
use crate::bsdf::TransportMode;
use crate::math::float::unit_f32;
use crate::math::{Local, Spectrum};

pub use inputs::inputs_at;
pub use reciprocity::reciprocity_at;
pub use weight::weight_at;

/// A law: its name, its demand, and its test.
pub struct Law {
    /// Name in one word.
    pub name: &'static str,
    /// Demand, as a formula if there is one.
    pub demands: &'static str,
    run: fn(&Case) -> Outcome,
}

/// Result of the test of a law.
pub(super) struct Outcome {
    verdict: Verdict,
    notes: Vec<String>,
}

impl Law {
    /// Tests a model.
    pub fn test(&self, case: &Case) -> Finding {
        let Outcome { verdict, notes } = (self.run)(case);
        Finding { law: self.name, demands: self.demands, verdict, notes }
    }
}

/// All laws, the simplest first.
pub const LAWS: [Law; 9] = [
    Law { name: "inputs", demands: "finite, unit, on the side it says, whatever the input", run: inputs::inputs },
    Law { name: "weight", demands: "weight = f·|cos θi| / pdf, and the density of a sample is pdf's", run: weight::weight },
    Law { name: "integral", demands: "∫ pdf + failures + delta lobes = 1", run: distribution::integral },
    Law { name: "chi2", demands: "samples follow pdf", run: distribution::chi2 },
    Law { name: "jacobian", demands: "pdf = chance of the lobe / |∂ω/∂u|", run: jacobian::jacobian },
    Law { name: "reciprocity", demands: "f(a, b) = f(b, a), f/η² through the surface", run: reciprocity::reciprocity },
    Law { name: "energy", demands: "no more light leaves than arrives: albedo ≤ 1", run: energy::energy },
    Law { name: "furnace", demands: "a white furnace stays white: albedo = 1", run: energy::furnace },
    Law { name: "delta", demands: "delta lobes are what sampling chooses from, and lead back", run: delta::delta },
];

impl Outcome {
    fn new(refusal: Option<CounterExample>, notes: Vec<String>) -> Outcome {
        Outcome { verdict: refusal.map_or(Verdict::Holds, Verdict::Refused), notes }
    }

    fn exempt(note: String) -> Outcome {
        Outcome { verdict: Verdict::Exempt, notes: vec![note] }
    }
}

/// Input for a law of single inputs.
#[derive(Clone, Copy, Debug)]
struct Input {
    wo: Local,
    choice: f32,
    u: Vec2,
}

/// `options.cases` random inputs. The cosines of `wo` are evenly distributed; every eighth direction is grazing (down to 10⁻⁷), and
/// half of them are below the surface.
fn random_inputs(case: &Case, stream: u64) -> impl Iterator<Item = Input> {
    let mut bits = Xoshiro256PlusPlus::seed_from_u64(case.options.seed ^ stream << 32);
    let mut unit = move || unit_f32(bits.next_u32());
    (0..case.options.cases).map(move |i| {
        let [side, x, phi] = [(); 3].map(|()| f64::from(unit()));
        let cosine = if i % 8 == 0 { 10f64.powf(-7.0 * x) } else { 1.0 - x };
        let wo = options::at(if side < 0.5 { -cosine } else { cosine }, std::f64::consts::TAU * phi);
        Input { wo, choice: unit(), u: Vec2::new(unit(), unit()) }
    })
}

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];

/// Returns whether two directions are equal up to the rounding of their computation.
pub(super) fn same_direction(a: Local, b: Local) -> bool {
    (a.0 - b.0).abs().max_element() <= 8.0 * f32::EPSILON
}

/// Whether |a − b| ≤ relative · max(|a|, |b|) + slack in every coefficient; `false` for NaN.
///
/// Differences below the smallest normal number count as 0.
fn near(a: Spectrum, b: Spectrum, relative: f32, slack: Spectrum) -> bool {
    let excess = a.zip(b, |a, b| (a - b).abs() - (relative * a.abs().max(b.abs())).max(f32::MIN_POSITIVE));
    excess.zip(slack, |excess, slack| if excess <= slack { 0.0 } else { 1.0 }).is_black()
}

/// Change of a value under rounding of the inputs: the range over the neighbours, doubled for the neighbours that were not tried.
fn rounding_sensitivity(centre: Spectrum, neighbours: impl IntoIterator<Item = Spectrum>) -> Spectrum {
    let largest = |a: Spectrum, b: Spectrum| a.zip(b, f32::max);
    let off = |value: Spectrum| value.zip(centre, |a, b| 2.0 * (a - b).abs());
    neighbours.into_iter().map(off).fold(Spectrum::BLACK, largest)
}

/// Directions that differ by a few roundings of their own coordinates.
fn rounded(w: Local) -> [Local; 6] {
    const BY: f32 = 4.0 * f32::EPSILON;
    let change = |axis: Vec3, by: f32| Local(w.0 + w.0 * axis * by);
    let [x, y, z] = Vec3::AXES;
    [change(x, BY), change(x, -BY), change(y, BY), change(y, -BY), change(z, BY), change(z, -BY)]
}

/// Directions near `w`, shifted along the axes by `roundings` times the rounding error of a computation with unit vectors.
pub(super) fn shifted(w: Local, roundings: f32) -> [Local; 8] {
    let by = roundings * f32::EPSILON;
    let sign = |k: u32, axis: u32| if k >> axis & 1 == 0 { -by } else { by };
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k| Local(w.0 + Vec3::new(sign(k, 0), sign(k, 1), sign(k, 2))))
}

/// A direction with all digits.
fn show(w: Local) -> String {
    format!("({:?}, {:?}, {:?})", w.0.x, w.0.y, w.0.z)
}

impl std::fmt::Display for Input {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "wo = {}, choice = {:?}, u = ({:?}, {:?})", show(self.wo), self.choice, self.u.x, self.u.y)
    }
}

fn colors(value: Spectrum) -> String {
    let [r, g, b] = value.to_rgb();
    if r == g && g == b { format!("{r:?}") } else { format!("({r:?}, {g:?}, {b:?})") }
}

/// Certainty of a statistical refusal, as text.
fn chance(p: f64, level: f64, samples: u64) -> String {
    format!("chance alone goes so far with p = {p:.1e}; the level of each test is {level:.1e}; {samples} samples")
}
