//! Whitted's ray tracing.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Estimator, Integrator, Interrupt, MAX_DEPTH, PathWalk, sample_light};
use pt::math::{Ray, Spectrum, Vec3};
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::Sampler;
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
}

impl PathWalk for Walk {
    fn walk<R: Recorder + ?Sized>(
        &self,
        camera: &CameraSample,
        sampler: &mut dyn Sampler,
        recorder: &mut R,
        interrupt: Interrupt,
    ) -> Spectrum {
        let mut radiance = Spectrum::BLACK;
        // Each branching puts one ray on the stack.
        let mut stack: [Option<Branch>; MAX_BRANCH_DEPTH as usize + 1] = [None; _];
        let mut next = Some(Branch { ray: camera.ray, beta: Spectrum::ONE, depth: 0 });
        let (mut count, mut followed) = (0, 0);
        while let Some(branch) = next {
            if interrupt.ends(followed) {
                break;
            }
            followed = followed.wrapping_add(1);
            let [first, second] = self.follow(branch, &mut radiance, sampler, recorder);
            if let (Some(_), Some(_)) = (first, second) {
                stack[count] = second;
                count += 1;
            }
            next = first.or(second);
            if next.is_none() && count > 0 {
                count -= 1;
                next = stack[count];
            }
        }
        radiance
    }
}

impl Walk {
    /// Adds the light at the end of a branch, and returns the branches that start there.
    fn follow<R: Recorder + ?Sized>(
        &self,
        branch: Branch,
        radiance: &mut Spectrum,
        sampler: &mut dyn Sampler,
        recorder: &mut R,
    ) -> [Option<Branch>; 2] {
        let Branch { ray, beta, depth } = branch;
        let Some(hit) = self.scene.intersect(&ray) else {
            let lights = self.scene.lights();
            *radiance += recorder.light(beta * lights.background(&ray), depth, || Origin::background(lights, 1.0));
            recorder.record(|| Event::end(depth, End::Escaped));
            return [None; 2];
        };
        let surface = self.scene.surface(&ray, &hit);
        let wo = -ray.direction;
        recorder.record(|| Event::vertex(depth, &ray, &hit, &surface, beta));
        *radiance += recorder.light(beta * surface.emitted(wo), depth, || Origin::emission(&surface, 1.0));
        if depth == self.max_depth {
            recorder.record(|| Event::end(depth, End::DepthLimit));
            return [None; 2];
        }
        if let Some((direct, light)) = sample_light(&*self.scene, &surface, wo, depth, ray.time, sampler) {
            *radiance += recorder.light(beta * direct, depth + 1, || Origin::light(&light, 1.0));
        }
        let lobes = self.lobes(&surface, wo, depth, sampler);
        for lobe in lobes.iter().flatten() {
            recorder.record(|| Event::delta(depth, &surface, wo, lobe));
        }
        if lobes == [None; 2] {
            recorder.record(|| Event::end(depth, End::NotFollowed));
        }
        let onward = |(wi, weight): (Vec3, Spectrum)| Branch { ray: surface.spawn(wi, ray.time), beta: beta * weight, depth: depth + 1 };
        lobes.map(|lobe| lobe.map(onward))
    }

    /// Directions and weights of all delta lobes where branching is allowed, otherwise of one of them.
    fn lobes(&self, surface: &Surface, wo: Vec3, depth: u32, sampler: &mut dyn Sampler) -> [Option<(Vec3, Spectrum)>; 2] {
        let mut lobes = surface.delta_lobes(wo, TransportMode::Radiance).map(|(wi, sample)| (wi, sample.weight));
        let (first, second) = (lobes.next(), lobes.next());
        let (Some(a), Some(b), true) = (first, second, depth >= self.branch_depth) else { return [first, second] };
        let share = a.1.max() / (a.1.max() + b.1.max());
        sampler.at(dimension::vertex(depth, Use::Bsdf));
        let chosen = if sampler.next_1d() < share { (a.0, a.1 / share) } else { (b.0, b.1 / (1.0 - share)) };
        [Some(chosen), None]
    }
}
