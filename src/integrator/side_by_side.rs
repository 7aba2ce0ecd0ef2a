//! Paths that are followed side by side, one in each lane.

use glam::{UVec2, Vec3};

use super::differential::PathDifferential;
use super::{CameraSample, Interrupt, Roulette};
use crate::accel::Hits;
use crate::math::lanes::{Kernel, Lanes, MAX_COUNT, One, Rays, Vector, Width, each_lane, get, to_array_u32};
use crate::math::{Density, Ray, SolidAnglePdf, Spectrum};
use crate::sampler::dimension::{self, Use};
use crate::sampler::{BatchNumbers, NumberLanes, SampleNumbers};
use crate::world::{MediumLanes, ReceiverLanes, ScatteredLanes, SurfaceLanes, WideWorld};

/// Method that estimates many samples at once, with the same bits as [`Estimator::li`](super::Estimator::li) gives for each.
pub trait SideBySide: Send + Sync {
    /// Number of paths side by side.
    fn width(&self) -> Width;

    /// Computes the estimates of all samples of a batch, [`Batch::estimates`].
    fn estimate(&self, batch: &mut Batch, interrupt: Interrupt);
}

/// Camera samples whose paths are followed together.
///
/// Samples are added with their numbers, then get their camera rays, then their estimates.
pub struct Batch<'a> {
    pixels: Vec<UVec2>,
    /// Weights of the samples: those of the reconstruction filter and of the camera ray.
    weights: Vec<f32>,
    numbers: BatchNumbers<'a>,
    radiance: Vec<Spectrum>,
    /// Differential of the path of each sample; none if no texture depends on them.
    differentials: Vec<PathDifferential>,
    paths: Paths,
}

/// Greatest number of samples in a batch. Smaller batches leave more lanes empty in the last group of each depth; larger ones do not fit
/// the second-level cache.
pub const BATCH: usize = 1024;

impl<'a> Batch<'a> {
    /// An empty batch.
    pub fn new() -> Batch<'a> {
        let numbers = BatchNumbers::with_capacity(BATCH);
        Batch {
            pixels: Vec::with_capacity(BATCH),
            weights: vec![1.0; BATCH],
            numbers,
            radiance: Vec::with_capacity(BATCH),
            differentials: vec![],
            paths: Paths::new(),
        }
    }

    /// Removes all samples.
    pub fn clear(&mut self) {
        self.pixels.clear();
        self.numbers.clear();
        self.differentials.clear();
    }

    /// Adds a sample of a pixel. A batch must not get more than [`BATCH`] samples.
    pub fn push(&mut self, pixel: UVec2, numbers: SampleNumbers<'a>) {
        self.pixels.push(pixel);
        self.numbers.push(numbers);
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }

    /// Gives each sample its camera ray, with its differential, and its weight, that of the reconstruction filter and of the ray.
    ///
    /// - `camera`: camera sample for the place of a sample in the batch, its pixel and its numbers
    pub fn start_each(&mut self, mut camera: impl FnMut(usize, UVec2, &mut SampleNumbers) -> CameraSample) {
        for (k, (&pixel, numbers)) in self.pixels.iter().zip(self.numbers.samples()).enumerate() {
            let camera = camera(k, pixel, numbers);
            let CameraSample { ray, weight, .. } = camera;
            self.weights[k] = weight;
            if camera.differential.is_some() {
                self.differentials.push(PathDifferential::at_camera(&camera));
            }
            self.paths.start::<One>(k, Vector::splat(ray.origin), Vector::splat(ray.direction));
        }
        self.paths.count = self.pixels.len();
    }

    /// Gives all samples camera rays without differentials, and the weight 1.
    ///
    /// - `rays`: origins and directions of the rays of several pixels, for the numbers of their samples. Its method must be `#[inline(always)]`.
    #[inline(always)]
    pub fn start_lanes<L: Lanes>(&mut self, rays: &impl CameraRays) {
        let count = self.pixels.len();
        for first in (0..count).step_by(L::COUNT) {
            let (mut x, mut y, mut places) = ([0.0; MAX_COUNT], [0.0; MAX_COUNT], [0; MAX_COUNT]);
            for (k, pixel) in self.pixels[first..].iter().take(L::COUNT).enumerate() {
                (x[k], y[k], places[k]) = (pixel.x as f32, pixel.y as f32, (first + k) as u32);
            }
            let active = L::mask(lowest_bits(count - first));
            let mut numbers = self.numbers.lanes::<L>(L::load_u32(&places), active);
            let (origin, direction) = rays.rays([L::load(&x), L::load(&y)], &mut numbers);
            self.paths.start::<L>(first, origin, direction);
        }
        self.weights.fill(1.0);
        self.paths.count = count;
    }

    /// Pixel, weight and estimate of each sample, in the order in which they were added.
    pub fn estimates(&self) -> impl Iterator<Item = (UVec2, f32, Spectrum)> {
        let weights = self.weights.iter().copied();
        self.pixels.iter().copied().zip(weights).zip(self.radiance.iter().copied()).map(|((pixel, weight), value)| (pixel, weight, value))
    }
}

/// Source of camera rays in lanes.
pub trait CameraRays {
    /// Origins and directions of the rays of samples of some pixels.
    fn rays<L: Lanes>(&self, pixels: [L::F32; 2], numbers: &mut NumberLanes<L>) -> (Vector<L>, Vector<L>);
}

impl Default for Batch<'_> {
    fn default() -> Self {
        Batch::new()
    }
}

/// Paths from the camera between two vertices, one in each lane.
pub struct PathLanes<'d, L: Lanes> {
    /// Rays to the next vertices.
    pub rays: Rays<L>,
    /// Throughputs.
    pub beta: Vector<L>,
    /// Radiance found so far.
    pub radiance: Vector<L>,
    /// Products of η² along the paths.
    pub eta_scale: L::F32,
    /// Points that the rays leave.
    pub from: ReceiverLanes<L>,
    /// Densities of the rays' directions [sr⁻¹]; negative for delta distributions.
    pub pdf: L::F32,
    /// Places of the samples in the batch.
    place: L::U32,
    /// See [`Batch::differentials`].
    differentials: &'d mut [PathDifferential],
}

impl<L: Lanes> PathLanes<'_, L> {
    /// Surfaces that the paths hit, with their textures averaged over the paths' footprints.
    #[inline(always)]
    pub fn surfaces<'s>(&mut self, scene: WideWorld<'s>, hits: &Hits) -> SurfaceLanes<'s, L> {
        let mut surface = scene.surfaces(&self.rays, hits);
        let known = if self.differentials.is_empty() { 0 } else { self.differentials_that_go_on(scene, &surface) };
        if surface.varied() | known != 0 {
            self.set_one_by_one(scene, &mut surface, known);
        }
        surface
    }

    /// Lanes whose paths have a differential and are at a surface that may keep it. Others lose theirs, unless their surface needs it.
    #[inline(always)]
    fn differentials_that_go_on(&mut self, scene: WideWorld, surface: &SurfaceLanes<'_, L>) -> u32 {
        let (places, mut known) = (to_array_u32::<L>(self.place), 0);
        for lane in each_lane(L::bits(surface.found)) {
            let differential = &mut self.differentials[places[lane] as usize];
            if differential.is_known() && scene.has_delta_lobes(surface, lane) {
                known |= 1 << lane;
            } else if surface.varied() >> lane & 1 == 0 {
                *differential = PathDifferential::None;
            }
        }
        known
    }

    /// Sets the surfaces that do not look the same everywhere, and the differentials of paths at their surfaces.
    ///
    /// - `known`: result of [`PathLanes::differentials_that_go_on`]
    #[inline(always)]
    fn set_one_by_one<'s>(&mut self, scene: WideWorld<'s>, surface: &mut SurfaceLanes<'s, L>, known: u32) {
        let (mut arrays, places, varied) = (surface.to_arrays(), to_array_u32::<L>(self.place), surface.varied());
        for lane in each_lane(varied | known) {
            let mut none = PathDifferential::None;
            let differential = self.differentials.get_mut(places[lane] as usize).unwrap_or(&mut none);
            let ray = Ray { from: self.from.p.get(lane), ..self.rays.get(lane) };
            let found = differential.surface(scene.scene(), &ray, &surface.hit(lane));
            if varied >> lane & 1 == 1 {
                surface.set(&mut arrays, lane, &found);
            }
        }
        surface.take(&arrays);
    }

    /// Adds light to the paths of some lanes.
    #[inline(always)]
    pub fn add(&mut self, which: L::Mask, light: Vector<L>) {
        self.radiance = Vector::select(which, self.radiance + self.beta * light, self.radiance);
    }

    /// Continues the paths in sampled directions, as [`CameraPath::scatter`](super::CameraPath::scatter). Returns the lanes whose paths go on.
    ///
    /// - `in_medium`: paths that are at points of a medium and not at surfaces
    #[inline(always)]
    pub fn scatter(
        &mut self,
        scene: WideWorld,
        surface: &SurfaceLanes<'_, L>,
        in_medium: Option<&MediumLanes<'_, L>>,
        roulette: Roulette,
        depth: u32,
        numbers: &mut NumberLanes<L>,
    ) -> L::Mask {
        let (wo, u) = (-self.rays.direction, numbers.get_3d(dimension::vertex(depth, Use::Bsdf)));
        let mut sample = scene.scatter(surface, wo, u, surface.found);
        if let Some(points) = in_medium {
            sample = points.scatter(wo, u, sample);
        }
        let mut alive = sample.found;
        self.beta = self.beta * sample.weight;
        self.eta_scale = self.eta_scale * (sample.eta * sample.eta);
        if depth >= roulette.from_depth && L::any(alive) {
            let one = L::f32(1.0);
            let chance = L::min(self.beta.scaled(self.eta_scale).max_element(), one);
            alive = alive & L::lt(numbers.get_1d(dimension::vertex(depth, Use::Roulette)), chance);
            self.beta = self.beta.scaled(one / chance);
        }
        if !self.differentials.is_empty() {
            self.scatter_differentials(surface, &sample, L::bits(alive));
        }
        self.rays = surface.spawn(sample.wi);
        self.from = surface.receiver(wo);
        if let Some(points) = in_medium {
            points.leave(sample.wi, &mut self.rays, &mut self.from);
        }
        self.pdf = sample.pdf;
        alive
    }

    /// Forgets the differentials of paths that a medium scatters.
    #[inline(always)]
    pub fn leave_surfaces(&mut self, scattered: L::Mask) {
        if !self.differentials.is_empty() {
            let places = to_array_u32::<L>(self.place);
            each_lane(L::bits(scattered)).for_each(|lane| self.differentials[places[lane] as usize] = PathDifferential::None);
        }
    }

    #[inline(always)]
    fn scatter_differentials(&mut self, surface: &SurfaceLanes<'_, L>, sample: &ScatteredLanes<L>, alive: u32) {
        let places = to_array_u32::<L>(self.place);
        for lane in each_lane(alive) {
            let differential = &mut self.differentials[places[lane] as usize];
            if differential.is_known() {
                let pdf = get::<L>(sample.pdf, lane);
                let density = if pdf < 0.0 { Density::Delta } else { Density::Smooth(SolidAnglePdf::new(pdf)) };
                let directions = [self.rays.direction.get(lane), sample.wi.get(lane)];
                differential.scatter(surface.ns.get(lane), directions, density, get::<L>(sample.eta, lane));
            }
        }
    }
}

/// Method that goes from vertex to vertex with several paths at once.
pub trait WideWalk: Send + Sync {
    /// Scene of the method; `None` if its paths are to be followed one by one.
    fn scene(&self) -> Option<WideWorld<'_>>;

    /// Goes to the next vertices of the paths in the lanes of `active`, all of the same depth. Returns the lanes whose paths go on.
    /// It must be `#[inline(always)]`, see [`Kernel`].
    fn step<L: Lanes>(
        &self,
        scene: WideWorld,
        depth: u32,
        paths: &mut PathLanes<'_, L>,
        numbers: &mut NumberLanes<L>,
        active: L::Mask,
    ) -> L::Mask;
}

impl<W: WideWalk> SideBySide for W {
    fn width(&self) -> Width {
        self.scene().map_or_else(Width::detect, |scene| scene.width())
    }

    fn estimate(&self, batch: &mut Batch, interrupt: Interrupt) {
        let count = batch.len();
        batch.radiance.clear();
        batch.radiance.resize(count, Spectrum::BLACK);
        let Some(scene) = self.scene().filter(|_| count > 0) else { return };
        let followed = scene.width().run_wide(Follow { method: self, scene, batch, interrupt });
        debug_assert!(followed.is_some(), "a `WideWorld` exists only on machines with more than one lane");
    }
}

/// Follows all paths of a batch to their ends.
struct Follow<'f, 'a, W> {
    method: &'f W,
    scene: WideWorld<'f>,
    batch: &'f mut Batch<'a>,
    interrupt: Interrupt<'f>,
}

impl<W: WideWalk> Kernel for Follow<'_, '_, W> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Batch { numbers, radiance, differentials, paths, .. } = self.batch;
        let mut depth = 0u32;
        // The batch of a cancelled render is discarded.
        while paths.count > 0 && !self.interrupt.is_cancelled() {
            let mut kept = 0;
            for first in (0..paths.count).step_by(L::COUNT) {
                let active = L::mask(lowest_bits(paths.count - first));
                let mut lanes = paths.load::<L>(first, differentials);
                let mut numbers = numbers.lanes(lanes.place, active);
                let alive = self.method.step(self.scene, depth, &mut lanes, &mut numbers, active) & active;
                let ended = L::bits(active & !alive);
                if ended != 0 {
                    let (found, places) = (lanes.radiance.to_arrays(), to_array_u32::<L>(lanes.place));
                    for lane in each_lane(ended) {
                        radiance[places[lane] as usize] = Spectrum::rgb(found[0][lane], found[1][lane], found[2][lane]);
                    }
                }
                // Paths that go on move together. They take no more room than the group had.
                kept += paths.pack(kept, &lanes, alive);
            }
            paths.count = kept;
            depth += 1;
        }
    }
}

/// A mask of the lowest `count` bits, all if there are more than 32.
#[inline(always)]
fn lowest_bits(count: usize) -> u32 {
    if count >= 32 { u32::MAX } else { (1 << count) - 1 }
}

/// Paths of a batch, with a row of numbers for each property.
struct Paths {
    count: usize,
    rows: Vec<[f32; LENGTH]>,
    places: [u32; LENGTH],
    /// See [`Rays::skip`].
    skips: [u32; LENGTH],
}

/// Length of a row: a vector that begins at the last path ends within it.
const LENGTH: usize = BATCH + MAX_COUNT;

/// Number of rows of numbers.
const ROWS: usize = 24;

impl Paths {
    fn new() -> Paths {
        Paths { count: 0, rows: vec![[0.0; LENGTH]; ROWS], places: [0; LENGTH], skips: [u32::MAX; LENGTH] }
    }

    /// Paths that start at the camera, in the lanes from `first` on.
    #[inline(always)]
    fn start<L: Lanes>(&mut self, first: usize, origin: Vector<L>, direction: Vector<L>) {
        let (zero, one) = (Vector::splat(Vec3::ZERO), Vector::splat(Vec3::ONE));
        let places = L::lanes() + L::u32(first as u32);
        let from = ReceiverLanes::at(origin);
        let rays = Rays { origin, direction, t_max: L::f32(f32::INFINITY), skip: L::u32(u32::MAX) };
        // Light sampling cannot find what the camera sees directly: a delta distribution.
        let (eta_scale, pdf) = (L::f32(1.0), L::f32(-1.0));
        let paths = PathLanes { rays, beta: one, radiance: zero, eta_scale, from, pdf, place: places, differentials: &mut [] };
        self.pack(first, &paths, L::mask(u32::MAX));
    }

    /// The paths from `first` on.
    #[inline(always)]
    fn load<'d, L: Lanes>(&self, first: usize, differentials: &'d mut [PathDifferential]) -> PathLanes<'d, L> {
        PathLanes {
            rays: Rays {
                origin: self.vector(0, first),
                direction: self.vector(3, first),
                t_max: L::f32(f32::INFINITY),
                skip: L::load_u32(&self.skips[first..]),
            },
            beta: self.vector(6, first),
            radiance: self.vector(9, first),
            from: ReceiverLanes {
                p: self.vector(12, first),
                ng: self.vector(15, first),
                ns: self.vector(18, first),
                transmits: L::lt(L::f32(0.0), L::load(&self.rows[21][first..])),
            },
            eta_scale: L::load(&self.rows[22][first..]),
            pdf: L::load(&self.rows[23][first..]),
            place: L::load_u32(&self.places[first..]),
            differentials,
        }
    }

    #[inline(always)]
    fn vector<L: Lanes>(&self, k: usize, first: usize) -> Vector<L> {
        Vector::load(&self.rows[k][first..], &self.rows[k + 1][first..], &self.rows[k + 2][first..])
    }

    /// Writes the paths of some lanes from `first` on. Returns their number.
    #[inline(always)]
    fn pack<L: Lanes>(&mut self, first: usize, paths: &PathLanes<'_, L>, which: L::Mask) -> usize {
        let PathLanes { rays, beta, radiance, eta_scale, from, pdf, place, .. } = *paths;
        let transmits = L::select(from.transmits, L::f32(1.0), L::f32(0.0));
        let numbers: [L::F32; ROWS] = [
            rays.origin.x,
            rays.origin.y,
            rays.origin.z,
            rays.direction.x,
            rays.direction.y,
            rays.direction.z,
            beta.x,
            beta.y,
            beta.z,
            radiance.x,
            radiance.y,
            radiance.z,
            from.p.x,
            from.p.y,
            from.p.z,
            from.ng.x,
            from.ng.y,
            from.ng.z,
            from.ns.x,
            from.ns.y,
            from.ns.z,
            transmits,
            eta_scale,
            pdf,
        ];
        for (row, x) in self.rows.iter_mut().zip(numbers) {
            L::pack(x, which, &mut row[first..]);
        }
        L::pack_u32(place, which, &mut self.places[first..]);
        L::pack_u32(rays.skip, which, &mut self.skips[first..]);
        L::bits(which).count_ones() as usize
    }
}
