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

use glam::Vec2;
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
