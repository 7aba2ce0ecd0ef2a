//! Render loop: waves of samples over tiles of pixels, in parallel.

mod aovs;
mod batches;
mod light_paths;
mod pixel;

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use crate::camera::CameraRay;
use crate::effects::Effects;
use crate::film::{Crop, Film, FilmSpec, Layer, PixelLayout, PixelSums, Splat, SplatSums, Wave};
use crate::integrator::{CameraSample, Context, Estimator, Integrator, Interrupt, LightPath, SideBySide};
use crate::math::{ExactSum, Ray, RayDifferential, Spectrum};
use crate::medium::Inside;
use crate::recorder::{Clamp, PathRecorder};
use crate::sampler::{SampleNumbers, SamplerSpec, Sequence, dimension};
use crate::scene::Scene;
use aovs::Taken;
use batches::Batches;
use light_paths::LightPaths;
use pixel::PixelAccumulator;

/// Settings of the sampling of a picture.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Sampler.
    pub sampler: SamplerSpec,
    /// Samples per pixel, or rounds of samples if the film's allocation is uneven; fewer if the time is up.
    pub samples: u64,
    /// Limit of the time of rendering.
    pub time: Option<Duration>,
    /// Edge length of the square tiles that threads work on (pixels). It does not change the picture.
    pub tile: u32,
    /// Greatest value of a single contribution of indirect light, see [`Clamp`]. This is a bias and never a default.
    pub clamp: Option<f32>,
    /// Desired greatest duration of a wave of samples, so that an interrupt loses little. This makes no wave shorter than about an
    /// eighth of the samples so far. It does not change the picture.
    pub wave_time: Option<Duration>,
}

impl Settings {
    /// Settings for all planned samples of a sampler, without limits.
    pub fn new(sampler: SamplerSpec) -> Settings {
        Settings { sampler, samples: sampler.spp, time: None, tile: 16, clamp: None, wave_time: None }
    }
}

/// Observer of the progress of a render, which may cancel it.
pub trait Observer: Sync {
    /// A tile is done, after `_camera_samples` samples, or was cancelled, after 0. Called from many threads.
    fn tile_done(&self, _camera_samples: u64) {}

    /// A wave is done, and the film has `_samples` samples for each pixel.
    fn wave_done(&self, _samples: u64, _film: &dyn Film) {}

    /// Whether the render is cancelled. Called before every sample and from time to time during long ones, and for paths side by side at
    /// each vertex of a batch of them; once `true`, it must stay so.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Observer that ignores everything.
pub struct Silent;

impl Observer for Silent {}

/// Statistics of a render.
#[derive(Clone, Debug, Default)]
pub struct RenderReport {
    /// Samples per pixel, or rounds of samples if the film's allocation is uneven.
    pub samples: u64,
    /// Whether the render was cancelled.
    pub cancelled: bool,
    /// Number of samples that were not finite or were negative. They count as zero; where only what a light path brings to another pixel is
    /// invalid, that alone does. A sound scene has none.
    pub invalid: u64,
    /// First few of the invalid samples, for replay.
    pub first_invalid: Vec<SampleId>,
    /// Radiance removed by clamping, summed over colours, samples and pixels.
    pub clamped: ExactSum,
    /// Time of rendering, without preparation.
    pub elapsed: Duration,
}

impl RenderReport {
    /// The report, with the samples, invalid samples and time since an earlier one of the same render. The other fields are those of the
    /// whole render.
    pub fn since(&self, earlier: &RenderReport) -> RenderReport {
        let elapsed = self.elapsed.saturating_sub(earlier.elapsed);
        RenderReport { samples: self.samples - earlier.samples, invalid: self.invalid - earlier.invalid, elapsed, ..self.clone() }
    }
}

/// Pixel and index of a sample. With the seed, they suffice to compute it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SampleId {
    /// Column and row of the pixel.
    pub pixel: (u32, u32),
    /// Index of the sample within the pixel.
    pub index: u64,
}

/// Binary logarithm of the greatest number of samples per wave, small enough to show progress.
const MAX_WAVE_LEVEL: u32 = 6;
/// [`Settings::wave_time`] of a render that a user may interrupt.
pub const SHORT_WAVE: Duration = Duration::from_secs(2);
/// Number of invalid samples that are reported.
pub const KEPT_INVALID: usize = 16;

/// Renders `scene` into `film`.
///
/// The picture is a pure function of scene, integrator, sampler and film. Threads and tiles do not change it, and the clock only
/// changes the number of samples.
pub fn render(
    scene: Arc<dyn Scene>,
    integrator: &dyn Integrator,
    film: &mut dyn Film,
    settings: &Settings,
    observer: &dyn Observer,
) -> RenderReport {
    let mut render = Render::new(scene, integrator, film.spec(), settings);
    match settings.time {
        Some(time) => render.advance_for(time, settings.samples, film, observer),
        None => render.advance(settings.samples, film, observer),
    }
    render.report
}

/// Render that can be continued sample by sample.
pub struct Render {
    scene: Arc<dyn Scene>,
    estimator: Box<dyn Estimator>,
    spec: FilmSpec,
    sampler: SamplerSpec,
    /// Sequences of the sampler. Sample i of a pixel is sample i div K of sequence i mod K.
    sequences: Vec<Sequence>,
    /// Paths from the lights, if the integrator follows any.
    light_paths: Option<LightPaths>,
    has_lens: bool,
    has_motion: bool,
    /// Bodies with media around the camera.
    inside: Inside,
    /// Whether textures are averaged over footprints.
    has_footprints: bool,
    tiles: Vec<Crop>,
    /// Index of the next sample.
    next: u64,
    clamp: Option<f32>,
    wave_time: Option<Duration>,
    report: RenderReport,
}

/// Result of a tile for one wave.
struct TileResult {
    /// Sums of the pixels, row by row.
    sums: PixelSums,
    /// Number of camera samples of all pixels.
    samples: u64,
    /// Light that arrived anywhere on the film, in the order of the samples.
    splats: Vec<Splat>,
    invalid: Vec<SampleId>,
    clamped: ExactSum,
}

impl Render {
    /// Prepares the integrator. No sample is taken yet.
    pub fn new(scene: Arc<dyn Scene>, integrator: &dyn Integrator, spec: &FilmSpec, settings: &Settings) -> Render {
        let estimator = integrator.prepare(scene.clone(), spec);
        let (has_lens, has_motion) = (scene.effects().contains(Effects::THIN_LENS), scene.effects().contains(Effects::MOTION));
        debug_assert!(spec.allocation.is_even() || !integrator.splats(), "splats need the same number of samples for all pixels");
        let light_paths = integrator.splats().then(|| LightPaths::new(spec, &settings.sampler));
        let tiles = match &light_paths {
            None => tiles(spec.crop, settings.tile),
            Some(paths) => paths.strips(settings.tile.saturating_mul(settings.tile)),
        };
        Render {
            estimator,
            spec: spec.clone(),
            sampler: settings.sampler,
            sequences: settings.sampler.sequences(),
            light_paths,
            has_lens,
            has_motion,
            inside: scene.media().map_or_else(Inside::default, |media| *media.at_camera()),
            has_footprints: scene.effects().contains(Effects::FOOTPRINTS) && spec.texture_footprint.is_on(),
            tiles,
            scene,
            next: 0,
            clamp: settings.clamp,
            wave_time: settings.wave_time,
            report: RenderReport::default(),
        }
    }

    /// Continues after another render, with the sample `next` and its report. The picture has the same bits as without the pause.
    pub fn resumed(self, next: u64, report: RenderReport) -> Render {
        Render { next, report: RenderReport { cancelled: false, ..report }, ..self }
    }

    /// Statistics of all samples so far.
    pub fn report(&self) -> &RenderReport {
        &self.report
    }

    /// Computes one sample as it counts in the picture, as for `--pixel x,y --sample k`. The result is not finite if the sample is
    /// invalid.
    ///
    /// - `recorder`: receives the events of the paths
    pub fn replay(&self, id: SampleId, recorder: Option<&mut dyn PathRecorder>) -> Spectrum {
        self.replay_with_splats(id, recorder).0
    }

    /// Computes one sample as [`Render::replay`] does, and the light that its path from a light brings to the pixels of the crop.
    pub fn replay_with_splats(&self, id: SampleId, recorder: Option<&mut dyn PathRecorder>) -> (Spectrum, Vec<Splat>) {
        let mut splats = vec![];
        let (value, is_valid) = self.single(id, shortened(recorder), Interrupt::NEVER, &mut splats);
        (if is_valid { value } else { Spectrum::gray(f32::NAN) }, splats)
    }

    /// Computes one sample apart from the others. Returns its value, and whether its splats are valid, which are added to `splats`.
    fn single(
        &self,
        id: SampleId,
        recorder: Option<&mut dyn PathRecorder>,
        interrupt: Interrupt,
        splats: &mut Vec<Splat>,
    ) -> (Spectrum, bool) {
        let pixel = UVec2::from(id.pixel);
        let (_, mut numbers) = self.numbers(pixel, id.index);
        let camera = self.camera_sample(pixel, id.index, &mut numbers);
        let mut is_valid = true;
        let light_path = self.light_path(pixel, id.index, splats, &mut is_valid);
        let mut cx = Context { numbers, recorder: shortened(recorder), interrupt, light_path };
        (self.sample(&camera, &mut cx, &mut ExactSum::default()), is_valid)
    }

    /// Whether paths from the lights bring light to other pixels than that of the sample.
    pub fn splats(&self) -> bool {
        self.light_paths.is_some()
    }

    /// Whether textures are averaged over footprints.
    pub fn has_footprints(&self) -> bool {
        self.has_footprints
    }

    /// What the path from a light needs that belongs to a sample, if there is one.
    #[inline(always)]
    fn light_path<'a>(&'a self, pixel: UVec2, index: u64, splats: &'a mut Vec<Splat>, is_valid: &'a mut bool) -> Option<LightPath<'a>> {
        let numbers = self.light_paths.as_ref()?.numbers(pixel, index);
        Some(LightPath::new(numbers, &self.spec, self.scene.camera(), splats, is_valid))
    }

    /// Settings of the sampler.
    pub fn sampler(&self) -> &SamplerSpec {
        &self.sampler
    }

    /// Camera ray of one sample.
    pub fn camera(&self, id: SampleId) -> CameraSample {
        let pixel = UVec2::from(id.pixel);
        self.camera_sample(pixel, id.index, &mut self.numbers(pixel, id.index).1)
    }

    /// Index of the sequence of a sample, and the numbers of the sample.
    #[inline]
    fn numbers(&self, pixel: UVec2, index: u64) -> (usize, SampleNumbers<'_>) {
        let k = self.sequences.len() as u64;
        let r = (index % k) as usize;
        (r, self.sequences[r].sample(pixel, index / k))
    }

    /// Renders all samples below the index `samples`. The film must be the same in each call.
    pub fn advance(&mut self, samples: u64, film: &mut dyn Film, observer: &dyn Observer) {
        while self.step(samples, None, film, observer) {}
    }

    /// Renders for a total time, including the time spent before, and at most up to the sample index `samples`.
    pub fn advance_for(&mut self, time: Duration, samples: u64, film: &mut dyn Film, observer: &dyn Observer) {
        while self.step(samples, Some(time), film, observer) {}
    }

    /// Renders one wave. Returns `false` if no wave is left because all samples are done, the time is up, or the render was cancelled.
    pub fn step(&mut self, samples: u64, time: Option<Duration>, film: &mut dyn Film, observer: &dyn Observer) -> bool {
        let (start, end) = (Instant::now(), time.map_or(samples, |time| samples.min(self.affordable(time))));
        let next = Wave::next(self.next, end, self.max_wave_level());
        let Some(wave) = next.filter(|_| !self.report.cancelled) else { return false };
        self.wave(wave, film, observer);
        self.report.elapsed += start.elapsed();
        !self.report.cancelled
    }

    /// Binary logarithm of the greatest length of the next wave. It does not change the picture, because sums of any split join to the
    /// same bits.
    fn max_wave_level(&self) -> u32 {
        // Splats are added sample by sample.
        if self.splats() {
            return 0;
        }
        let most = MAX_WAVE_LEVEL.saturating_sub(self.spec.allocation.mean().log2() as u32);
        let RenderReport { samples, elapsed, .. } = self.report;
        let Some(time) = self.wave_time.filter(|_| samples > 0) else { return most };
        let in_time = samples as f64 * time.as_secs_f64() / elapsed.as_secs_f64();
        most.min((in_time.log2() as u32).max((samples / 8).checked_ilog2().unwrap_or(0)))
    }

    /// Sample index that can be reached within the time at the speed so far. The first sample is often slower than the others, so after
    /// it alone half a sample more is tried.
    fn affordable(&self, time: Duration) -> u64 {
        let RenderReport { samples, elapsed, .. } = self.report;
        let more = samples as f64 * time.saturating_sub(elapsed).as_secs_f64() / elapsed.as_secs_f64();
        if samples == 0 { u64::MAX } else { self.next.saturating_add(if samples == 1 { more.round() } else { more } as u64) }
    }

    /// Renders a wave completely or, if cancelled, not at all, so that the picture is a function of its sample count.
    fn wave(&mut self, wave: Wave, film: &mut dyn Film, observer: &dyn Observer) {
        let tile = |tile: &Crop| {
            let result = self.tile(*tile, wave, observer);
            observer.tile_done(result.as_ref().map_or(0, |result| result.samples));
            result
        };
        let mut splats = self.splats().then(|| SplatSums::new(&self.spec));
        let batch = if self.splats() { LightPaths::batch(&self.tiles) } else { self.tiles.len() };
        let mut results: Vec<TileResult> = Vec::with_capacity(self.tiles.len());
        for batch in self.tiles.chunks(batch) {
            let Some(mut done) = batch.par_iter().map(tile).collect::<Option<Vec<TileResult>>>() else {
                self.report.cancelled = true;
                return;
            };
            if let Some(splats) = &mut splats {
                splats.add(&done.iter().map(|result| &result.splats[..]).collect::<Vec<_>>());
                done.iter_mut().for_each(|result| result.splats = vec![]);
            }
            results.append(&mut done);
        }
        for result in &results {
            self.report.invalid += result.invalid.len() as u64;
            let room = KEPT_INVALID - self.report.first_invalid.len();
            self.report.first_invalid.extend(result.invalid.iter().take(room));
            self.report.clamped = self.report.clamped.join(&result.clamped);
        }
        let mut sums = self.assemble(&results);
        drop(results);
        if let Some(splats) = splats {
            sums.add_to_sample((wave.first % self.sequences.len() as u64) as usize, splats.numbers());
        }
        film.add(wave, sums);
        self.next += wave.samples();
        self.report.samples += wave.samples();
        observer.wave_done(self.report.samples, film);
    }

    /// Renders the samples of a wave in a tile; `None` if the render was cancelled meanwhile.
    fn tile(&self, tile: Crop, wave: Wave, observer: &dyn Observer) -> Option<TileResult> {
        let mut accumulator = PixelAccumulator::new(&self.spec, self.sequences.len());
        let shown = tile.intersection(self.spec.crop);
        let sums = PixelSums::with_capacity(self.layout(), shown.pixel_count() as usize);
        let mut result = TileResult { sums, samples: 0, splats: vec![], invalid: vec![], clamped: ExactSum::default() };
        let is_timed = self.spec.layers.contains(&Layer::Time);
        let is_cancelled = || observer.cancelled();
        let interrupt = Interrupt::new(&is_cancelled);
        if let Some(method) = self.side_by_side(&accumulator) {
            let batches = Batches { render: self, method, accumulator, result, interrupt };
            return batches.render(tile, wave).filter(|_| !is_cancelled());
        }
        for (y, x) in (tile.min.y..tile.max.y).flat_map(|y| (tile.min.x..tile.max.x).map(move |x| (y, x))) {
            // Outside of the crop only the paths from the lights count.
            if self.splats() && !shown.contains(UVec2::new(x, y)) {
                for index in wave.range() {
                    if is_cancelled() {
                        return None;
                    }
                    let id = SampleId { pixel: (x, y), index };
                    let (_, is_valid) = self.single(id, None, interrupt, &mut result.splats);
                    if !is_valid {
                        result.invalid.push(id);
                    }
                }
                continue;
            }
            let wave = wave.scaled(self.spec.allocation.level(self.spec.crop.index(UVec2::new(x, y))));
            let pixel = UVec2::new(x, y);
            accumulator.clear();
            for index in wave.range() {
                if is_cancelled() {
                    return None;
                }
                let start = is_timed.then(Instant::now);
                let (r, mut numbers) = self.numbers(pixel, index);
                let mut camera = self.camera_sample(pixel, index, &mut numbers);
                if let Some(aovs) = &accumulator.aovs {
                    camera = aovs.traced(camera, &*self.scene);
                }
                let mut light_is_valid = true;
                let light_path = self.light_path(pixel, index, &mut result.splats, &mut light_is_valid);
                let mut cx = Context { numbers, recorder: shortened(accumulator.recorder()), interrupt, light_path };
                let value = self.sample(&camera, &mut cx, &mut result.clamped);
                let seconds = start.map_or(0.0, |start| start.elapsed().as_secs_f64());
                let is_valid = accumulator.add(r, value);
                if !is_valid || !light_is_valid {
                    result.invalid.push(SampleId { pixel: (x, y), index });
                }
                if let Some(aovs) = &mut accumulator.aovs {
                    aovs.add(&*self.scene, Taken { camera: &camera, numbers, is_valid, seconds });
                }
            }
            accumulator.push_colors(&mut result.sums);
            result.samples += wave.samples();
            if let Some(aovs) = &mut accumulator.aovs {
                result.sums.push_layers(aovs.sums(self.layout().layers));
            }
        }
        // The last sample may have been given up midway.
        (!is_cancelled()).then_some(result)
    }

    /// The method for many samples at once, if nothing asks for single ones.
    fn side_by_side(&self, accumulator: &PixelAccumulator) -> Option<&dyn SideBySide> {
        let is_plain = accumulator.aovs.is_none() && self.clamp.is_none() && !self.splats() && !self.has_motion;
        self.estimator.side_by_side().filter(|_| is_plain)
    }

    /// Layout of the sums of a pixel.
    fn layout(&self) -> PixelLayout {
        self.spec.layout(self.sampler.error_estimator())
    }

    /// Radiance of a sample times its weight; not finite if the estimate is invalid.
    ///
    /// - `clamped`: sum to which the radiance removed by clamping is added
    fn sample(&self, camera: &CameraSample, cx: &mut Context, clamped: &mut ExactSum) -> Spectrum {
        let filtered = |radiance| filtered(radiance, camera.weight);
        let Some(limit) = self.clamp else {
            return filtered(self.estimator.li(camera, cx));
        };
        let mut clamp = Clamp::new(limit, shortened(cx.recorder.take()));
        let (recorder, light_path) = (Some(&mut clamp as &mut dyn PathRecorder), cx.light_path.take());
        let value = filtered(self.estimator.li(camera, &mut Context { recorder, light_path, ..*cx }));
        let unclamped = filtered(clamp.unclamped());
        if clamp.acted() && value.is_finite() && unclamped.is_finite() {
            unclamped.to_rgb().into_iter().for_each(|x| clamped.add(x));
            value.to_rgb().into_iter().for_each(|x| clamped.add(-x));
        }
        value
    }

    /// Camera ray of a sample.
    // Always inlined into the loop, although there are other callers.
    #[inline(always)]
    fn camera_sample(&self, pixel: UVec2, index: u64, numbers: &mut SampleNumbers) -> CameraSample {
        let (offset, filter) = self.spec.filter.sample(numbers.get_2d(dimension::FILM));
        // Each effect owns its dimensions, so that drawing no lens point and no time shifts no other number.
        let lens = if self.has_lens { numbers.get_2d(dimension::LENS) } else { Vec2::ZERO };
        let time = if self.has_motion { drawn_time(numbers) } else { 0.0 };
        let raster = pixel.as_vec2() + 0.5 + offset;
        let film = raster / self.spec.size.as_vec2();
        let CameraRay { ray, weight } = self.scene.camera().sample(film, self.spec.aspect(), lens, time);
        let differential = if self.has_footprints { Some(self.differential(&ray, raster, lens, index)) } else { None };
        CameraSample { ray, weight: filter * weight, pixel, raster, known_hit: None, inside: self.inside, differential }
    }

    /// Differential of a camera ray at the distance of the texture footprint of its sample.
    // Never inlined, so that scenes without textures do not pay for it.
    #[inline(never)]
    fn differential(&self, ray: &Ray, raster: Vec2, lens: Vec2, index: u64) -> RayDifferential {
        let size = self.spec.size.as_vec2();
        let between = self.scene.camera().differential(ray, raster / size, 1.0 / size, self.spec.aspect(), lens);
        between * self.spec.texture_footprint.width(index, self.sequences.len() as u64)
    }

    /// Assembles the sums of all tiles into rows of the crop.
    fn assemble(&self, results: &[TileResult]) -> PixelSums {
        let crop = self.spec.crop;
        let mut sums = PixelSums::black(self.layout(), crop.pixel_count() as usize);
        for (tile, result) in self.tiles.iter().zip(results) {
            let tile = tile.intersection(crop);
            let width = tile.size().x as usize;
            for row in 0..tile.size().y as usize {
                let start = crop.index(tile.min + UVec2::Y * row as u32);
                sums.put(start, &result.sums, row * width..(row + 1) * width);
            }
        }
        sums
    }
}

/// Radiance times the weight of a sample; not finite if it is invalid.
fn filtered(radiance: Spectrum, weight: f32) -> Spectrum {
    if radiance.is_valid() { radiance * weight } else { Spectrum::gray(f32::NAN) }
}

/// Shortens the lifetime of the trait object to that of the reference.
fn shortened<'a, 'b: 'a>(recorder: Option<&'a mut (dyn PathRecorder + 'b)>) -> Option<&'a mut (dyn PathRecorder + 'a)> {
    recorder.map(|recorder| recorder as &mut dyn PathRecorder)
}

/// Tiles of at most `edge` × `edge` pixels.
fn tiles(crop: Crop, edge: u32) -> Vec<Crop> {
    let edge = edge.max(1);
    let starts = |from: u32, to: u32| (from..to).step_by(edge as usize);
    let tile = |x: u32, y: u32| Crop { min: UVec2::new(x, y), max: UVec2::new(x, y).saturating_add(UVec2::splat(edge)).min(crop.max) };
    starts(crop.min.y, crop.max.y).flat_map(|y| starts(crop.min.x, crop.max.x).map(move |x| tile(x, y))).collect()
}

/// Time of a sample as a fraction of the shutter interval.
// Never inlined, so that scenes at rest do not pay for it.
#[cold]
#[inline(never)]
fn drawn_time(numbers: &mut SampleNumbers) -> f32 {
    numbers.get_1d(dimension::TIME)
}
