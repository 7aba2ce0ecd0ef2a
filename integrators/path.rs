//! Path tracing that finds light by chance.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Context, Estimator, Integrator, Interrupt, MAX_DEPTH, Roulette};
use pt::math::Spectrum;
use pt::sampler::Sampler;
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;
use pt::witness::{Account, End, Event, Nobody, Origin};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Follows one path from the camera and adds up the emission that it meets.
///
/// L = Σ_k β_k Le(x_k),  β_k = Π f·|cos| / pdf
///
/// No light is sampled, so that nothing can be counted twice: slow where lights are small, blind to
/// lights without extent, and the judge of every cleverer method.
///
/// Source: Kajiya, *The Rendering Equation* (1986).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Path {
    /// The most scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
}

impl Default for Path {
    fn default() -> Path {
        Path { max_depth: 64, roulette_depth: 4 }
    }
}

impl Integrator for Path {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, max_depth: self.max_depth, roulette: Roulette { from_depth: self.roulette_depth } })
    }

    /// Without a limit Russian roulette ends the paths; up to the limit they are the same paths.
    fn biases(&self) -> Vec<Bias> {
        let without = Path { max_depth: MAX_DEPTH, roulette_depth: self.roulette_depth.min(self.max_depth) };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
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
        let mut ray = camera.ray;
        let mut beta = Spectrum::ONE;
        let mut radiance = Spectrum::BLACK;
        // η² accumulated along the path: radiance is compressed in glass, roulette must not mind.
        let mut compression = 1.0;
        for depth in 0.. {
            if interrupt.ends(depth) {
                break;
            }
            let Some(hit) = self.scene.intersect(&ray) else {
                let lights = self.scene.lights();
                radiance += account.light(beta * lights.background(&ray), depth, || Origin::background(lights, 1.0));
                account.tell(|| Event::end(depth, End::Escaped));
                break;
            };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            account.tell(|| Event::vertex(depth, &ray, &hit, &surface, beta));
            radiance += account.light(beta * surface.emitted(wo), depth, || Origin::emission(&surface, 1.0));
            if depth == self.max_depth {
                account.tell(|| Event::end(depth, End::DepthLimit));
                break;
            }
            sampler.at(dimension::vertex(depth, Use::Bsdf));
            let (choice, u) = (sampler.next_1d(), sampler.next_2d());
            let Some((wi, sample)) = surface.sample(wo, choice, u, TransportMode::Radiance) else {
                account.tell(|| Event::end(depth, End::Absorbed));
                break;
            };
            beta *= sample.weight;
            compression *= sample.eta * sample.eta;
            let carried = beta * compression;
            account.tell(|| Event::scattering(depth, &surface, wo, &(wi, sample), self.roulette.chance(depth, carried)));
            let Some(survivors) = self.roulette.survive(depth, carried, sampler) else {
                account.tell(|| Event::end(depth, End::Roulette));
                break;
            };
            beta *= survivors;
            ray = surface.spawn(wi, ray.time);
        }
        radiance
    }
}
