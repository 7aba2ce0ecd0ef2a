//! Paths from the camera and Russian roulette, shared by integrators.

use std::ops::ControlFlow;

use super::differential::PathDifferential;
use super::{CameraSample, PathWavelength};
use crate::bsdf::BsdfSample;
use crate::math::{Ray, Spectrum, Vec3};
use crate::primitive::Hit;
use crate::recorder::{End, Event, Origin, Recorder};
use crate::sampler::SampleNumbers;
use crate::sampler::dimension::{self, Use};
use crate::scene::{Interaction, Scene, Surface};

/// Path from the camera, between two vertices.
#[derive(Clone, Copy, Debug)]
pub struct CameraPath {
    /// Ray to the next vertex.
    pub ray: Ray,
    /// Scattering events so far.
    pub depth: u32,
    /// Throughput: the factor between the radiance that arrives along `ray` and its share of the camera's radiance.
    pub beta: Spectrum,
    /// Product of η² along the path. It undoes the compression of radiance in glass, which roulette must not depend on.
    pub eta_scale: f32,
    /// Radiance found so far.
    pub radiance: Spectrum,
    /// Wavelength, if the path has met dispersive glass.
    pub wavelength: PathWavelength,
    /// Hit of the camera ray, until it is used.
    known_hit: Option<Option<Hit>>,
    differential: PathDifferential,
}

impl CameraPath {
    /// A path that starts at the camera.
    pub fn new(camera: &CameraSample) -> CameraPath {
        let CameraSample { ray, known_hit, .. } = *camera;
        CameraPath {
            ray,
            depth: 0,
            beta: Spectrum::ONE,
            eta_scale: 1.0,
            radiance: Spectrum::BLACK,
            wavelength: PathWavelength::default(),
            known_hit,
            differential: PathDifferential::at_camera(camera),
        }
    }

    /// Next surface that the path hits.
    #[inline(always)]
    pub fn hit(&mut self, scene: &dyn Scene) -> Option<Hit> {
        self.known_hit.take().unwrap_or_else(|| scene.intersect(&self.ray))
    }

    /// Surface that the path hit, with its textures averaged over the path's footprint.
    #[inline(always)]
    pub fn surface<'s>(&mut self, scene: &'s dyn Scene, hit: &Hit) -> Surface<'s> {
        self.differential.surface(scene, &self.ray, hit)
    }

    /// Takes a wavelength where scattering at the surface depends on it.
    #[inline(always)]
    pub fn take_wavelength<R: Recorder + ?Sized>(&mut self, surface: &mut Surface, numbers: &mut SampleNumbers, recorder: &mut R) {
        if surface.is_dispersive {
            self.beta *= self.wavelength.take(surface, self.depth, numbers, recorder);
        }
    }

    /// Adds light that arrives along the ray, from the surface or the background that it hits.
    #[inline(always)]
    pub fn add_emission<R: Recorder + ?Sized>(&mut self, light: Spectrum, recorder: &mut R, origin: impl FnOnce() -> Origin) {
        self.radiance += recorder.light(self.beta * light, self.depth, origin);
    }

    /// Adds light that the next vertex, on a surface or in a medium, scatters into the path.
    #[inline(always)]
    pub fn add_scattered<R: Recorder + ?Sized>(&mut self, light: Spectrum, recorder: &mut R, origin: impl FnOnce() -> Origin) {
        self.radiance += recorder.light(self.beta * light, self.depth + 1, origin);
    }

    /// Ends the path.
    #[inline(always)]
    pub fn end<C, R: Recorder + ?Sized>(&self, why: End, recorder: &mut R) -> ControlFlow<Spectrum, C> {
        recorder.record(|| Event::end(self.depth, why));
        ControlFlow::Break(self.radiance)
    }

    /// Continues the path in a sampled direction, unless there is none or Russian roulette ends the path.
    ///
    /// - `sample`: sampled direction in world space and the sample
    #[inline(always)]
    pub fn scatter<I: Interaction, R: Recorder + ?Sized>(
        &mut self,
        at: &I,
        sample: Option<(Vec3, BsdfSample)>,
        roulette: Roulette,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> ControlFlow<Spectrum, BsdfSample> {
        let Some((wi, sample)) = sample else { return self.end(End::Absorbed, recorder) };
        let (depth, wo) = (self.depth, -self.ray.direction);
        self.beta *= sample.weight;
        self.eta_scale *= sample.eta * sample.eta;
        let carried = self.beta * self.eta_scale;
        recorder.record(|| Event::scattering(depth, at, wo, &(wi, sample), roulette.chance(depth, carried)));
        let Some(survivors) = roulette.survive(depth, carried, numbers) else { return self.end(End::Roulette, recorder) };
        self.beta *= survivors;
        if let Some(normal) = at.normal() {
            self.differential.scatter(normal, [-wo, wi], sample.density, sample.eta);
        }
        self.ray = at.spawn(wi, self.ray.time);
        self.depth += 1;
        ControlFlow::Continue(sample)
    }
}

/// State of a path between two vertices: what a medium on the way needs to know, and what it changes.
pub trait PathState {
    /// Ray to the next surface.
    fn ray(&self) -> Ray;

    /// Scattering events so far.
    fn depth(&self) -> u32;

    /// Throughput.
    fn beta(&mut self) -> &mut Spectrum;

    /// Adds light that a medium emits along the ray.
    fn add_emission<R: Recorder + ?Sized>(&mut self, light: Spectrum, recorder: &mut R);

    /// Takes note that a medium scatters the path.
    fn leave_surfaces(&mut self);
}

impl PathState for CameraPath {
    #[inline(always)]
    fn ray(&self) -> Ray {
        self.ray
    }

    #[inline(always)]
    fn depth(&self) -> u32 {
        self.depth
    }

    #[inline(always)]
    fn beta(&mut self) -> &mut Spectrum {
        &mut self.beta
    }

    #[inline(always)]
    fn add_emission<R: Recorder + ?Sized>(&mut self, light: Spectrum, recorder: &mut R) {
        CameraPath::add_emission(self, light, recorder, Origin::medium);
    }

    /// Forgets the differential of the path, which only mirrors and glass keep.
    fn leave_surfaces(&mut self) {
        self.differential = PathDifferential::None;
    }
}

/// Russian roulette: ends paths of low throughput early and weights the surviving paths up.
///
/// Survival probability q = min(1, max β·η²), where β is the throughput and η² undoes the compression of radiance in glass. The
/// probability depends on the throughput alone, never on radiance, so that emission ×2^k gives pixels ×2^k.
///
/// Where β falls by a factor ρ at each bounce, survivors carry β/q = 1 again. An upper bound on q below 1 would let their weight
/// grow by ρ/q per bounce, and for ρ² > q the variance would be unbounded. A path between perfect mirrors is therefore ended by
/// the depth limit, not by roulette.
///
/// Source: Arvo and Kirk, *Particle Transport and Image Synthesis* (1990). Tests: row W1 of `pt torture`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette {
    /// Depth of the first vertex at which a path may end.
    pub from_depth: u32,
}

impl Roulette {
    /// Probability with which a path continues.
    pub fn chance(&self, depth: u32, beta: Spectrum) -> f32 {
        if depth < self.from_depth { 1.0 } else { beta.max().min(1.0) }
    }

    /// Factor for the throughput of a path that continues; `None` if the path ends here.
    ///
    /// - `beta`: throughput without the compression by refraction
    pub fn survive(&self, depth: u32, beta: Spectrum, numbers: &mut SampleNumbers) -> Option<f32> {
        if depth < self.from_depth {
            return Some(1.0);
        }
        let q = self.chance(depth, beta);
        (numbers.get_1d(dimension::vertex(depth, Use::Roulette)) < q).then(|| 1.0 / q)
    }
}
