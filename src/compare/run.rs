//! Measurements: every method, every replicate, checkpoint by checkpoint.

use std::collections::VecDeque;
use std::time::Duration;

use super::method::method;
use super::snapshot::{self, Snapshot};
use super::{Measurement, Method, MethodConfig, Reference};
use crate::film::{Image, MomentFilm};
use crate::measure::metric::{ImagePair, Named};
use crate::measure::{Distance, Metric};
use crate::output::Tonemap;
use crate::render::{Observer, Render, Settings};
use crate::sampler::SamplerSpec;

/// Limits of the work, and what is measured.
#[derive(Clone, Debug)]
pub struct Budget {
    /// Number of independent renders of each method; at least two, so that their variance is known.
    pub replicates: u32,
    /// Samples per pixel of each replicate at most.
    pub samples: u64,
    /// Render time of each method, all its replicates together.
    pub time: Option<Duration>,
    /// Error measures besides mse and relMSE.
    pub metrics: Vec<Metric>,
}

/// State of one replicate of a method.
struct Run {
    render: Render,
    film: MomentFilm,
    /// Pictures at the last checkpoints; only the first replicate keeps them.
    snapshots: VecDeque<Snapshot>,
}

/// What follows a comparison from checkpoint to checkpoint, such as a page of its results.
pub trait Follower {
    /// Called after each checkpoint of all methods. Returns whether the comparison goes on.
    ///
    /// - `results`: computes the results so far, which takes a moment
    fn checkpoint_done(&self, results: &dyn Fn() -> Vec<Method>) -> bool;
}

/// Nothing follows the comparison.
impl Follower for () {
    fn checkpoint_done(&self, _: &dyn Fn() -> Vec<Method>) -> bool {
        true
    }
}

/// Renders all methods in turn, a checkpoint at a time, and measures each picture against the reference.
///
/// The methods take turns, so that a machine that becomes slower affects all of them alike. Only rendering counts as time. `None` if the observer
/// ended it; if the follower did, the results are those of the checkpoints so far.
pub fn run(
    configs: &[MethodConfig],
    budget: &Budget,
    reference: &Reference,
    confidence: f64,
    observer: &dyn Observer,
    follower: &dyn Follower,
) -> Option<Vec<Method>> {
    let start = |config: &MethodConfig, replicate: u32| {
        let seed = config.sampler.seed.wrapping_add(1 + u64::from(replicate));
        // Each replicate is one sequence without scramblings: the variance among the replicates gives the error.
        let sampler = SamplerSpec { seed, spp: budget.samples, scramblings: 1, ..config.sampler };
        let render = Render::new(config.scene.clone(), &*config.integrator, &config.spec, &Settings::new(sampler));
        Run { render, film: MomentFilm::new(config.spec.clone()), snapshots: VecDeque::new() }
    };
    let mut runs: Vec<Vec<Run>> = configs.iter().map(|c| (0..budget.replicates).map(|r| start(c, r)).collect()).collect();
    let mut measured: Vec<Vec<Measurement>> = runs.iter().map(|_| vec![]).collect();
    for samples in doubling(budget.samples) {
        let mut advanced = false;
        // Methods are the inner loop, so that neighbours in time are different methods.
        for replicate in 0..budget.replicates as usize {
            for (index, runs) in runs.iter_mut().enumerate() {
                let most = configs[index].most.unwrap_or(u64::MAX);
                if samples > most || !affordable(&measured[index], budget, samples) {
                    continue;
                }
                advanced = true;
                let Run { render, film, snapshots } = &mut runs[replicate];
                render.advance(samples, film, observer);
                if render.report().cancelled {
                    return None;
                }
                let (image, replicate) = (film.image(), replicate as u32);
                let Distance { mse, relmse, trimmed } = Distance::between(&image, &reference.image)?;
                let others = others(&budget.metrics, &configs[index].name, &image, reference)?;
                let seconds = render.report().elapsed.as_secs_f64();
                if replicate == 0 {
                    snapshot::keep(snapshots, Snapshot::new(samples, seconds, relmse, image));
                }
                measured[index].push(Measurement { replicate, samples, seconds, mse, relmse, trimmed, others });
            }
        }
        if !advanced || !follower.checkpoint_done(&|| results(configs, &runs, &measured, reference, confidence)) {
            break;
        }
    }
    Some(results(configs, &runs, &measured, reference, confidence))
}

/// Results of all methods after a checkpoint.
fn results(
    configs: &[MethodConfig],
    runs: &[Vec<Run>],
    measured: &[Vec<Measurement>],
    reference: &Reference,
    confidence: f64,
) -> Vec<Method> {
    let one = |((config, runs), measurements): ((&MethodConfig, &Vec<Run>), &Vec<Measurement>)| {
        let pictures: Vec<Image> = runs.iter().map(|run| run.film.image()).collect();
        let snapshots = runs.first().map(|first| first.snapshots.iter().cloned().collect()).unwrap_or_default();
        method(config.into(), &pictures, snapshots, measurements.clone(), reference, confidence)
    };
    configs.iter().zip(runs).zip(measured).map(one).collect()
}

/// Values of the additional measures; `None` for pictures that cannot be compared.
pub fn others(metrics: &[Metric], name: &str, image: &Image, reference: &Reference) -> Option<Vec<f64>> {
    if metrics.is_empty() {
        return Some(vec![]);
    }
    let named = |name, image| Named { name, image };
    let pair = ImagePair::new(named(name, image), named(&reference.origin, &reference.image), Tonemap::default()).ok()?;
    Some(metrics.iter().map(|metric| metric.measure(&pair).value).collect())
}

/// Powers of two from 1 to `most`.
fn doubling(most: u64) -> impl Iterator<Item = u64> {
    (0..63).map(|k| 1u64 << k).take_while(move |samples| *samples <= most)
}

/// Returns whether a method has time to double the samples of its replicates. All replicates of a checkpoint are rendered, or none.
fn affordable(measured: &[Measurement], budget: &Budget, samples: u64) -> bool {
    let at = |samples: u64| measured.iter().filter(move |m| m.samples == samples).map(|m| m.seconds);
    let before = samples / 2;
    match budget.time {
        // The first replicate of a checkpoint decides for all.
        Some(time) if at(samples).next().is_none() && at(before).count() > 0 => 2.0 * at(before).sum::<f64>() <= time.as_secs_f64(),
        Some(_) if at(samples).next().is_none() && samples > 1 => false,
        _ => true,
    }
}
