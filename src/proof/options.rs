//! Settings of a test of a model.

use crate::math::Local;

/// Settings of [`prove`](super::prove).
#[derive(Clone, Debug)]
pub struct Options {
    /// Probability that a right model is refused, over all its laws and incidences, and over the whole suite.
    pub alpha: f64,
    /// Number of models that are tested together and share α.
    pub suite: usize,
    /// Directions sampled at each incidence, for statistical laws.
    pub samples: u64,
    /// Number of random inputs for each law that is not statistical.
    pub cases: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Directions `wo` of the statistical laws.
    pub incidences: Vec<Local>,
    /// Demand of the law `furnace`.
    pub furnace: Furnace,
}

/// Claim about light that arrives from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Furnace {
    /// The model may absorb light.
    Passive,
    /// The model scatters all light, up to this share that its approximations may lose or gain.
    Lossless(f64),
}

impl Default for Options {
    /// Returns options with a million samples at ten incidences: five angles from normal to grazing, on both sides.
    fn default() -> Options {
        Options {
            alpha: 0.01,
            suite: 1,
            samples: 1_000_000,
            cases: 20_000,
            seed: 1,
            incidences: incidences(&[1.0, 0.9, 0.6, 0.25, 0.05]),
            furnace: Furnace::Passive,
        }
    }
}

/// Directions with these cosines on both sides of the surface, each turned by the golden angle.
pub fn incidences(cosines: &[f64]) -> Vec<Local> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let both = cosines.iter().flat_map(|&cosine| [cosine, -cosine]);
    both.enumerate().map(|(i, cosine)| at(cosine, GOLDEN_ANGLE * i as f64)).collect()
}

/// Direction with a cosine and an azimuth.
pub fn at(cosine: f64, phi: f64) -> Local {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    Local::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, cosine as f32)
}
