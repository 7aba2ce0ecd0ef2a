//! Path tracing with next-event estimation and multiple importance sampling.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Estimator, Integrator, Interrupt, MAX_DEPTH, PathWalk, Roulette, sample_light};
use pt::light::LightSample;
use pt::math::{Density, Ray, SolidAnglePdf, Spectrum, Vec3, balance_heuristic, power_heuristic};
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::Sampler;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path tracing that samples a light as well as the BSDF at every vertex. `weights` chooses how the two are combined.
///
/// L = Σ_k β_k [ w_light f·|cos| Le / p_light  +  w_bsdf Le(next vertex) ],  w_light + w_bsdf = 1
///
/// Delta lights and delta lobes can be found by one technique only, which has weight 1.
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
    /// Power heuristic p_a² / (p_a² + p_b²): the least noise.
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

impl Default for Nee {
    fn default() -> Nee {
        Nee { max_depth: 64, roulette_depth: 4, weights: Weights::Power }
    }
}

impl Integrator for Nee {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        let roulette = Roulette { from_depth: self.roulette_depth };
        Box::new(Walk { scene, max_depth: self.max_depth, roulette, weights: self.weights })
    }

    /// Bias of `max_depth`. The integrator without the limit follows the same paths up to that depth; beyond it Russian roulette ends them.
    fn biases(&self) -> Vec<Bias> {
        let without = Nee { max_depth: MAX_DEPTH, roulette_depth: self.roulette_depth.min(self.max_depth), ..self.clone() };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
    weights: Weights,
}

/// Start and density of the path's last step, which weight the emission found at its end against light sampling.
#[derive(Clone, Copy)]
struct Arrival {
    from: Vec3,
    density: Density,
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
        let mut compression = 1.0;
        // Light sampling cannot find what the camera sees directly.
        let mut arrival = Arrival { from: ray.origin, density: Density::Delta };
        for depth in 0.. {
            if interrupt.ends(depth) {
                break;
            }
            let Some(hit) = self.scene.intersect(&ray) else {
                let (light, weight) = self.background(&ray, arrival);
                radiance += recorder.light(beta * light, depth, || Origin::background(self.scene.lights(), weight));
                recorder.record(|| Event::end(depth, End::Escaped));
                break;
            };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            recorder.record(|| Event::vertex(depth, &ray, &hit, &surface, beta));
            let (emitted, weight) = self.emission(&surface, wo, arrival);
            radiance += recorder.light(beta * emitted, depth, || Origin::emission(&surface, weight));
            if depth == self.max_depth {
                recorder.record(|| Event::end(depth, End::DepthLimit));
                break;
            }
            if let Some((direct, light, weight)) = self.direct(&surface, wo, depth, ray.time, sampler) {
                radiance += recorder.light(beta * direct, depth + 1, || Origin::light(&light, weight));
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
            arrival = Arrival { from: surface.shadow_origin, density: sample.density };
            ray = surface.spawn(wi, ray.time);
        }
        radiance
    }
}

// Inlined into both compiled walks, because calls would cost 2 % of a render.
impl Walk {
    /// Emission of a surface that BSDF sampling found, times its weight against light sampling, and the weight.
    #[inline(always)]
    fn emission(&self, surface: &Surface, wo: Vec3, arrival: Arrival) -> (Spectrum, f32) {
        let emitted = surface.emitted(wo);
        match arrival.density {
            Density::Smooth(pdf) if !emitted.is_black() => {
                let by_light = || self.scene.lights().pdf(surface.light, arrival.from, &surface.point);
                let weight = self.weights.of_bsdf(pdf, by_light);
                (emitted * weight, weight)
            }
            _ => (emitted, 1.0),
        }
    }

    /// Radiance of the background that BSDF sampling found, times its weight against light sampling, and the weight.
    #[inline(always)]
    fn background(&self, ray: &Ray, arrival: Arrival) -> (Spectrum, f32) {
        let background = self.scene.lights().background(ray);
        match arrival.density {
            Density::Smooth(pdf) => {
                let weight = self.weights.of_bsdf(pdf, || self.scene.lights().background_pdf(ray.direction));
                (background * weight, weight)
            }
            Density::Delta => (background, 1.0),
        }
    }

    /// Direct light of one light sample, times its weight against BSDF sampling, with the sample and the weight.
    #[inline(always)]
    fn direct(
        &self,
        surface: &Surface,
        wo: Vec3,
        depth: u32,
        time: f32,
        sampler: &mut dyn Sampler,
    ) -> Option<(Spectrum, LightSample, f32)> {
        let (direct, light) = sample_light(&*self.scene, surface, wo, depth, time, sampler)?;
        match light.density {
            Density::Smooth(pdf) => {
                let weight = self.weights.of_light(pdf, || surface.pdf(wo, light.wi));
                Some((direct * weight, light, weight))
            }
            Density::Delta => Some((direct, light, 1.0)),
        }
    }
}
