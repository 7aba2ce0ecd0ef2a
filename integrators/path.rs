//! Path tracing without light sampling.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Estimator, Integrator, Interrupt, MAX_DEPTH, PathWalk, Roulette};
use pt::math::Spectrum;
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::Sampler;
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path tracing that follows one path from the camera and adds up the emission of the surfaces it hits.
///
/// L = Σ_k β_k Le(x_k),  β_k = Π f·|cos| / pdf
///
/// No light is sampled, so that no light can be counted twice. The method is slow where lights are small, does not see lights
/// without extent, and serves as the reference for all other methods.
///
/// Source: Kajiya, *The Rendering Equation* (1986).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Path {
    /// Greatest number of scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Number of scattering events before Russian roulette may end a path.
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

    /// Bias of `max_depth`. The integrator without the limit follows the same paths up to that depth; beyond it Russian roulette ends them.
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

impl PathWalk for Walk {
    fn walk<R: Recorder + ?Sized>(
        &self,
        camera: &CameraSample,
        sampler: &mut dyn Sampler,
        recorder: &mut R,
        interrupt: Interrupt,
    ) -> Spectrum {
        let mut ray = camera.ray;
        let mut beta = Spectrum::ONE;
        let mut radiance = Spectrum::BLACK;
        // Product of η² along the path: it undoes the compression of radiance in glass, which roulette must not depend on.
        let mut compression = 1.0;
        for depth in 0.. {
            if interrupt.ends(depth) {
                break;
            }
            let Some(hit) = self.scene.intersect(&ray) else {
                let lights = self.scene.lights();
                radiance += recorder.light(beta * lights.background(&ray), depth, || Origin::background(lights, 1.0));
                recorder.record(|| Event::end(depth, End::Escaped));
                break;
            };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            recorder.record(|| Event::vertex(depth, &ray, &hit, &surface, beta));
            radiance += recorder.light(beta * surface.emitted(wo), depth, || Origin::emission(&surface, 1.0));
            if depth == self.max_depth {
                recorder.record(|| Event::end(depth, End::DepthLimit));
                break;
            }
            sampler.at(dimension::vertex(depth, Use::Bsdf));
            let (choice, u) = (sampler.next_1d(), sampler.next_2d());
            let Some((wi, sample)) = surface.sample(wo, choice, u, TransportMode::Radiance) else {
                recorder.record(|| Event::end(depth, End::Absorbed));
                break;
            };
            beta *= sample.weight;
            compression *= sample.eta * sample.eta;
            let carried = beta * compression;
            recorder.record(|| Event::scattering(depth, &surface, wo, &(wi, sample), self.roulette.chance(depth, carried)));
            let Some(survivors) = self.roulette.survive(depth, carried, sampler) else {
                recorder.record(|| Event::end(depth, End::Roulette));
                break;
            };
            beta *= survivors;
            ray = surface.spawn(wi, ray.time);
        }
        radiance
    }
}
