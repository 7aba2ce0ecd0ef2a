//! Light tracing: paths that start at the lights.

use std::marker::PhantomData;
use std::sync::Arc;

use pt::bsdf::{BsdfSample, Lobe, TransportMode};
use pt::effects::Effects;
use pt::film::{FilmSpec, Splat};
use pt::integrator::{
    Bias, CameraSample, Context, Estimator, Filled, Integrator, Interrupt, LightPath, MAX_DEPTH, PathState, PathWavelength, Roulette,
    Space, Vacuum,
};
use pt::light::{EmittedRay, ShadowTarget};
use pt::math::{Density, Frame, Local, Ray, SolidAnglePdf, Spectrum, Vec2, Vec3, Wavelength, warp};
use pt::primitive::Hit;
use pt::recorder::{End, Event, NoRecorder, Origin, Recorder, Scattering};
use pt::sampler::SampleNumbers;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Interaction, MediumPoint, Scene, Surface};
use pt::shape::SurfacePoint;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Effects that light tracing cannot simulate: what is seen in mirrors and through glass, light of surfaces on which no point can be
/// sampled (`sdf`), light that media emit, light that `smooth_shadows` lets reach facets which are turned away from it, and cameras whose
/// importance is not known.
pub const NOT_SIMULATED: Effects = Effects::SPECULAR_REFLECTION
    .union(Effects::REFRACTION)
    .union(Effects::UNSAMPLED_EMITTER)
    .union(Effects::SMOOTH_SHADOWS)
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
/// Where a medium scatters a path, f·|cos| is its phase function. V is the share of the light that media and surfaces let pass. Textures are
/// looked up at points, because a path from a light does not know how much of the surface a pixel shows.
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
        let has_media = calls_for(Effects::MEDIA);
        let method = Method { scene, max_depth: self.max_depth, roulette, has_lens, has_motion, has_shading_normals };
        if has_media { Box::new(Walk::<Filled>::new(method)) } else { Box::new(Walk::<Vacuum>::new(method)) }
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

/// What all paths of a render share.
struct Method {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
    has_lens: bool,
    has_motion: bool,
    has_shading_normals: bool,
}

/// The method in a space without or with media.
struct Walk<S> {
    method: Method,
    space: PhantomData<S>,
}

impl<S: Space> Estimator for Walk<S> {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        match cx.recorder.take() {
            None => self.trace(camera, cx, &mut NoRecorder),
            Some(recorder) => self.trace(camera, cx, recorder),
        }
    }
}

impl<S: Space> Walk<S> {
    fn new(method: Method) -> Walk<S> {
        Walk { method, space: PhantomData }
    }

    /// Follows the path from a light, and returns the emission that the camera sees.
    fn trace<R: Recorder + ?Sized>(&self, camera: &CameraSample, cx: &mut Context, recorder: &mut R) -> Spectrum {
        let seen = self.emission(camera, &cx.numbers, recorder);
        if let Some(path) = &mut cx.light_path {
            self.follow(path, cx.interrupt, recorder);
        }
        seen
    }

    /// Emission of what the camera ray hits, or the radiance of infinitely distant lights, as far as media let it pass.
    fn emission<R: Recorder + ?Sized>(&self, camera: &CameraSample, numbers: &SampleNumbers, recorder: &mut R) -> Spectrum {
        let (ray, scene) = (&camera.ray, &*self.method.scene);
        let hit = camera.hit(scene);
        let way = Ray { t_max: hit.map_or(f32::INFINITY, |hit| hit.t), ..*ray };
        let passed = S::at_camera(scene, camera).media_transmittance(scene, &way, dimension::vertex(0, Use::Medium), numbers);
        let Some(hit) = hit else {
            let add = |sum, (light, radiance)| sum + recorder.light(passed * radiance, 0, || Origin::background(light, 1.0));
            return scene.lights().background(ray.direction).fold(Spectrum::BLACK, add);
        };
        let surface = scene.surface(ray, &hit);
        recorder.record(|| Event::vertex(0, ray, &hit, &surface, passed));
        recorder.light(passed * surface.emitted(-ray.direction), 0, || Origin::emission(&surface, 1.0))
    }

    /// Follows a path from a light and connects its vertices to the camera. The random numbers of `vertex(0, …)` choose
    /// the light and the ray that it emits; vertex k of the path has those of `vertex(k + 1, …)`.
    fn follow<R: Recorder + ?Sized>(&self, path: &mut LightPath, interrupt: Interrupt, recorder: &mut R) {
        let Method { scene, max_depth, .. } = &self.method;
        let (choice, position) = path.numbers.get_3d(dimension::vertex(0, Use::Light));
        let (_, direction) = path.numbers.get_3d(dimension::vertex(0, Use::Bsdf));
        let time = if self.method.has_motion { path.numbers.get_1d(dimension::TIME) } else { 0.0 };
        let Some(emitted) = scene.lights().emit(choice, position, direction, time) else { return };
        recorder.record(|| Event::Emission(emitted));
        let mut space = S::at_light(&**scene, &emitted);
        let mut state =
            State { ray: emitted.ray, depth: 0, beta: self.arriving(&space, &emitted, path), wavelength: PathWavelength::default() };
        let flux = emitted.flux();
        while state.depth < *max_depth {
            let depth = state.depth;
            if interrupt.ends(depth) {
                return;
            }
            let hit = scene.intersect(&state.ray);
            if let Some(point) = space.scatter(&**scene, &mut state, hit.as_ref(), &mut path.numbers, recorder) {
                let carried = Carried { flux: flux * state.beta, depth: depth + 1, light: emitted.light };
                self.connect(&point, &space, &state.ray, carried, path, recorder);
                if self.scatter(&point, &mut state, path, recorder).is_none() {
                    return;
                }
                space.leave(state.ray.direction);
                continue;
            }
            let Some(hit) = hit else { return recorder.record(|| Event::end(depth, End::Escaped)) };
            let mut surface = scene.surface(&state.ray, &hit);
            recorder.record(|| Event::vertex(depth, &state.ray, &hit, &surface, state.beta));
            space.arrive(&**scene, &hit, &surface);
            if surface.is_dispersive {
                state.beta *= state.wavelength.take(&mut surface, depth, &mut path.numbers, recorder);
            }
            let carried = Carried { flux: flux * state.beta, depth: depth + 1, light: emitted.light };
            let (ray, wavelength) = (state.ray, state.wavelength.get());
            let arrival = Arrival { method: &self.method, ray: &ray, hit: &hit, surface: &surface, wavelength };
            self.connect(&arrival, &space, &ray, carried, path, recorder);
            if self.scatter(&arrival, &mut state, path, recorder).is_none() {
                return;
            }
            space.leave(state.ray.direction);
        }
        recorder.record(|| Event::end(*max_depth, End::DepthLimit));
    }

    /// Share of the light of a distant lamp that arrives where its ray starts: the medium around everything, if there is one, is endless.
    fn arriving(&self, space: &S, emitted: &EmittedRay, path: &LightPath) -> Spectrum {
        if !emitted.is_distant() {
            return Spectrum::ONE;
        }
        let back = Ray { time: emitted.ray.time, ..Ray::new(emitted.ray.origin, -emitted.ray.direction) };
        space.media_transmittance(&*self.method.scene, &back, dimension::vertex(0, Use::Roulette), &path.numbers)
    }

    /// Goes on from a vertex in a sampled direction; `None` if the path ends.
    fn scatter<V: Vertex, R: Recorder + ?Sized>(&self, at: &V, state: &mut State, path: &mut LightPath, recorder: &mut R) -> Option<()> {
        let (depth, roulette, numbers) = (state.depth, self.method.roulette, &mut path.numbers);
        let (choice, u) = numbers.get_3d(dimension::vertex(depth + 1, Use::Bsdf));
        let Some((wi, value, sample)) = at.sample(-state.ray.direction, choice, u) else {
            recorder.record(|| Event::end(depth, End::Absorbed));
            return None;
        };
        state.beta *= sample.weight;
        let beta = state.beta;
        recorder.record(|| {
            let (cos, survival) = (at.cos(wi), roulette.chance(depth, beta));
            let BsdfSample { lobe, density, weight, .. } = sample;
            Event::Scattering(Scattering { depth, wi, cos, lobe, density, value, weight, survival })
        });
        let Some(survivors) = roulette.survive(depth, beta, numbers) else {
            recorder.record(|| Event::end(depth, End::Roulette));
            return None;
        };
        state.beta *= survivors;
        state.ray = at.spawn(wi, state.ray.time);
        state.depth += 1;
        Some(())
    }

    /// Adds the light that a vertex scatters into the camera.
    ///
    /// - `ray`: ray on which the light arrives
    fn connect<V: Vertex, R: Recorder + ?Sized>(
        &self,
        at: &V,
        space: &S,
        ray: &Ray,
        carried: Carried,
        path: &mut LightPath,
        recorder: &mut R,
    ) {
        let (Method { scene, has_lens, .. }, Carried { flux, depth, light }) = (&self.method, carried);
        if !at.has_smooth_lobe() {
            return;
        }
        let lens = if *has_lens { path.numbers.get_3d(dimension::vertex(depth, Use::Light)).1 } else { Vec2::ZERO };
        let Some(camera) = scene.camera().connect(at.origin(), path.aspect(), lens, ray.time) else { return };
        let value = flux * at.scattered(-ray.direction, camera.wi) * camera.weight;
        if value.is_black() {
            return;
        }
        let shadow_ray = at.shadow_ray(camera.wi, &ShadowTarget::Point(camera.end), ray.time);
        let Some(passed) = space.transmittance(&**scene, &shadow_ray, dimension::vertex(depth, Use::Light), &path.numbers) else { return };
        let value = value * passed;
        if path.splat(camera.film, value, depth, light) {
            let raster = camera.film * path.film_size();
            recorder.record(|| Event::Splat(Splat { raster, value, depth, light }));
        }
    }
}

/// A path from a light, between two vertices.
struct State {
    ray: Ray,
    depth: u32,
    beta: Spectrum,
    wavelength: PathWavelength,
}

impl PathState for State {
    fn ray(&self) -> Ray {
        self.ray
    }

    fn depth(&self) -> u32 {
        self.depth
    }

    fn beta(&mut self) -> &mut Spectrum {
        &mut self.beta
    }

    /// The emission of media is not simulated, see [`NOT_SIMULATED`]; what a medium emits on the way is no part of this path's light.
    fn add_emission<R: Recorder + ?Sized>(&mut self, _: Spectrum, _: &mut R) {}

    fn leave_surfaces(&mut self) {}
}

/// Vertex of a path from a light.
trait Vertex {
    fn has_smooth_lobe(&self) -> bool;

    /// Point from which the camera is looked for (m).
    fn origin(&self) -> Vec3;

    /// f·|cos|, or the phase function, of the light that goes on in the direction `wi` [sr⁻¹].
    fn scattered(&self, wo: Vec3, wi: Vec3) -> Spectrum;

    /// Samples the direction in which light goes on. Returns it with [`Vertex::scattered`] (black for delta lobes) and the sample.
    fn sample(&self, wo: Vec3, choice: f32, u: Vec2) -> Option<(Vec3, Spectrum, BsdfSample)>;

    /// Cosine of the angle to the shading normal; 1 where there is none.
    fn cos(&self, wi: Vec3) -> f32;

    fn spawn(&self, wi: Vec3, time: f32) -> Ray;

    fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray;
}

impl Vertex for MediumPoint<'_> {
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn origin(&self) -> Vec3 {
        self.p
    }

    fn scattered(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        self.eval(wo, wi, TransportMode::Importance)
    }

    fn sample(&self, wo: Vec3, choice: f32, u: Vec2) -> Option<(Vec3, Spectrum, BsdfSample)> {
        let (wi, sample) = Interaction::sample(self, wo, choice, u, TransportMode::Importance)?;
        Some((wi, self.scattered(wo, wi), sample))
    }

    fn cos(&self, _: Vec3) -> f32 {
        1.0
    }

    fn spawn(&self, wi: Vec3, time: f32) -> Ray {
        Interaction::spawn(self, wi, time)
    }

    fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray {
        Interaction::shadow_ray(self, wi, target, time)
    }
}

/// Share of the samples that are cosine-distributed about the geometric normal, where the shading normal differs from it.
const ABOUT_FACET: f32 = 0.125;

/// Arrival of a path at a surface.
struct Arrival<'a> {
    method: &'a Method,
    ray: &'a Ray,
    hit: &'a Hit,
    surface: &'a Surface<'a>,
    /// Wavelength of the path, if it has met dispersive glass.
    wavelength: Option<Wavelength>,
}

impl Vertex for Arrival<'_> {
    fn has_smooth_lobe(&self) -> bool {
        self.surface.bsdf.has_smooth_lobe()
    }

    fn origin(&self) -> Vec3 {
        self.surface.shadow_origin
    }

    /// f·|cos| as a path from the camera finds it: seen from the direction `wi`, with the shading normal that a viewer there gets.
    fn scattered(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let surface = self.surface;
        let cosines = (surface.point.ng.dot(wi) / surface.point.ng.dot(wo)).abs();
        if !cosines.is_finite() {
            return Spectrum::BLACK;
        }
        let from_camera = |surface: &Surface| surface.eval(wi, wo, TransportMode::Radiance) * cosines;
        if !self.method.has_shading_normals {
            return from_camera(surface);
        }
        let mut seen = self.method.scene.surface_seen_from(self.ray, self.hit, wi);
        if let Some(wavelength) = self.wavelength {
            seen.bsdf = seen.bsdf.at_wavelength(wavelength);
        }
        from_camera(&seen)
    }

    /// A viewer in the direction `wi` may get another shading normal than the light does. [`Vertex::scattered`] can then be above 0 in
    /// directions that the BSDF as seen from the light never samples. A share of the samples is therefore cosine-distributed about the
    /// geometric normal, on both sides.
    fn sample(&self, wo: Vec3, choice: f32, u: Vec2) -> Option<(Vec3, Spectrum, BsdfSample)> {
        let surface = self.surface;
        let SurfacePoint { ng, ns, .. } = surface.point;
        let share = if self.method.has_shading_normals && ns != ng && self.has_smooth_lobe() { ABOUT_FACET } else { 0.0 };
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
        let value = self.scattered(wo, wi);
        let density = Density::Smooth(SolidAnglePdf::new(pdf));
        (!value.is_black()).then(|| (wi, value, BsdfSample { weight: value / pdf, density, ..sample }))
    }

    fn cos(&self, wi: Vec3) -> f32 {
        self.surface.point.ns.dot(wi)
    }

    fn spawn(&self, wi: Vec3, time: f32) -> Ray {
        self.surface.spawn(wi, time)
    }

    fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray {
        self.surface.shadow_ray(wi, target, time)
    }
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
