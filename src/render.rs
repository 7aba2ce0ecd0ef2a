//! The one loop: waves of samples over tiles of pixels, in parallel.

mod first_hit;
mod paths;

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use crate::effects::Effects;
use crate::film::{Block, Crop, Film, FilmSpec, Layer, Moments, Slots, Tree, Wave};
use crate::integrator::{CameraSample, Context, Estimator, Integrator, Interrupt};
use crate::math::{ExactSum, Spectrum};
use crate::sampler::{Sampler, SamplerSpec, dimension};
use crate::scene::Scene;
use crate::witness::{Clamp, Witness};
use first_hit::Known;
use paths::Told;

/// How a picture is to be sampled.
#[derive(Clone, Debug)]
pub struct Settings {
    pub sampler: SamplerSpec,
    /// Samples per pixel, or fewer where the time is up.
    pub samples: u64,
    pub time: Option<Duration>,
    /// Edge of the square tiles that threads work on (pixels). Does not change the picture.
    pub tile: u32,
    /// What a single piece of indirect light may be at most, see [`Clamp`]. A bias, and never chosen by itself.
    pub clamp: Option<f32>,
    /// How long a wave of samples should take at most, so that an interrupt loses little; but none is cut to less than an eighth of
    /// what is done. Does not change the picture.
    pub wave_time: Option<Duration>,
}

impl Settings {
    pub fn new(sampler: SamplerSpec) -> Settings {
        Settings { sampler, samples: sampler.spp, time: None, tile: 16, clamp: None, wave_time: None }
    }
}

/// Told how far a render is; may end it.
pub trait Observer: Sync {
    /// Called from many threads.
    fn tile_done(&self, _camera_samples: u64) {}

    /// What the film holds is whole again: `samples` per pixel.
    fn wave_done(&self, _samples: u64, _film: &dyn Film) {}

    /// Looked at before every sample, and now and then during a long one; once it is true, it stays so.
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
    /// Per pixel; rounds of samples where the film's allocation tells pixels apart.
    pub samples: u64,
    pub cancelled: bool,
    /// Samples that were not finite or negative; they count as zero. A healthy scene has none.
    pub invalid: u64,
    /// The first few, for replay.
    pub first_invalid: Vec<SampleId>,
    /// What clamping took, summed over colours, samples and pixels.
    pub clamped: ExactSum,
    /// Preparation excluded.
    pub elapsed: Duration,
}

impl Report {
    /// Without what an earlier report of the same render had told.
    pub fn since(&self, earlier: &Report) -> Report {
        let elapsed = self.elapsed.saturating_sub(earlier.elapsed);
        Report { samples: self.samples - earlier.samples, invalid: self.invalid - earlier.invalid, elapsed, ..self.clone() }
    }
}

/// Which sample: with the seed enough to compute it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SampleId {
    pub pixel: (u32, u32),
    pub index: u64,
}

/// Waves are at most about 2^6 samples long, so that progress shows.
const MAX_WAVE_LEVEL: u32 = 6;
/// The [`Settings::wave_time`] of a render that a user may interrupt.
pub const SHORT_WAVE: Duration = Duration::from_secs(2);
/// So many invalid samples are named.
pub const KEPT_INVALID: usize = 16;

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
    let mut render = Render::new(scene, integrator, film.spec(), settings);
    match settings.time {
        Some(time) => render.advance_for(time, settings.samples, film, observer),
        None => render.advance(settings.samples, film, observer),
    }
    render.report
}

/// A render that can be taken further, sample by sample.
pub struct Render {
    scene: Arc<dyn Scene>,
    estimator: Box<dyn Estimator>,
    spec: FilmSpec,
    sampler: SamplerSpec,
    has_lens: bool,
    tiles: Vec<Crop>,
    /// Index of the sample that comes next.
    next: u64,
    clamp: Option<f32>,
    wave_time: Option<Duration>,
    report: Report,
}

/// What a tile yields: the sums of its pixels, row by row.
struct Part {
    block: Block,
    /// Of all its pixels.
    samples: u64,
    invalid: Vec<SampleId>,
    clamped: ExactSum,
}

impl Render {
    /// Prepares the integrator; nothing is sampled yet.
    pub fn new(scene: Arc<dyn Scene>, integrator: &dyn Integrator, spec: &FilmSpec, settings: &Settings) -> Render {
        let estimator = integrator.prepare(scene.clone(), spec);
        let has_lens = scene.effects().contains(Effects::THIN_LENS);
        let tiles = tiles(spec.crop, settings.tile);
        Render {
            scene,
            estimator,
            spec: spec.clone(),
            sampler: settings.sampler,
            has_lens,
            tiles,
            next: 0,
            clamp: settings.clamp,
            wave_time: settings.wave_time,
            report: Report::default(),
        }
    }

    /// Goes on where another render stopped, before the sample of this index and with what it reported: to the same bits.
    pub fn resumed(self, next: u64, report: Report) -> Render {
        Render { next, report: Report { cancelled: false, ..report }, ..self }
    }

    /// Of all that was done so far.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// One sample by itself, as it counts in the picture: what `--pixel x,y --sample k` shows. Not finite where it is invalid.
    ///
    /// - `witness`: told of its paths
    pub fn replay(&self, id: SampleId, witness: Option<&mut dyn Witness>) -> Spectrum {
        let (mut sequence, pixel, index) = self.sequence(id);
        self.sample(pixel, index, &mut *sequence, witness, Interrupt::NEVER, &mut ExactSum::default())
    }

    pub fn sampler(&self) -> &SamplerSpec {
        &self.sampler
    }

    /// What the camera hands to the estimator for one sample.
    pub fn camera(&self, id: SampleId) -> CameraSample {
        let (mut sequence, pixel, index) = self.sequence(id);
        self.camera_sample(pixel, index, &mut *sequence)
    }

    /// Whose numbers a sample takes, and its pixel and place in the sequence.
    fn sequence(&self, id: SampleId) -> (Box<dyn Sampler>, UVec2, u64) {
        let mut sequences = self.sampler.sequences();
        let k = sequences.len() as u64;
        (sequences.swap_remove((id.index % k) as usize), UVec2::new(id.pixel.0, id.pixel.1), id.index / k)
    }

    /// On until all samples below index `samples` are in. Into the same film each time.
    pub fn advance(&mut self, samples: u64, film: &mut dyn Film, observer: &dyn Observer) {
        while self.step(samples, None, film, observer) {}
    }

    /// As far as the time goes, counted with what was spent before, and at most to sample index `samples`.
    pub fn advance_for(&mut self, time: Duration, samples: u64, film: &mut dyn Film, observer: &dyn Observer) {
        while self.step(samples, Some(time), film, observer) {}
    }

    /// One wave further; `false` where there is none: all samples are in, the time is up, or the render was cancelled.
    pub fn step(&mut self, samples: u64, time: Option<Duration>, film: &mut dyn Film, observer: &dyn Observer) -> bool {
        let (start, end) = (Instant::now(), time.map_or(samples, |time| samples.min(self.affordable(time))));
        let next = Wave::next(self.next, end, self.max_wave_level());
        let Some(wave) = next.filter(|_| !self.report.cancelled) else { return false };
        self.wave(wave, film, observer);
        self.report.elapsed += start.elapsed();
        !self.report.cancelled
    }

    /// Whatever it is, the picture has the same bits: blocks of samples join in the same way however they are cut.
    fn max_wave_level(&self) -> u32 {
        let most = MAX_WAVE_LEVEL.saturating_sub(self.spec.allocation.mean().log2() as u32);
        let Report { samples, elapsed, .. } = self.report;
        let Some(time) = self.wave_time.filter(|_| samples > 0) else { return most };
        let in_time = samples as f64 * time.as_secs_f64() / elapsed.as_secs_f64();
        most.min((in_time.log2() as u32).max((samples / 8).checked_ilog2().unwrap_or(0)))
    }

    /// The sample index that will be reached within the time, at the speed so far.
    fn affordable(&self, time: Duration) -> u64 {
        let Report { samples, elapsed, .. } = self.report;
        let more = samples as f64 * time.saturating_sub(elapsed).as_secs_f64() / elapsed.as_secs_f64();
        if samples == 0 { u64::MAX } else { self.next.saturating_add(more as u64) }
    }

    /// A wave is whole or not at all: only then is the picture a function of its sample count.
    fn wave(&mut self, wave: Wave, film: &mut dyn Film, observer: &dyn Observer) {
        let tile = |tile: &Crop| {
            let part = self.tile(*tile, wave, observer);
            observer.tile_done(part.as_ref().map_or(0, |part| part.samples));
            part
        };
        let Some(parts) = self.tiles.par_iter().map(tile).collect::<Option<Vec<Part>>>() else {
            self.report.cancelled = true;
            return;
        };
        for part in &parts {
            self.report.invalid += part.invalid.len() as u64;
            let room = KEPT_INVALID - self.report.first_invalid.len();
            self.report.first_invalid.extend(part.invalid.iter().take(room));
            self.report.clamped = self.report.clamped.join(&part.clamped);
        }
        let block = self.assemble(&parts);
        drop(parts);
        film.add(wave, block);
        self.next += wave.samples();
        self.report.samples += wave.samples();
        observer.wave_done(self.report.samples, film);
    }

    /// `None` where the render was cancelled meanwhile.
    fn tile(&self, tile: Crop, wave: Wave, observer: &dyn Observer) -> Option<Part> {
        let mut sequences = self.sampler.sequences();
        let k = sequences.len() as u64;
        let (mut trees, mut gray, mut moments) = (vec![Tree::default(); sequences.len()], Tree::default(), vec![]);
        let block = Block::with_capacity(self.slots(), tile.pixel_count() as usize);
        let mut part = Part { block, samples: 0, invalid: vec![], clamped: ExactSum::default() };
        let (mut terms, is_timed) = (vec![], self.spec.layers.contains(&Layer::Time));
        let mut told = Told::new(&self.spec.layers, &self.spec.lights.of);
        let is_cancelled = || observer.cancelled();
        let interrupt = Interrupt::new(&is_cancelled);
        for (y, x) in (tile.min.y..tile.max.y).flat_map(|y| (tile.min.x..tile.max.x).map(move |x| (y, x))) {
            let wave = wave.denser(self.spec.allocation.level(self.spec.crop.index(UVec2::new(x, y))));
            let start = is_timed.then(Instant::now);
            trees.iter_mut().for_each(Tree::clear);
            gray.clear();
            told.iter_mut().for_each(Told::clear);
            for index in wave.range() {
                if is_cancelled() {
                    return None;
                }
                // Sample i of the pixel is sample i div K of sequence i mod K.
                let r = (index % k) as usize;
                let witness = told.as_mut().map(Told::witness);
                let mut value = self.sample(UVec2::new(x, y), index / k, &mut *sequences[r], witness, interrupt, &mut part.clamped);
                told.iter_mut().for_each(|told| told.keep(value.is_finite()));
                if !value.is_finite() {
                    part.invalid.push(SampleId { pixel: (x, y), index });
                    value = Spectrum::BLACK;
                }
                let sample = Moments::of(value);
                gray.push(0, sample.gray, Moments::join_gray);
                trees[r].push(0, sample, Moments::join);
            }
            moments.clear();
            moments.extend(trees.iter().map(|tree| tree.total(Moments::join).unwrap_or_default()));
            part.block.push(&moments, gray.total(Moments::join_gray).unwrap_or_default());
            part.samples += wave.samples();
            if !self.spec.layers.is_empty() {
                let seconds = start.map_or(0.0, |start| start.elapsed().as_secs_f64());
                part.block.push_layers(self.layers(UVec2::new(x, y), wave, &mut sequences, told.as_ref(), seconds, &mut terms));
            }
        }
        // The last sample may have been given up.
        (!is_cancelled()).then_some(part)
    }

    /// What the layers of a pixel add up: its camera samples once more, after the picture is done with them.
    ///
    /// - `told`: what the picture's samples told; `seconds`: that they took
    fn layers<'t>(
        &self,
        pixel: UVec2,
        wave: Wave,
        sequences: &mut [Box<dyn Sampler>],
        told: Option<&Told>,
        seconds: f64,
        terms: &'t mut Vec<f64>,
    ) -> &'t [f64] {
        terms.clear();
        let (k, seconds) = (sequences.len() as u64, seconds / wave.samples() as f64);
        for (nth, i) in wave.range().enumerate() {
            let sequence = &mut *sequences[(i % k) as usize];
            let camera = self.camera_sample(pixel, i / k, sequence);
            let light = told.map_or(&[][..], |told| told.sample(nth));
            first_hit::add_terms(&*self.scene, &self.spec.layers, &camera, sequence, Known { seconds, light }, terms);
        }
        first_hit::joined(terms, self.slots().layers)
    }

    fn slots(&self) -> Slots {
        self.spec.slots(self.sampler.spread())
    }

    /// The filtered radiance; not finite where the estimate is invalid.
    ///
    /// - `index`: within the sequence
    /// - `clamped`: takes what clamping takes
    fn sample(
        &self,
        pixel: UVec2,
        index: u64,
        sampler: &mut dyn Sampler,
        witness: Option<&mut dyn Witness>,
        interrupt: Interrupt,
        clamped: &mut ExactSum,
    ) -> Spectrum {
        let camera = self.camera_sample(pixel, index, sampler);
        // For no longer than the sequence.
        let witness = witness.map(|witness| witness as &mut dyn Witness);
        let filtered = |radiance: Spectrum| if radiance.is_valid() { radiance * camera.weight } else { Spectrum::gray(f32::NAN) };
        let Some(limit) = self.clamp else {
            return filtered(self.estimator.li(&camera, &mut Context { sampler, witness, interrupt }));
        };
        let mut clamp = Clamp::new(limit, witness);
        let value = filtered(self.estimator.li(&camera, &mut Context { sampler, witness: Some(&mut clamp), interrupt }));
        let free = filtered(clamp.free());
        if clamp.acted() && value.is_finite() && free.is_finite() {
            free.to_rgb().into_iter().for_each(|x| clamped.add(x));
            value.to_rgb().into_iter().for_each(|x| clamped.add(-x));
        }
        value
    }

    // (Into the loop, whoever else asks.)
    #[inline(always)]
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

    /// From tiles to rows of the crop.
    fn assemble(&self, parts: &[Part]) -> Block {
        let crop = self.spec.crop;
        let mut block = Block::black(self.slots(), crop.pixel_count() as usize);
        for (tile, part) in self.tiles.iter().zip(parts) {
            let width = tile.size().x as usize;
            for row in 0..tile.size().y as usize {
                let start = crop.index(tile.min + UVec2::Y * row as u32);
                block.put(start, &part.block, row * width..(row + 1) * width);
            }
        }
        block
    }
}

fn draw_lens(sampler: &mut dyn Sampler) -> Vec2 {
    sampler.at(dimension::LENS);
    sampler.next_2d()
}

fn tiles(crop: Crop, edge: u32) -> Vec<Crop> {
    let edge = edge.max(1);
    let starts = |from: u32, to: u32| (from..to).step_by(edge as usize);
    let tile = |x: u32, y: u32| Crop { min: UVec2::new(x, y), max: UVec2::new(x, y).saturating_add(UVec2::splat(edge)).min(crop.max) };
    starts(crop.min.y, crop.max.y).flat_map(|y| starts(crop.min.x, crop.max.x).map(move |x| tile(x, y))).collect()
}
