//! The one loop: waves of samples over tiles of pixels, in parallel.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use crate::effects::Effects;
use crate::film::{Crop, Film, FilmSpec, Moments, Tree, Wave};
use crate::integrator::{CameraSample, Context, Estimator, Integrator};
use crate::math::Spectrum;
use crate::sampler::{Sampler, SamplerSpec, dimension};
use crate::scene::Scene;

/// How a picture is to be sampled.
#[derive(Clone, Debug)]
pub struct Settings {
    pub sampler: SamplerSpec,
    /// Samples per pixel, or fewer where the time is up.
    pub samples: u64,
    pub time: Option<Duration>,
    /// Edge of the square tiles that threads work on (pixels). Does not change the picture.
    pub tile: u32,
}

impl Settings {
    pub fn new(sampler: SamplerSpec) -> Settings {
        Settings { sampler, samples: sampler.spp, time: None, tile: 16 }
    }
}

/// Told how far a render is; may end it.
pub trait Observer: Sync {
    /// Called from many threads.
    fn tile_done(&self, _camera_samples: u64) {}

    /// What the film holds is whole again: `samples` per pixel.
    fn wave_done(&self, _samples: u64, _film: &dyn Film) {}

    /// Looked at before every pixel.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Nobody looks.
pub struct Silent;

impl Observer for Silent {}

/// What happened beside the picture.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Per pixel.
    pub samples: u64,
    pub cancelled: bool,
    /// Samples that were not finite or negative; they count as zero. A healthy scene has none.
    pub invalid: u64,
    /// The first few, for replay.
    pub first_invalid: Vec<SampleId>,
    /// Preparation excluded.
    pub elapsed: Duration,
}

/// Which sample: with the seed enough to compute it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SampleId {
    pub pixel: (u32, u32),
    pub index: u64,
}

/// Waves are at most 2^6 samples long, so that progress shows and an interrupt loses little.
const MAX_WAVE_LEVEL: u32 = 6;
const KEPT_INVALID: usize = 16;

/// Renders `scene` into `film`.
///
/// The picture is a pure function of scene, integrator, sampler and film: threads, tiles and the
/// clock have no say in it (the clock only in how many samples there are).
pub fn render(
    scene: Arc<dyn Scene>,
    integrator: &dyn Integrator,
    film: &mut dyn Film,
    settings: &Settings,
    observer: &dyn Observer,
) -> Report {
    let spec = film.spec().clone();
    let estimator = integrator.prepare(scene.clone(), &spec);
    let job = Job::new(&*scene, &*estimator, &spec, &settings.sampler);
    let tiles = tiles(spec.crop, settings.tile);
    let start = Instant::now();
    let mut report = Report::default();
    while let Some(wave) = next_wave(&report, settings, start) {
        let parts: Vec<Option<Part>> = tiles
            .par_iter()
            .map(|tile| {
                let part = job.tile(*tile, wave, observer);
                observer.tile_done(part.as_ref().map_or(0, |_| tile.pixel_count() * wave.samples()));
                part
            })
            .collect();
        // A wave is whole or not at all: only then is the picture a function of its sample count.
        let Some(parts) = parts.into_iter().collect::<Option<Vec<Part>>>() else {
            report.cancelled = true;
            break;
        };
        for part in &parts {
            report.invalid += part.invalid.len() as u64;
            let room = KEPT_INVALID - report.first_invalid.len();
            report.first_invalid.extend(part.invalid.iter().take(room));
        }
        film.add(wave, assemble(spec.crop, &tiles, &parts));
        report.samples += wave.samples();
        observer.wave_done(report.samples, film);
    }
    report.elapsed = start.elapsed();
    report
}

/// One sample of one pixel, by itself: what `--pixel x,y --sample k` shows.
pub fn sample(scene: Arc<dyn Scene>, integrator: &dyn Integrator, spec: &FilmSpec, sampler: &SamplerSpec, id: SampleId) -> Spectrum {
    let estimator = integrator.prepare(scene.clone(), spec);
    let job = Job::new(&*scene, &*estimator, spec, sampler);
    job.sample(UVec2::new(id.pixel.0, id.pixel.1), id.index, &mut *sampler.build())
}

struct Job<'a> {
    scene: &'a dyn Scene,
    estimator: &'a dyn Estimator,
    spec: &'a FilmSpec,
    sampler: &'a SamplerSpec,
    has_lens: bool,
}

/// What a tile yields: the moments of its pixels, row by row.
struct Part {
    pixels: Vec<Moments>,
    invalid: Vec<SampleId>,
}

impl<'a> Job<'a> {
    fn new(scene: &'a dyn Scene, estimator: &'a dyn Estimator, spec: &'a FilmSpec, sampler: &'a SamplerSpec) -> Job<'a> {
        Job { scene, estimator, spec, sampler, has_lens: scene.effects().contains(Effects::THIN_LENS) }
    }

    /// `None` where the render was cancelled meanwhile.
    fn tile(&self, tile: Crop, wave: Wave, observer: &dyn Observer) -> Option<Part> {
        let mut sampler = self.sampler.build();
        let mut tree = Tree::default();
        let mut part = Part { pixels: Vec::with_capacity(tile.pixel_count() as usize), invalid: vec![] };
        for (y, x) in (tile.min.y..tile.max.y).flat_map(|y| (tile.min.x..tile.max.x).map(move |x| (y, x))) {
            if observer.cancelled() {
                return None;
            }
            tree.clear();
            for index in wave.first..wave.first + wave.samples() {
                let mut value = self.sample(UVec2::new(x, y), index, &mut *sampler);
                if !value.is_finite() {
                    part.invalid.push(SampleId { pixel: (x, y), index });
                    value = Spectrum::BLACK;
                }
                tree.push(0, Moments::of(value), Moments::join);
            }
            part.pixels.extend(tree.total(Moments::join));
        }
        Some(part)
    }

    /// The filtered radiance; not finite where the estimate is invalid.
    fn sample(&self, pixel: UVec2, index: u64, sampler: &mut dyn Sampler) -> Spectrum {
        let camera = self.camera_sample(pixel, index, sampler);
        let radiance = self.estimator.li(&camera, &mut Context { sampler });
        if radiance.is_valid() { radiance * camera.weight } else { Spectrum::gray(f32::NAN) }
    }

    fn camera_sample(&self, pixel: UVec2, index: u64, sampler: &mut dyn Sampler) -> CameraSample {
        sampler.start(pixel, index);
        sampler.at(dimension::FILM);
        let (offset, weight) = self.spec.filter.sample(sampler.next_2d());
        // Every effect owns its dimensions: not asking for a lens shifts no other number.
        let lens = if self.has_lens { draw_lens(sampler) } else { Vec2::ZERO };
        let raster = pixel.as_vec2() + 0.5 + offset;
        let ray = self.scene.camera().ray(raster / self.spec.size.as_vec2(), self.spec.aspect(), lens);
        CameraSample { ray, weight, pixel, raster }
    }
}

fn draw_lens(sampler: &mut dyn Sampler) -> Vec2 {
    sampler.at(dimension::LENS);
    sampler.next_2d()
}

/// The next aligned wave within the budget of samples and time.
fn next_wave(report: &Report, settings: &Settings, start: Instant) -> Option<Wave> {
    let done = report.samples;
    let mut total = settings.samples;
    if let (Some(time), true) = (settings.time, done > 0) {
        let elapsed = start.elapsed();
        let affordable = done as f64 * time.saturating_sub(elapsed).as_secs_f64() / elapsed.as_secs_f64();
        total = total.min(done.saturating_add(affordable as u64));
    }
    Wave::next(done, total, MAX_WAVE_LEVEL)
}

fn tiles(crop: Crop, edge: u32) -> Vec<Crop> {
    let edge = edge.max(1);
    let starts = |from: u32, to: u32| (from..to).step_by(edge as usize);
    let tile = |x: u32, y: u32| Crop { min: UVec2::new(x, y), max: UVec2::new(x, y).saturating_add(UVec2::splat(edge)).min(crop.max) };
    starts(crop.min.y, crop.max.y).flat_map(|y| starts(crop.min.x, crop.max.x).map(move |x| tile(x, y))).collect()
}

/// From tiles to rows of the crop.
fn assemble(crop: Crop, tiles: &[Crop], parts: &[Part]) -> Vec<Moments> {
    let mut pixels = vec![Moments::default(); crop.pixel_count() as usize];
    for (tile, part) in tiles.iter().zip(parts) {
        let width = tile.size().x as usize;
        for (row, values) in part.pixels.chunks(width).enumerate() {
            let y = tile.min.y - crop.min.y + row as u32;
            let start = y as usize * crop.size().x as usize + (tile.min.x - crop.min.x) as usize;
            pixels[start..start + width].copy_from_slice(values);
        }
    }
    pixels
}
