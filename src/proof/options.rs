//! How thoroughly a model is proved.

use crate::math::Local;

/// Settings of [`prove`](super::prove).
#[derive(Clone, Debug)]
pub struct Options {
    /// The probability that a right model is refused, over all its laws and incidences, and over the whole suite.
    pub alpha: f64,
    /// How many models are proved together: α is shared among them.
    pub suite: usize,
    /// Directions drawn at each incidence for the laws that are statistical.
    pub samples: u64,
    /// Inputs tried for the laws that need no statistics.
    pub cases: u64,
    /// Which random numbers.
    pub seed: u64,
    /// The directions `wo` of the statistical laws.
    pub incidences: Vec<Local>,
    /// What a white furnace must give.
    pub furnace: Furnace,
}

/// What becomes of the light that falls on a model from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Furnace {
    /// Some of it may be absorbed.
    Passive,
    /// All of it comes back, but for this share that the model's own approximations may lose or gain.
    Lossless(f64),
}

impl Default for Options {
    /// A million samples at ten incidences: from normal to grazing, from both sides.
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

/// Directions of these cosines on both sides of the surface, turned by the golden angle from one to the next.
pub fn incidences(cosines: &[f64]) -> Vec<Local> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let both = cosines.iter().flat_map(|&cosine| [cosine, -cosine]);
    both.enumerate().map(|(i, cosine)| at(cosine, GOLDEN_ANGLE * i as f64)).collect()
}

/// The direction of a cosine and an azimuth.
pub fn at(cosine: f64, phi: f64) -> Local {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    Local::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, cosine as f32)
}
