//! The pictures that are measured: replicates of a scene with and without its effects, on the same random numbers.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::UVec2;
use rayon::prelude::*;

use super::paths::{PathFacts, PathSorter};
use crate::film::{FilmSpec, MomentFilm};
use crate::integrator::Integrator;
use crate::load::Loaded;
use crate::render::{Observer, Render, SampleId, Settings};
use crate::sampler::SamplerSpec;
use crate::world::World;

/// A picture: red, green and blue of each pixel, one after the other.
pub type Pixels = Vec<f32>;

/// A way to render a scene.
pub struct Way {
    world: Arc<World>,
    integrator: Arc<dyn Integrator>,
    film: FilmSpec,
}

impl Way {
    /// The way of a scene.
    pub fn of(loaded: &Loaded) -> Way {
        Way { world: loaded.world.clone(), integrator: loaded.integrator.clone(), film: loaded.film.clone() }
    }

    /// A film that shows the same view with about `pixels` pixels.
    fn film(&self, pixels: f32) -> FilmSpec {
        self.film.with_pixels(pixels)
    }
}

/// Whether a path contains a part of the light.
pub type Contains = fn(&PathFacts) -> bool;

/// Size of the pictures, and number of replicates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Number of pixels, about.
    pub pixels: u32,
    /// Samples of each pixel and replicate.
    pub samples: u64,
    /// Number of replicates at most; pairs of them are compared.
    pub replicates: u32,
    /// Time of all replicates; at least four are rendered.
    pub time: Option<Duration>,
}

/// Smallest number of replicates.
pub const FEWEST: u32 = 4;
/// Number of replicates that a plan for a time aims at, and the largest number if they take less time than expected.
const REPLICATES: [u32; 2] = [24, 96];
/// Smallest and largest number of pixels of such a plan, if the film has as many.
const PIXELS: [f64; 2] = [256.0, 3072.0];
/// Pixels whose samples tell the speed.
const PROBE: f32 = 512.0;

impl Plan {
    /// Plan for a time: the speed is that of a few samples, with and without a record of their paths.
    ///
    /// - `ways`: number of ways that are rendered
    pub fn for_time(time: Duration, scene: &Way, ways: usize, sampler: SamplerSpec, observer: &dyn Observer) -> Plan {
        let start = Instant::now();
        let probe = Plan { pixels: PROBE as u32, samples: 1, replicates: 1, time: None };
        // The first samples are slower than others.
        let plain = (0..2).map(|_| rendered(scene, &probe, sampler, observer).1).fold(f64::INFINITY, f64::min);
        let recorded = recorded(scene, &probe, sampler, &[], observer).1;
        let pixels = scene.film(PROBE).crop.pixel_count() as f64;
        let of_sample = (plain * ways as f64 + recorded) / pixels;
        let left = time.saturating_sub(start.elapsed());
        let samples = left.as_secs_f64() / (f64::from(REPLICATES[0]) * of_sample);
        let pixels = samples.clamp(PIXELS[0], PIXELS[1]).min(scene.film.crop.pixel_count() as f64);
        // Sequences are even at powers of two.
        let samples = 1 << (samples / pixels).max(1.0).log2() as u32;
        Plan { pixels: pixels as u32, samples, replicates: REPLICATES[1], time: Some(left) }
    }
}

/// One replicate of all pictures.
pub struct Replicate {
    /// The picture of each way, and its time (s).
    pub of_ways: Vec<(Pixels, f64)>,
    /// The part of the first way's picture that each kind of paths brings.
    pub of_paths: Vec<Pixels>,
}

/// Renders all replicates. `None` if the observer ended it.
///
/// In each replicate all ways take their turn with the same seed, in an order that changes, so that a machine that becomes slower slows all of
/// them.
pub fn replicates(ways: &[Way], paths: &[Contains], plan: &Plan, sampler: SamplerSpec, observer: &dyn Observer) -> Option<Vec<Replicate>> {
    let start = Instant::now();
    let mut all: Vec<Replicate> = vec![];
    for r in 0..plan.replicates {
        let spent = start.elapsed();
        // Pairs are compared.
        if r >= FEWEST && r % 2 == 0 && plan.time.is_some_and(|time| spent + 2 * (spent / r) > time) {
            break;
        }
        let seed = sampler.seed.wrapping_add(1 + u64::from(r));
        // The variance among the replicates gives the error.
        let sampler = SamplerSpec { seed, spp: plan.samples, scramblings: 1, ..sampler };
        let mut of_ways: Vec<Option<(Pixels, f64)>> = ways.iter().map(|_| None).collect();
        let turn = |k: usize| if r % 2 == 0 { k } else { ways.len() - 1 - k };
        for way in (0..ways.len()).map(turn) {
            of_ways[way] = Some(rendered(&ways[way], plan, sampler, observer));
        }
        let of_paths = recorded(&ways[0], plan, sampler, paths, observer).0;
        if observer.cancelled() {
            return None;
        }
        all.push(Replicate { of_ways: of_ways.into_iter().flatten().collect(), of_paths });
    }
    Some(all)
}

fn prepared(way: &Way, plan: &Plan, sampler: SamplerSpec) -> (FilmSpec, Render) {
    let film = way.film(plan.pixels as f32);
    let settings = Settings { samples: plan.samples, tile: 8, ..Settings::new(sampler) };
    let render = Render::new(way.world.clone(), &*way.integrator, &film, &settings);
    (film, render)
}

/// A picture, and the time that it took (s).
fn rendered(way: &Way, plan: &Plan, sampler: SamplerSpec, observer: &dyn Observer) -> (Pixels, f64) {
    let (spec, mut render) = prepared(way, plan, sampler);
    let mut film = MomentFilm::new(spec);
    render.advance(plan.samples, &mut film, observer);
    (film.image().pixels().flatten().collect(), render.report().elapsed.as_secs_f64())
}

/// The part of the picture that each kind of paths brings, and the time that it took (s). Samples that are not finite count as black, as in
/// the picture.
fn recorded(way: &Way, plan: &Plan, sampler: SamplerSpec, paths: &[Contains], observer: &dyn Observer) -> (Vec<Pixels>, f64) {
    let (spec, render) = prepared(way, plan, sampler);
    let start = Instant::now();
    let (width, shapes) = (u64::from(spec.crop.size().x), way.world.shapes());
    let pixel = |i: u64| {
        let pixel = spec.crop.min + UVec2::new((i % width) as u32, (i / width) as u32);
        let mut sums = vec![[0.0f64; 3]; paths.len()];
        for index in (0..plan.samples).take_while(|_| !observer.cancelled()) {
            let id = SampleId { pixel: pixel.into(), index };
            let mut found = vec![[0.0f64; 3]; paths.len()];
            let mut sorter = PathSorter::new(&way.world, &shapes, |light, path: &PathFacts| {
                for (sum, _) in found.iter_mut().zip(paths).filter(|(_, contains)| contains(path)) {
                    sum.iter_mut().zip(light.to_rgb()).for_each(|(sum, x)| *sum += f64::from(x));
                }
            });
            if render.replay(id, Some(&mut sorter)).is_finite() {
                let weight = f64::from(render.camera(id).weight) / plan.samples as f64;
                sums.iter_mut().flatten().zip(found.iter().flatten()).for_each(|(sum, x)| *sum += weight * x);
            }
        }
        sums
    };
    let sums: Vec<Vec<[f64; 3]>> = (0..spec.crop.pixel_count()).into_par_iter().map(pixel).collect();
    let of = |k: usize| sums.iter().flat_map(|pixel| pixel[k]).map(|x| x as f32).collect();
    ((0..paths.len()).map(of).collect(), start.elapsed().as_secs_f64())
}
