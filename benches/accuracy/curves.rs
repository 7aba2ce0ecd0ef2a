//! How the error of long renders falls: the mean relMSE over the samples per pixel, as CSV.
//!
//! The errors are those of the renders' own error bars, whose coverage is measured by the table `coverage`. Only the lengths of the curves
//! depend on the clock.

use std::time::Duration;

use pt::film::FilmSpec;
use pt::measure::adaptive::pilot_allocation;
use pt::measure::{ErrorHistory, ErrorTarget, Scope, StopCondition};
use pt::render::{Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};

use super::subject::Subject;
use super::{Request, SAMPLERS, after, rounds, small, taken_with};

pub const SCENES: [&str; 9] =
    ["cornell-box", "mirror-balls", "statue", "triangle-stacks", "matter", "postcard", "glass-panel", "metals", "lanterns"];
/// Errors that a curve should reach.
pub const TARGETS: [f64; 3] = [0.03, 0.01, 0.003];
/// Seed of the first long render, above those of the pilots in `prices`, which must be independent.
const FIRST: u64 = 1000;
/// Number of long renders whose relMSE is averaged.
const RENDERS: u64 = 2;
/// Time that each long render may take: five minutes.
const LONGEST: Duration = Duration::from_secs(300);
/// Samples per pixel of the short render that tells which targets can be reached in [`LONGEST`].
const SHORT: u64 = 1024;
const HEADER: &str = "scene,sampler,spp,relmse";

/// How the samples of a picture are taken.
#[derive(Clone, Copy)]
pub enum Sampling {
    /// All pixels get the same number of samples.
    Even(Kind),
    /// Noisy pixels get more samples, as with `--adaptive`, from the default sampler.
    Adaptive,
}

pub const SAMPLINGS: [Sampling; 4] =
    [Sampling::Even(SAMPLERS[0]), Sampling::Even(SAMPLERS[1]), Sampling::Even(SAMPLERS[2]), Sampling::Adaptive];

/// Samples per pixel and mean relMSE, from few samples to many.
pub type Curve = Vec<(f64, f64)>;

pub fn print(request: &Request) -> pt::Result<()> {
    println!("{HEADER}");
    for scene in request.scenes {
        let subject = small(scene)?;
        for sampling in SAMPLINGS {
            for (spp, relmse) in long(&subject, sampling).unwrap_or_default() {
                println!("{scene},{sampling},{spp},{relmse}");
            }
        }
    }
    Ok(())
}

/// Curve of a scene in a file of [`print`]; empty if it is not there.
pub fn read(file: &str, scene: &str, sampling: Sampling) -> Curve {
    let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let start = format!("{scene},{sampling},");
    let point = |line: &str| {
        let (spp, relmse) = line.strip_prefix(&start)?.split_once(',')?;
        Some((spp.parse().ok()?, relmse.parse().ok()?))
    };
    text.lines().filter_map(point).collect()
}

/// Curve of the long renders, as far as all of them got; `None` if uneven samples do not pay.
pub fn long(subject: &Subject, sampling: Sampling) -> Option<Curve> {
    let (kind, spec) = film(subject, sampling, FIRST)?;
    let (_, short) = taken_with(subject, &spec, kind, 2, FIRST, &after(rounds(SHORT, &spec)));
    let is_reached = |target: f64| short.price(target, 0.95).is_some_and(|price| price.value < LONGEST.as_secs_f64());
    let goal = TARGETS.into_iter().rev().find(|target| is_reached(*target)).unwrap_or(TARGETS[0]);
    // A little below the target, so that the curve crosses it.
    let target = ErrorTarget { error: 0.95 * goal, confidence: 0.5, scope: Scope::Picture };
    let until = StopCondition { samples: u32::MAX.into(), time: Some(LONGEST), target: Some(target), patience: None };
    let histories: Vec<_> = (0..RENDERS).map(|seed| taken_with(subject, &spec, kind, 2, FIRST + seed, &until).1).collect();
    let at = |samples: u64| -> Option<(f64, f64)> {
        let error = |history: &ErrorHistory| history.checkpoints.iter().find(|c| c.samples == samples)?.error;
        let squares: Vec<f64> = histories.iter().map(|history| Some(error(history)?.value.powi(2))).collect::<Option<_>>()?;
        Some((spec.allocation.mean() * samples as f64, squares.iter().sum::<f64>() / squares.len() as f64))
    };
    Some(histories[0].checkpoints.iter().filter_map(|c| at(c.samples)).collect())
}

/// Film of a sampling, whose allocation depends on the seed of its pilot; `None` if uneven samples do not pay.
pub fn film(subject: &Subject, sampling: Sampling, seed: u64) -> Option<(Kind, FilmSpec)> {
    let mut spec = subject.spec.clone();
    let kind = match sampling {
        Sampling::Even(kind) => kind,
        Sampling::Adaptive => {
            let kind = SAMPLERS[2];
            let settings = Settings::new(SamplerSpec { kind, seed, spp: u32::MAX.into(), scramblings: 2 });
            (spec.allocation, _) = pilot_allocation(&subject.scene, &*subject.integrator, &spec, &settings, u32::MAX.into(), &Silent);
            if spec.allocation.is_even() {
                return None;
            }
            kind
        }
    };
    Some((kind, spec))
}

/// Number of samples at which the curve falls to the target, interpolated by a power law.
pub fn crossing(curve: &[(f64, f64)], target: f64) -> Option<f64> {
    let goal = 2.0 * target.ln();
    let points: Vec<(f64, f64)> = curve.iter().map(|(n, relmse)| (n.ln(), relmse.ln())).collect();
    let pair = points.windows(2).find(|pair| pair[0].1 > goal && pair[1].1 <= goal)?;
    let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
    Some((pair[0].0 + share * (pair[1].0 - pair[0].0)).exp())
}

impl std::fmt::Display for Sampling {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Sampling::Even(kind) => write!(f, "{kind:?}"),
            Sampling::Adaptive => write!(f, "Sobol adaptive"),
        }
    }
}
