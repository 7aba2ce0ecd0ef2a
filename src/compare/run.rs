//! Takes the measurements: every method, every replicate, checkpoint by checkpoint.

use std::sync::Arc;
use std::time::Duration;

use super::curve;
use super::{Measurement, Method, Reference};
use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::Integrator;
use crate::measure::metric::{Named, Pair};
use crate::measure::{Distance, Metric};
use crate::output::Tonemap;
use crate::render::{Observer, Render, Settings};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;

/// A way to render a scene.
pub struct Contestant {
    pub name: String,
    pub integrator_name: String,
    pub sampler_name: String,
    pub integrator: Arc<dyn Integrator>,
    pub sampler: SamplerSpec,
    pub lacks: String,
}

/// How much is rendered, and what is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Independent renders of each method; at least two, so that their spread is seen.
    pub replicates: u32,
    /// Samples per pixel of each replicate at most.
    pub samples: u64,
    /// Render time of each method, its replicates together.
    pub time: Option<Duration>,
    /// Beside mse and relMSE.
    pub metrics: Vec<Metric>,
}

/// One replicate of a method on its way.
struct Run {
    render: Render,
    film: MomentFilm,
}

/// Renders all contestants in turn, a checkpoint at a time, and measures each picture against the reference.
///
/// Interleaved like this, a machine that slows down slows all of them; and only rendering is on the clock.
/// `None` where the observer ended it.
pub fn run(
    scene: &Arc<dyn Scene>,
    spec: &FilmSpec,
    contestants: Vec<Contestant>,
    effort: &Effort,
    reference: &Reference,
    confidence: f64,
    observer: &dyn Observer,
) -> Option<Vec<Method>> {
    let start = |contestant: &Contestant, replicate: u32| {
        let seed = contestant.sampler.seed.wrapping_add(1 + u64::from(replicate));
        // One long sequence each: the spread among the replicates tells the error.
        let sampler = SamplerSpec { seed, spp: effort.samples, scramblings: 1, ..contestant.sampler };
        let render = Render::new(scene.clone(), &*contestant.integrator, spec, &Settings::new(sampler));
        Run { render, film: MomentFilm::new(spec.clone()) }
    };
    let mut runs: Vec<Vec<Run>> = contestants.iter().map(|c| (0..effort.replicates).map(|r| start(c, r)).collect()).collect();
    let mut measured: Vec<Vec<Measurement>> = runs.iter().map(|_| vec![]).collect();
    for samples in doubling(effort.samples) {
        let mut advanced = false;
        // Replicate by replicate, so that neighbours on the clock are different methods.
        for replicate in 0..effort.replicates as usize {
            for (method, runs) in runs.iter_mut().enumerate() {
                if !affordable(&measured[method], effort, samples) {
                    continue;
                }
                advanced = true;
                let Run { render, film } = &mut runs[replicate];
                render.advance(samples, film, observer);
                if render.report().cancelled {
                    return None;
                }
                let (image, replicate) = (film.image(), replicate as u32);
                let Distance { mse, relmse, trimmed } = Distance::between(&image, &reference.image)?;
                let others = others(&effort.metrics, &contestants[method].name, &image, reference)?;
                let seconds = render.report().elapsed.as_secs_f64();
                measured[method].push(Measurement { replicate, samples, seconds, mse, relmse, trimmed, others });
            }
        }
        if !advanced {
            break;
        }
    }
    let methods = contestants.into_iter().zip(runs).zip(measured).map(|((contestant, runs), measurements)| {
        let pictures: Vec<Image> = runs.iter().map(|run| run.film.image()).collect();
        curve::method(contestant, &pictures, measurements, reference, confidence)
    });
    Some(methods.collect())
}

/// `None` for pictures that cannot be compared.
fn others(metrics: &[Metric], name: &str, image: &Image, reference: &Reference) -> Option<Vec<f64>> {
    if metrics.is_empty() {
        return Some(vec![]);
    }
    let named = |name, image| Named { name, image };
    let pair = Pair::new(named(name, image), named(&reference.origin, &reference.image), Tonemap::default()).ok()?;
    Some(metrics.iter().map(|metric| metric.measure(&pair).value).collect())
}

/// 1, 2, 4, … up to `most`.
fn doubling(most: u64) -> impl Iterator<Item = u64> {
    (0..63).map(|k| 1u64 << k).take_while(move |samples| *samples <= most)
}

/// Whether a method has the time for its replicates to double. All of a checkpoint's replicates, or none.
fn affordable(measured: &[Measurement], effort: &Effort, samples: u64) -> bool {
    let at = |samples: u64| measured.iter().filter(move |m| m.samples == samples).map(|m| m.seconds);
    let before = samples / 2;
    match effort.time {
        // The first of a checkpoint decides for all.
        Some(time) if at(samples).next().is_none() && at(before).count() > 0 => 2.0 * at(before).sum::<f64>() <= time.as_secs_f64(),
        Some(_) if at(samples).next().is_none() && samples > 1 => false,
        _ => true,
    }
}
