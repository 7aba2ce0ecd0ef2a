//! Whitted's ray tracing.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Context, Estimator, Integrator, Interrupt, MAX_DEPTH, sample_light};
use pt::math::{Ray, Spectrum, Vec3};
use pt::sampler::Sampler;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use pt::witness::{Account, End, Event, Nobody, Origin};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Direct light on what scatters, and a ray into every mirror direction.
///
/// L(x) = Le + f·|cos| Le / p_light + Σ_lobes weight · L(next)
///
/// What scatters is lit by the lights alone: no surface lights another, except through mirrors and glass.
/// Where a path meets more interfaces than `branch_depth`, one lobe is chosen at random, by weight, so that
/// the number of rays stays bounded and the mean stays right.
///
/// Source: Whitted, *An Improved Illumination Model for Shaded Display* (1980).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Whitted {
    /// The most scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Interfaces at which both reflection and refraction are followed; at most 12.
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

/// A ray still to be followed.
#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    beta: Spectrum,
    depth: u32,
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        match cx.witness.take() {
            None => self.walk(camera, cx.sampler, &mut Nobody, cx.interrupt),
            Some(witness) => self.walk(camera, cx.sampler, witness, cx.interrupt),
        }
    }
}

impl Walk {
    fn walk<A: Account + ?Sized>(
        &self,
        camera: &CameraSample,
        sampler: &mut dyn Sampler,
        account: &mut A,
        interrupt: Interrupt,
    ) -> Spectrum {
        let mut radiance = Spectrum::BLACK;
        // Each branching leaves one ray waiting.
        let mut waiting: [Option<Branch>; MAX_BRANCH_DEPTH as usize + 1] = [None; _];
        let mut next = Some(Branch { ray: camera.ray, beta: Spectrum::ONE, depth: 0 });
        let (mut count, mut followed) = (0, 0);
        while let Some(branch) = next {
            if interrupt.ends(followed) {
                break;
            }
            followed = followed.wrapping_add(1);
            let [first, second] = self.follow(branch, &mut radiance, sampler, account);
            if let (Some(_), Some(_)) = (first, second) {
                waiting[count] = second;
                count += 1;
            }
            next = first.or(second);
            if next.is_none() && count > 0 {
                count -= 1;
                next = waiting[count];
            }
        }
        radiance
    }

    /// Adds the light at the end of a branch; the branches that start there.
    fn follow<A: Account + ?Sized>(
        &self,
        branch: Branch,
        radiance: &mut Spectrum,
        sampler: &mut dyn Sampler,
        account: &mut A,
    ) -> [Option<Branch>; 2] {
        let Branch { ray, beta, depth } = branch;
        let Some(hit) = self.scene.intersect(&ray) else {
            let lights = self.scene.lights();
            *radiance += account.light(beta * lights.background(&ray), depth, || Origin::background(lights, 1.0));
            account.tell(|| Event::end(depth, End::Escaped));
            return [None; 2];
        };
        let surface = self.scene.surface(&ray, &hit);
        let wo = -ray.direction;
        account.tell(|| Event::vertex(depth, &ray, &hit, &surface, beta));
        *radiance += account.light(beta * surface.emitted(wo), depth, || Origin::emission(&surface, 1.0));
        if depth == self.max_depth {
            account.tell(|| Event::end(depth, End::DepthLimit));
            return [None; 2];
        }
        if let Some((direct, light)) = sample_light(&*self.scene, &surface, wo, depth, ray.time, sampler) {
            *radiance += account.light(beta * direct, depth + 1, || Origin::light(&light, 1.0));
        }
        let lobes = self.lobes(&surface, wo, depth, sampler);
        for lobe in lobes.iter().flatten() {
            account.tell(|| Event::delta(depth, &surface, wo, lobe));
        }
        if lobes == [None; 2] {
            account.tell(|| Event::end(depth, End::NotFollowed));
        }
        let onward = |(wi, weight): (Vec3, Spectrum)| Branch { ray: surface.spawn(wi, ray.time), beta: beta * weight, depth: depth + 1 };
        lobes.map(|lobe| lobe.map(onward))
    }

    /// All delta lobes where branching is allowed, else one of them: direction and weight.
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
