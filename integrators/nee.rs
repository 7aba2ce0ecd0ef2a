//! Path tracing with next-event estimation and multiple importance sampling.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use pt::bsdf::{BsdfSample, TransportMode};
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{
    Bias, CameraPath, CameraSample, Estimator, Filled, Integrator, MAX_DEPTH, PathLanes, PathWalk, Roulette, SideBySide, Space, Vacuum,
    WideSpace, WideWalk, sample_light,
};
use pt::light::{LightSample, LightSampleContext};
use pt::math::lanes::{Lanes, Vector};
use pt::math::{
    Density, SolidAnglePdf, Spectrum, Vec3, balance_heuristic, balance_heuristic_lanes, power_heuristic, power_heuristic_lanes,
};
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::dimension::{self, OnWay, Use};
use pt::sampler::{NumberLanes, SampleNumbers};
use pt::scene::{Interaction, Scene, Surface};
use pt::world::{LightLanes, MediumLanes, SurfaceLanes, WideWorld};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path tracing that samples a light as well as the BSDF at every vertex. `weights` chooses how the two are combined.
///
/// L = Σ_k β_k [ w_light f·|cos| Le / p_light  +  w_bsdf Le(next vertex) ],  w_light + w_bsdf = 1
///
/// Delta lights and delta lobes can be found by one technique only, which has weight 1.
///
/// In participating media, a point where the medium scatters the path is a vertex like others, with the phase function in the place of
/// f·|cos|, and light samples are weakened by the media on their way. Lights are not sampled at that point, but at one on the way to the
/// next surface that is chosen whether or not the path scatters, and near to a light: in thin media few paths scatter, and most light
/// comes from where the lamps are near. Where the density of a medium on the way varies, or the way has more than 16 stretches in different
/// media, lights are sampled at the point where the path scatters.
///
/// Source: Veach and Guibas, *Optimally Combining Sampling Techniques for Monte Carlo Rendering* (1995).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Nee {
    /// Greatest number of scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Number of scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
    /// Weights of light samples and of material samples for light that both could find.
    pub weights: Weights,
}

/// Weight w_a of a technique with density p_a for light that another technique finds with density p_b.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Weights {
    /// Power heuristic p_a² / (p_a² + p_b²): usually the least noise.
    #[default]
    Power,
    /// Balance heuristic p_a / (p_a + p_b).
    Balance,
    /// No multiple importance sampling: weight 1 for light samples of lights that can be sampled, and weight 1 for material samples
    /// of all other light. Noisy where highlights show a lamp.
    Light,
}

impl Weights {
    #[inline(always)]
    fn of_light(self, light: SolidAnglePdf, bsdf: impl FnOnce() -> SolidAnglePdf) -> f32 {
        match self {
            Weights::Power => power_heuristic(light, bsdf()),
            Weights::Balance => balance_heuristic(light, bsdf()),
            Weights::Light => 1.0,
        }
    }

    #[inline(always)]
    fn of_bsdf(self, bsdf: SolidAnglePdf, light: impl FnOnce() -> SolidAnglePdf) -> f32 {
        match self {
            Weights::Power => power_heuristic(bsdf, light()),
            Weights::Balance => balance_heuristic(bsdf, light()),
            Weights::Light if light().get() > 0.0 => 0.0,
            Weights::Light => 1.0,
        }
    }
}

/// Weights of several samples, one in each lane.
impl Weights {
    #[inline(always)]
    fn of_light_lanes<L: Lanes>(self, light: L::F32, bsdf: L::F32) -> L::F32 {
        match self {
            Weights::Power => power_heuristic_lanes::<L>(light, bsdf),
            Weights::Balance => balance_heuristic_lanes::<L>(light, bsdf),
            Weights::Light => L::f32(1.0),
        }
    }

    #[inline(always)]
    fn of_bsdf_lanes<L: Lanes>(self, bsdf: L::F32, light: L::F32) -> L::F32 {
        match self {
            Weights::Power => power_heuristic_lanes::<L>(bsdf, light),
            Weights::Balance => balance_heuristic_lanes::<L>(bsdf, light),
            Weights::Light => L::select(L::lt(L::f32(0.0), light), L::f32(0.0), L::f32(1.0)),
        }
    }
}

impl Default for Nee {
    fn default() -> Nee {
        Nee { max_depth: 64, roulette_depth: 4, weights: Weights::Power }
    }
}

impl Integrator for Nee {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        match scene.effects().contains(Effects::MEDIA) {
            true => Box::new(self.walk::<Filled>(scene)),
            false => Box::new(self.walk::<Vacuum>(scene)),
        }
    }

    /// Bias of `max_depth`. The integrator without the limit follows the same paths up to that depth; beyond it Russian roulette ends them.
    fn biases(&self) -> Vec<Bias> {
        let without = Nee { max_depth: MAX_DEPTH, roulette_depth: self.roulette_depth.min(self.max_depth), ..self.clone() };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }
}

impl Nee {
    fn walk<S>(&self, scene: Arc<dyn Scene>) -> Walk<S> {
        let roulette = Roulette { from_depth: self.roulette_depth };
        Walk { scene, max_depth: self.max_depth, roulette, weights: self.weights, space: PhantomData }
    }
}

/// The method in a space without or with media.
struct Walk<S> {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
    weights: Weights,
    space: PhantomData<S>,
}

/// State of the walk: the path, and how it arrives at its next vertex.
struct State<S> {
    path: CameraPath,
    arrival: Arrival,
    space: S,
}

/// Start and density of the path's last step, which weight the emission found at its end against light sampling.
#[derive(Clone, Copy)]
struct Arrival {
    from: LightSampleContext,
    density: Density,
}

impl<S: WideSpace> PathWalk for Walk<S> {
    type State = State<S>;

    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        WideWalk::scene(self).map(|_| self as &dyn SideBySide)
    }

    fn start(&self, camera: &CameraSample) -> State<S> {
        // Light sampling cannot find what the camera sees directly.
        State {
            path: CameraPath::new(camera),
            arrival: Arrival { from: LightSampleContext::at(camera.ray.origin), density: Density::Delta },
            space: S::at_camera(&*self.scene, camera),
        }
    }

    // Inlined into the loop over the steps, because a call would cost 3 % of a render.
    #[inline(always)]
    fn step<R: Recorder + ?Sized>(&self, state: &mut State<S>, numbers: &mut SampleNumbers, recorder: &mut R) -> ControlFlow<Spectrum> {
        let State { path, arrival, space } = state;
        let hit = path.hit(&*self.scene);
        if path.depth < self.max_depth
            && let Some((point, weight, space)) = space.point_on_way(&*self.scene, path, hit.as_ref(), numbers)
        {
            let (wo, dimension) = (-path.ray.direction, dimension::on_way(path.depth, OnWay::Light));
            if let Some((direct, light, mis)) = self.direct(&point, &space, wo, dimension, path.ray.time, numbers) {
                path.add_scattered(direct * weight, recorder, || Origin::light(&light, mis));
            }
        }
        if let Some(point) = space.scatter(&*self.scene, path, hit.as_ref(), numbers, recorder) {
            return self.scatter(&point, state, numbers, recorder);
        }
        let Some(hit) = hit else {
            for (light, radiance) in self.scene.lights().background(path.ray.direction) {
                let weight = self.background_weight(light, path.ray.direction, arrival);
                path.add_emission(radiance * weight, recorder, || Origin::background(light, weight));
            }
            return path.end(End::Escaped, recorder);
        };
        let mut surface = path.surface(&*self.scene, &hit);
        let wo = -path.ray.direction;
        recorder.record(|| Event::vertex(path.depth, &path.ray, &hit, &surface, path.beta));
        let (emitted, weight) = self.emission(&surface, wo, arrival);
        path.add_emission(emitted, recorder, || Origin::emission(&surface, weight));
        space.arrive(&*self.scene, &hit, &surface);
        path.take_wavelength(&mut surface, numbers, recorder);
        self.scatter(&surface, state, numbers, recorder)
    }
}

impl<S: WideSpace> WideWalk for Walk<S> {
    fn scene(&self) -> Option<WideWorld<'_>> {
        S::scene(&*self.scene)
    }

    #[inline(always)]
    fn step<L: Lanes>(
        &self,
        scene: WideWorld,
        depth: u32,
        paths: &mut PathLanes<'_, L>,
        numbers: &mut NumberLanes<L>,
        active: L::Mask,
    ) -> L::Mask {
        let mut hits = scene.intersect(&paths.rays, active);
        let wo = -paths.rays.direction;
        if depth < self.max_depth
            && let Some((points, weight)) = S::points_on_way(scene, paths, &hits, numbers, depth, active)
        {
            let (lit, direct) = self.direct_in_medium(scene, &points, wo, numbers.get_3d(dimension::on_way(depth, OnWay::Light)));
            paths.add(lit, direct * weight);
        }
        let in_medium = S::scatter_lanes(scene, paths, &mut hits, numbers, depth, active);
        let scattered = in_medium.as_ref().map_or(L::mask(0), |points| points.found);
        let found = L::mask(hits.found);
        let missed = active & !(found | scattered);
        if L::any(missed) {
            for &light in scene.background_lights() {
                paths.add(missed, self.background_lanes(scene, light, paths, missed));
            }
        }
        if !L::any(found | scattered) {
            return found;
        }
        let surface = paths.surfaces(scene, &hits);
        paths.add(found, self.emission_lanes(scene, &surface, wo, paths));
        if depth == self.max_depth {
            return L::mask(0);
        }
        let (lit, direct) = self.direct_lanes(scene, &surface, wo, numbers, depth);
        paths.add(lit, direct);

        paths.scatter(scene, &surface, in_medium.as_ref(), self.roulette, depth, numbers)
    }
}

/// The terms of [`Walk`]'s sum for the paths of several lanes.
impl<S: WideSpace> Walk<S> {
    /// [`Walk::emission`] in each lane.
    #[inline(always)]
    fn emission_lanes<L: Lanes>(
        &self,
        scene: WideWorld,
        surface: &SurfaceLanes<'_, L>,
        wo: Vector<L>,
        paths: &PathLanes<'_, L>,
    ) -> Vector<L> {
        let emitted = surface.emitted(wo);
        let is_delta = L::lt(paths.pdf, L::f32(0.0));
        let weighted = surface.found & !emitted.is_black() & !is_delta;
        if !L::any(weighted) {
            return emitted;
        }
        let by_light = scene.light_pdf(&paths.from, &paths.rays, surface, weighted);
        let weight = self.weights.of_bsdf_lanes::<L>(paths.pdf, by_light);
        emitted.scaled(L::select(weighted, weight, L::f32(1.0)))
    }

    /// Radiance of an infinitely distant light in each lane, times its weight as [`Walk::background_weight`].
    #[inline(always)]
    fn background_lanes<L: Lanes>(&self, scene: WideWorld, light: u32, paths: &PathLanes<'_, L>, missed: L::Mask) -> Vector<L> {
        let is_delta = L::lt(paths.pdf, L::f32(0.0));
        if !L::any(missed & !is_delta) {
            return scene.background(light, &paths.rays, missed);
        }
        let (radiance, by_light) = scene.background_and_pdf(light, &paths.rays, &paths.from, missed);
        let weight = self.weights.of_bsdf_lanes::<L>(paths.pdf, by_light);
        radiance.scaled(L::select(is_delta, L::f32(1.0), weight))
    }

    /// [`Walk::direct`] in each lane, and the lanes that have light.
    #[inline(always)]
    fn direct_lanes<L: Lanes>(
        &self,
        scene: WideWorld,
        surface: &SurfaceLanes<'_, L>,
        wo: Vector<L>,
        numbers: &mut NumberLanes<L>,
        depth: u32,
    ) -> (L::Mask, Vector<L>) {
        let smooth = scene.has_smooth_lobe(surface);
        if !L::any(smooth) {
            return (smooth, wo);
        }
        let light = scene.sample_light(&surface.receiver(wo), numbers.get_3d(dimension::vertex(depth, Use::Light)), smooth);
        let (f, by_bsdf) = scene.eval(surface, wo, light.wi, light.found);
        let unshadowed = light.found & !f.is_black();
        let rays = surface.shadow_rays(&light);
        let (passes, passed) = S::transmittance_lanes(scene, &rays, surface.p, unshadowed);
        let lit = passes & !scene.occluded(&rays, passes);
        (lit, (f.scaled(passed) * light.weight).scaled(self.light_weight(&light, by_bsdf)))
    }

    /// [`Walk::direct`] for points of a medium in each lane, and the lanes that have light.
    #[inline(always)]
    fn direct_in_medium<L: Lanes>(
        &self,
        scene: WideWorld,
        at: &MediumLanes<'_, L>,
        wo: Vector<L>,
        numbers: [L::F32; 3],
    ) -> (L::Mask, Vector<L>) {
        let light = scene.sample_light(&at.receiver(), numbers, at.found);
        let phase = at.phase.eval_lanes(wo, light.wi);
        let unshadowed = light.found & L::lt(L::f32(0.0), phase);
        let rays = at.shadow_rays(&light);
        let (passes, passed) = S::transmittance_lanes(scene, &rays, at.p, unshadowed);
        let lit = passes & !scene.occluded(&rays, passes);
        (lit, light.weight.scaled(phase * passed).scaled(self.light_weight(&light, phase)))
    }

    /// Weights of light samples against samples of the BSDF or of the phase function.
    #[inline(always)]
    fn light_weight<L: Lanes>(&self, light: &LightLanes<L>, by_bsdf: L::F32) -> L::F32 {
        let is_delta = L::lt(light.pdf, L::f32(0.0));
        L::select(is_delta, L::f32(1.0), self.weights.of_light_lanes::<L>(light.pdf, by_bsdf))
    }
}

// Inlined into all compiled walks, because calls would cost 2 % of a render.
impl<S: Space> Walk<S> {
    /// Adds the light that a vertex scatters into the path, and goes on in a sampled direction.
    #[inline(always)]
    fn scatter<I: Interaction, R: Recorder + ?Sized>(
        &self,
        at: &I,
        State { path, arrival, space }: &mut State<S>,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> ControlFlow<Spectrum> {
        let (wo, time) = (-path.ray.direction, path.ray.time);
        if path.depth == self.max_depth {
            return path.end(End::DepthLimit, recorder);
        }
        if !space.is_lit_on_way() {
            let dimension = dimension::vertex(path.depth, Use::Light);
            if let Some((direct, light, weight)) = self.direct(at, space, wo, dimension, time, numbers) {
                path.add_scattered(direct, recorder, || Origin::light(&light, weight));
            }
        }
        let (choice, u) = numbers.get_3d(dimension::vertex(path.depth, Use::Bsdf));
        let sample = at.sample(wo, choice, u, TransportMode::Radiance);
        let BsdfSample { density, .. } = path.scatter(at, sample, self.roulette, numbers, recorder)?;
        space.leave(path.ray.direction);
        *arrival = Arrival { from: at.light_context(wo, time), density };
        ControlFlow::Continue(())
    }

    /// Emission of a surface that BSDF sampling found, times its weight against light sampling, and the weight.
    #[inline(always)]
    fn emission(&self, surface: &Surface, wo: Vec3, arrival: &Arrival) -> (Spectrum, f32) {
        let emitted = surface.emitted(wo);
        match arrival.density {
            Density::Smooth(pdf) if !emitted.is_black() => {
                let by_light = || self.scene.lights().pdf(surface.light, &arrival.from, &surface.point);
                let weight = self.weights.of_bsdf(pdf, by_light);
                (emitted * weight, weight)
            }
            _ => (emitted, 1.0),
        }
    }

    /// Weight against light sampling of the radiance of an infinitely distant light that BSDF sampling found.
    #[inline(always)]
    fn background_weight(&self, light: u32, direction: Vec3, arrival: &Arrival) -> f32 {
        match arrival.density {
            Density::Smooth(pdf) => self.weights.of_bsdf(pdf, || self.scene.lights().background_pdf(light, &arrival.from, direction)),
            Density::Delta => 1.0,
        }
    }

    /// Direct light of one light sample, times its weight against BSDF sampling, with the sample and the weight.
    #[inline(always)]
    fn direct<I: Interaction>(
        &self,
        at: &I,
        space: &S,
        wo: Vec3,
        dimension: u32,
        time: f32,
        numbers: &mut SampleNumbers,
    ) -> Option<(Spectrum, LightSample, f32)> {
        let (direct, light) = sample_light(&*self.scene, space, at, wo, dimension, time, numbers)?;
        match light.density {
            Density::Smooth(pdf) => {
                let weight = self.weights.of_light(pdf, || at.pdf(wo, light.wi));
                Some((direct * weight, light, weight))
            }
            Density::Delta => Some((direct, light, 1.0)),
        }
    }
}
