//! Light tracing: paths that start at the lights.

use std::sync::Arc;

use pt::bsdf::{BsdfSample, Lobe, TransportMode};
use pt::effects::Effects;
use pt::film::{FilmSpec, Splat};
use pt::integrator::{Bias, CameraSample, Context, Estimator, Integrator, Interrupt, LightPath, MAX_DEPTH, PathWavelength, Roulette};
use pt::light::ShadowTarget;
use pt::math::{Density, Frame, Local, Ray, SolidAnglePdf, Spectrum, Vec2, Vec3, Wavelength, warp};
use pt::primitive::Hit;
use pt::recorder::{End, Event, NoRecorder, Origin, Recorder, Scattering};
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use pt::shape::SurfacePoint;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Effects that light tracing cannot simulate: what is seen in mirrors and through glass, light of surfaces on which no point can be
/// sampled (`sdf`), light that `smooth_shadows` lets reach facets which are turned away from it, media, and cameras whose
/// importance is not known.
pub const NOT_SIMULATED: Effects = Effects::SPECULAR_REFLECTION
    .union(Effects::REFRACTION)
    .union(Effects::UNSAMPLED_EMITTER)
    .union(Effects::SMOOTH_SHADOWS)
    .union(Effects::MEDIA)
    .union(Effects::REALISTIC_LENS);

/// Light tracing. A path starts at a light, and each of its vertices is connected to the camera.
///
/// L(film) = Le(camera ray) + Σ_k Φ β_k f(ω_k, ω_c)·|cos| We(ω_c) V / p(ω_c),  Φ: flux of the emitted ray
///
/// It finds light that mirrors and glass focus, which paths from the camera cannot find if the lights are small. It cannot find
/// mirrors and glass themselves: no path from a light scatters there into the direction of the camera. Light of a large or distant lamp
/// is found by the few of its paths that meet what the camera sees.
///
/// Absorption in a body counts from where a path enters the body. With a lamp or the camera inside an absorbing body the picture
/// therefore differs from that of paths from the camera, which count it from the other end.
///
/// Source: Arvo, *Backward Ray Tracing* (1986); Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), §8.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct LightTracer {
    /// Greatest number of scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Number of scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
}

impl Default for LightTracer {
    fn default() -> LightTracer {
        LightTracer { max_depth: 64, roulette_depth: 4 }
    }
}

impl Integrator for LightTracer {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        let calls_for = |effect| scene.effects().contains(effect);
        let has_shading_normals = calls_for(Effects::SHADING_NORMALS);
        let (has_lens, has_motion) = (calls_for(Effects::THIN_LENS), calls_for(Effects::MOTION));
        let roulette = Roulette { from_depth: self.roulette_depth };
        Box::new(Walk { scene, max_depth: self.max_depth, roulette, has_lens, has_motion, has_shading_normals })
    }

    /// Bias of `max_depth`. The integrator without the limit follows the same paths up to that depth; beyond it Russian roulette ends them.
    fn biases(&self) -> Vec<Bias> {
        let without = LightTracer { max_depth: MAX_DEPTH, roulette_depth: self.roulette_depth.min(self.max_depth) };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }

    fn splats(&self) -> bool {
        true
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
    has_lens: bool,
    has_motion: bool,
    has_shading_normals: bool,
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        match cx.recorder.take() {
            None => self.trace(camera, cx, &mut NoRecorder),
            Some(recorder) => self.trace(camera, cx, recorder),
        }
    }
}

impl Walk {
    /// Follows the path from a light, and returns the emission that the camera sees.
    fn trace<R: Recorder + ?Sized>(&self, camera: &CameraSample, cx: &mut Context, recorder: &mut R) -> Spectrum {
        let seen = self.emission(camera, recorder);
        if let Some(path) = &mut cx.light_path {
            self.follow(path, cx.interrupt, recorder);
        }
        seen
    }

    /// Emission of what the camera ray hits, or the radiance of infinitely distant lights.
    fn emission<R: Recorder + ?Sized>(&self, camera: &CameraSample, recorder: &mut R) -> Spectrum {
        let ray = &camera.ray;
        let Some(hit) = camera.hit(&*self.scene) else {
            let add = |sum, (light, radiance)| sum + recorder.light(radiance, 0, || Origin::background(light, 1.0));
            return self.scene.lights().background(ray.direction).fold(Spectrum::BLACK, add);
        };
        let surface = self.scene.surface(ray, &hit);
        recorder.record(|| Event::vertex(0, ray, &hit, &surface, Spectrum::ONE));
        recorder.light(surface.emitted(-ray.direction), 0, || Origin::emission(&surface, 1.0))
    }

    /// Follows a path from a light and connects its vertices to the camera. The block of random numbers before the first vertex
    /// chooses the light and the ray that it emits.
    fn follow<R: Recorder + ?Sized>(&self, path: &mut LightPath, interrupt: Interrupt, recorder: &mut R) {
        let (choice, position) = path.numbers.get_3d(dimension::vertex(0, Use::Light));
        let (_, direction) = path.numbers.get_3d(dimension::vertex(0, Use::Bsdf));
        let time = if self.has_motion { path.numbers.get_1d(dimension::TIME) } else { 0.0 };
        let Some(emitted) = self.scene.lights().emit(choice, position, direction, time) else { return };
        recorder.record(|| Event::Emission(emitted));
        let (flux, mut ray, mut beta) = (emitted.flux(), emitted.ray, Spectrum::ONE);
        let mut wavelength = PathWavelength::default();
        for depth in 0..self.max_depth {
            if interrupt.ends(depth) {
                return;
            }
            let Some(hit) = self.scene.intersect(&ray) else { return recorder.record(|| Event::end(depth, End::Escaped)) };
            let mut surface = self.scene.surface(&ray, &hit);
            recorder.record(|| Event::vertex(depth, &ray, &hit, &surface, beta));
            if surface.is_dispersive {
                beta *= wavelength.take(&mut surface, depth, &mut path.numbers, recorder);
            }
            let carried = Carried { flux: flux * beta, depth: depth + 1, light: emitted.light };
            let arrival = Arrival { ray: &ray, hit: &hit, surface: &surface, wavelength: wavelength.get() };
            self.connect(&arrival, carried, path, recorder);

            let numbers = &mut path.numbers;
            let (choice, u) = numbers.get_3d(dimension::vertex(depth + 1, Use::Bsdf));
            let Some((wi, value, sample)) = self.sample(&arrival, choice, u) else {
                return recorder.record(|| Event::end(depth, End::Absorbed));
            };
            beta *= sample.weight;
            recorder.record(|| {
                let (cos, survival) = (surface.point.ns.dot(wi), self.roulette.chance(depth, beta));
                let BsdfSample { lobe, density, weight, .. } = sample;
                Event::Scattering(Scattering { depth, wi, cos, lobe, density, value, weight, survival })
            });
            let Some(survivors) = self.roulette.survive(depth, beta, numbers) else {
                return recorder.record(|| Event::end(depth, End::Roulette));
            };
            beta *= survivors;
            ray = surface.spawn(wi, ray.time);
        }
        recorder.record(|| Event::end(self.max_depth, End::DepthLimit));
    }

    /// Adds the light that the surface scatters into the camera.
    fn connect<R: Recorder + ?Sized>(&self, arrival: &Arrival, carried: Carried, path: &mut LightPath, recorder: &mut R) {
        let (Arrival { ray, surface, .. }, Carried { flux, depth, light }) = (arrival, carried);
        if !surface.bsdf.has_smooth_lobe() {
            return;
        }
        let lens = if self.has_lens { path.numbers.get_3d(dimension::vertex(depth, Use::Light)).1 } else { Vec2::ZERO };
        let Some(camera) = self.scene.camera().connect(surface.shadow_origin, path.aspect(), lens, ray.time) else { return };
        let value = flux * self.scattered(arrival, camera.wi) * camera.weight;
        if value.is_black() {
            return;
        }
        let shadow_ray = surface.shadow_ray(camera.wi, &ShadowTarget::Point(camera.end), ray.time);
        let Some(passed) = self.scene.transmittance(&shadow_ray) else { return };
        let value = value * passed;
        if path.splat(camera.film, value, depth, light) {
            let raster = camera.film * path.film_size();
            recorder.record(|| Event::Splat(Splat { raster, value, depth, light }));
        }
    }

    /// Samples the direction in which light goes on. Returns it with f·|cos| (black for delta lobes) and the sample.
    ///
    /// A shading normal that is seen from there scatters light also into directions that the BSDF as seen from the light does not sample.
    /// A share of the samples is therefore distributed about the facet's normal, to both sides.
    fn sample(&self, arrival: &Arrival, choice: f32, u: Vec2) -> Option<(Vec3, Spectrum, BsdfSample)> {
        let (Arrival { surface, .. }, wo) = (arrival, -arrival.ray.direction);
        let SurfacePoint { ng, ns, .. } = surface.point;
        let share = if self.has_shading_normals && ns != ng && surface.bsdf.has_smooth_lobe() { ABOUT_FACET } else { 0.0 };
        let (wi, sample) = if choice < share {
            let w = warp::cosine_hemisphere(u) * 1f32.copysign(choice - 0.5 * share);
            let wi = Frame::around(ng).to_world(Local(w));
            let lobe = if ng.dot(wo) * ng.dot(wi) > 0.0 { Lobe::Reflection } else { Lobe::Transmission };
            let density = Density::Smooth(if surface.scatters_between(wo, wi) { surface.pdf(wo, wi) } else { SolidAnglePdf::ZERO });
            (wi, BsdfSample { wi: surface.frame.to_local(wi), weight: Spectrum::BLACK, density, eta: 1.0, lobe })
        } else {
            let rest = ((choice - share) / (1.0 - share)).min(1.0 - 0.5 * f32::EPSILON);
            surface.sample(wo, rest, u, TransportMode::Importance)?
        };
        let Density::Smooth(pdf) = sample.density else {
            return Some((wi, Spectrum::BLACK, BsdfSample { weight: sample.weight / (1.0 - share), ..sample }));
        };
        let pdf = (1.0 - share) * pdf.get() + share * 0.5 * warp::cosine_hemisphere_pdf(Vec3::Z * ng.dot(wi).abs());
        let value = self.scattered(arrival, wi);
        let density = Density::Smooth(SolidAnglePdf::new(pdf));
        (!value.is_black()).then(|| (wi, value, BsdfSample { weight: value / pdf, density, ..sample }))
    }

    /// f·|cos| of the light that goes on in the direction `wi` [sr⁻¹]: what a path from the camera finds that arrives from there, with the
    /// shading normal as it is seen from there.
    fn scattered(&self, arrival: &Arrival, wi: Vec3) -> Spectrum {
        let (Arrival { ray, hit, surface, .. }, wo) = (arrival, -arrival.ray.direction);
        let cosines = (surface.point.ng.dot(wi) / surface.point.ng.dot(wo)).abs();
        if !cosines.is_finite() {
            return Spectrum::BLACK;
        }
        let from_camera = |surface: &Surface| surface.eval(wi, wo, TransportMode::Radiance) * cosines;
        if !self.has_shading_normals {
            return from_camera(surface);
        }
        let mut seen = self.scene.surface_seen_from(ray, hit, wi);
        if let Some(wavelength) = arrival.wavelength {
            seen.bsdf = seen.bsdf.at_wavelength(wavelength);
        }
        from_camera(&seen)
    }
}

/// Share of the samples that are distributed about the normal of the facet, where it is not that of the shading.
const ABOUT_FACET: f32 = 0.125;

/// Arrival of a path at a vertex.
struct Arrival<'a> {
    ray: &'a Ray,
    hit: &'a Hit,
    surface: &'a Surface<'a>,
    /// Wavelength of the path, if it has met dispersive glass.
    wavelength: Option<Wavelength>,
}

/// Light that arrives at a vertex.
#[derive(Clone, Copy)]
struct Carried {
    /// Flux (W).
    flux: Spectrum,
    /// Scattering events on the way to the camera, with that of the vertex.
    depth: u32,
    /// Index of the light.
    light: u32,
}
