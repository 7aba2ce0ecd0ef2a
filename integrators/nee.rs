//! Path tracing with next-event estimation.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Context, Estimator, Integrator, Interrupt, MAX_DEPTH, Roulette, sample_light};
use pt::light::LightSample;
use pt::math::{Density, Ray, SolidAnglePdf, Spectrum, Vec3, balance_heuristic, power_heuristic};
use pt::sampler::Sampler;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use pt::witness::{Account, End, Event, Nobody, Origin};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// At every vertex a light is sampled as well as the BSDF; `weights` says how the two share the light.
///
/// L = Σ_k β_k [ w_light f·|cos| Le / p_light  +  w_bsdf Le(next vertex) ],  w_light + w_bsdf = 1
///
/// Delta lights and delta lobes have but one technique, of weight 1.
///
/// Source: Veach and Guibas, *Optimally Combining Sampling Techniques for Monte Carlo Rendering* (1995).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Nee {
    /// The most scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
    /// How a light sample and a sample of the material share the light that both could find.
    pub weights: Weights,
}

/// w_a of the technique whose density is p_a, where the other's is p_b.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Weights {
    /// p_a² / (p_a² + p_b²): the least noise.
    #[default]
    Power,
    /// p_a / (p_a + p_b).
    Balance,
    /// 1 for lights wherever they can be sampled, else 1 for the material: no multiple importance sampling. Noisy where
    /// highlights show a lamp.
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

    /// Without a limit Russian roulette ends the paths; up to the limit they are the same paths.
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

/// How the path got to where it is: what the emission found there must be weighed against.
#[derive(Clone, Copy)]
struct Arrival {
    from: Vec3,
    density: Density,
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        match cx.witness.take() {
            None => self.walk(camera, cx.sampler, &mut Nobody, cx.interrupt),
            Some(witness) => self.walk(camera, cx.sampler, witness, cx.interrupt),
        }
    }
}

// What both walks call is compiled into both: out of line it would cost 2 % of a render.
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
        let mut compression = 1.0;
        // No light sample could have found what the camera sees directly.
        let mut arrival = Arrival { from: ray.origin, density: Density::Delta };
        for depth in 0.. {
            if interrupt.ends(depth) {
                break;
            }
            let Some(hit) = self.scene.intersect(&ray) else {
                let (light, weight) = self.background(&ray, arrival);
                radiance += account.light(beta * light, depth, || Origin::background(self.scene.lights(), weight));
                account.tell(|| Event::end(depth, End::Escaped));
                break;
            };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            account.tell(|| Event::vertex(depth, &ray, &hit, &surface, beta));
            let (emitted, weight) = self.emission(&surface, wo, arrival);
            radiance += account.light(beta * emitted, depth, || Origin::emission(&surface, weight));
            if depth == self.max_depth {
                account.tell(|| Event::end(depth, End::DepthLimit));
                break;
            }
            if let Some((direct, light, weight)) = self.direct(&surface, wo, depth, ray.time, sampler) {
                radiance += account.light(beta * direct, depth + 1, || Origin::light(&light, weight));
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
            arrival = Arrival { from: surface.lit, density: sample.density };
            ray = surface.spawn(wi, ray.time);
        }
        radiance
    }

    /// Emission of the surface that BSDF sampling found, weighed against light sampling; and the weight.
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

    /// The same for what comes from infinitely far away.
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

    /// Light that one light sample brings to the surface, weighed against BSDF sampling; the sample, and the weight.
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
