//! Whitted's ray tracing.

use std::ops::ControlFlow;
use std::sync::Arc;

use pt::bsdf::{BsdfSample, TransportMode};
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Estimator, Integrator, MAX_DEPTH, PathWalk, PathWavelength, Vacuum, sample_light};
use pt::math::{Ray, RayDifferential, Spectrum, SurfaceDifferential, Vec3};
use pt::primitive::Hit;
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::SampleNumbers;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Direct light at the first scattering surface, with rays in all mirror and refraction directions.
///
/// L(x) = Le + f·|cos| Le / p_light + Σ_lobes weight · L(next)
///
/// Surfaces are lit by the lights alone and not by other surfaces, except through mirrors and glass. After `branch_depth` interfaces
/// one lobe is chosen at random by its weight, so that the number of rays stays bounded and the expected value is right.
///
/// Source: Whitted, *An Improved Illumination Model for Shaded Display* (1980).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Whitted {
    /// Greatest number of scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Number of interfaces at which both reflection and refraction are followed; at most 12.
    #[serde(deserialize_with = "pt::integrator::at_most::<MAX_BRANCH_DEPTH, _>")]
    #[schemars(range(max = 12))]
    pub branch_depth: u32,
}

impl Default for Whitted {
    fn default() -> Whitted {
        Whitted { max_depth: 64, branch_depth: 4 }
    }
}

impl Integrator for Whitted {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, max_depth: self.max_depth, branch_depth: self.branch_depth.min(MAX_BRANCH_DEPTH) })
    }

    fn biases(&self) -> Vec<Bias> {
        let without = Whitted { max_depth: MAX_DEPTH, branch_depth: self.branch_depth };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }
}

const MAX_BRANCH_DEPTH: u32 = 12;

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    branch_depth: u32,
}

/// Ray that is still to be followed.
#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    beta: Spectrum,
    depth: u32,
    /// Differential between the ray and those beside it, where a texture depends on it.
    differential: Option<RayDifferential>,
    /// Wavelength, if the branch has met dispersive glass.
    wavelength: PathWavelength,
}

/// State of the walk: the branches that are still to be followed, and the radiance found so far.
struct State {
    /// Branch that is followed next.
    next: Branch,
    /// Hit of the camera ray, until it is used.
    known_hit: Option<Option<Hit>>,
    /// Branches that wait; each branching adds one.
    stack: [Option<Branch>; MAX_BRANCH_DEPTH as usize + 1],
    /// Number of branches that wait.
    count: usize,
    radiance: Spectrum,
}

impl PathWalk for Walk {
    type State = State;

    fn start(&self, camera: &CameraSample) -> State {
        let CameraSample { ray, differential, .. } = *camera;
        let next = Branch { ray, beta: Spectrum::ONE, depth: 0, differential, wavelength: PathWavelength::default() };
        State { next, known_hit: camera.known_hit, stack: [None; _], count: 0, radiance: Spectrum::BLACK }
    }

    fn step<R: Recorder + ?Sized>(&self, state: &mut State, numbers: &mut SampleNumbers, recorder: &mut R) -> ControlFlow<Spectrum> {
        let hit = state.known_hit.take().unwrap_or_else(|| self.scene.intersect(&state.next.ray));
        let [first, second] = self.follow(state.next, hit, &mut state.radiance, numbers, recorder);
        if let (Some(_), Some(_)) = (first, second) {
            state.stack[state.count] = second;
            state.count += 1;
        }
        let Some(next) = first.or(second).or_else(|| state.pop()) else { return ControlFlow::Break(state.radiance) };
        state.next = next;
        ControlFlow::Continue(())
    }
}

impl State {
    fn pop(&mut self) -> Option<Branch> {
        self.count = self.count.checked_sub(1)?;
        self.stack[self.count]
    }
}

impl Walk {
    /// Adds the light at the end of a branch, and returns the branches that start there.
    fn follow<R: Recorder + ?Sized>(
        &self,
        branch: Branch,
        hit: Option<Hit>,
        radiance: &mut Spectrum,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> [Option<Branch>; 2] {
        let Branch { ray, mut beta, depth, differential, mut wavelength } = branch;
        let Some(hit) = hit else {
            for (light, emitted) in self.scene.lights().background(ray.direction) {
                *radiance += recorder.light(beta * emitted, depth, || Origin::background(light, 1.0));
            }
            recorder.record(|| Event::end(depth, End::Escaped));
            return [None; 2];
        };
        let (mut surface, at): (Surface, Option<SurfaceDifferential>) = match &differential {
            Some(differential) => self.scene.surface_with_footprint(&ray, &hit, differential),
            None => (self.scene.surface(&ray, &hit), None),
        };
        let wo = -ray.direction;
        recorder.record(|| Event::vertex(depth, &ray, &hit, &surface, beta));
        *radiance += recorder.light(beta * surface.emitted(wo), depth, || Origin::emission(&surface, 1.0));
        if depth == self.max_depth {
            recorder.record(|| Event::end(depth, End::DepthLimit));
            return [None; 2];
        }
        if surface.is_dispersive {
            beta *= wavelength.take(&mut surface, depth, numbers, recorder);
        }
        if let Some((direct, light)) =
            sample_light(&*self.scene, &Vacuum, &surface, wo, dimension::vertex(depth, Use::Light), ray.time, numbers)
        {
            *radiance += recorder.light(beta * direct, depth + 1, || Origin::light(&light, 1.0));
        }
        let lobes = self.lobes(&surface, wo, depth, numbers);
        for lobe in lobes.iter().flatten() {
            recorder.record(|| Event::delta(depth, &surface, wo, &(lobe.0, lobe.1.weight)));
        }
        if lobes == [None; 2] {
            recorder.record(|| Event::end(depth, End::NotFollowed));
        }
        let onward = |(wi, sample): (Vec3, BsdfSample)| Branch {
            ray: surface.spawn(wi, ray.time),
            beta: beta * sample.weight,
            depth: depth + 1,
            differential: at.and_then(|at| at.scattered(surface.frame.z, ray.direction, wi, sample.eta)),
            wavelength,
        };
        lobes.map(|lobe| lobe.map(onward))
    }

    /// Directions and weights of all delta lobes where branching is allowed, otherwise of one of them.
    fn lobes(&self, surface: &Surface, wo: Vec3, depth: u32, numbers: &mut SampleNumbers) -> [Option<(Vec3, BsdfSample)>; 2] {
        let mut lobes = surface.delta_lobes(wo, TransportMode::Radiance);
        let (first, second) = (lobes.next(), lobes.next());
        let (Some(a), Some(b), true) = (first, second, depth >= self.branch_depth) else { return [first, second] };
        let (of_a, of_b) = (a.1.weight.max(), b.1.weight.max());
        let share = of_a / (of_a + of_b);
        let ((wi, sample), share) = if numbers.get_1d(dimension::vertex(depth, Use::Bsdf)) < share { (a, share) } else { (b, 1.0 - share) };
        [Some((wi, BsdfSample { weight: sample.weight / share, ..sample })), None]
    }
}
