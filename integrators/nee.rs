//! Path tracing with next-event estimation.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Estimator, Integrator, Roulette, sample_light};
use pt::math::{Density, Ray, Spectrum, Vec3, power_heuristic};
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// At every vertex a light is sampled as well as the BSDF; the power heuristic weighs the two.
///
/// L = Σ_k β_k [ w_light f·|cos| Le / p_light  +  w_bsdf Le(next vertex) ],  w_a = p_a² / (p_a² + p_b²)
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
}

impl Default for Nee {
    fn default() -> Nee {
        Nee { max_depth: 64, roulette_depth: 4 }
    }
}

impl Integrator for Nee {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, max_depth: self.max_depth, roulette: Roulette { from_depth: self.roulette_depth } })
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
}

/// How the path got to where it is: what the emission found there must be weighed against.
#[derive(Clone, Copy)]
struct Arrival {
    from: Vec3,
    density: Density,
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        let mut ray = camera.ray;
        let mut beta = Spectrum::ONE;
        let mut radiance = Spectrum::BLACK;
        let mut compression = 1.0;
        // No light sample could have found what the camera sees directly.
        let mut arrival = Arrival { from: ray.origin, density: Density::Delta };
        for depth in 0.. {
            let Some(hit) = self.scene.intersect(&ray) else {
                radiance += beta * self.background(&ray, arrival);
                break;
            };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            radiance += beta * self.emission(&surface, wo, arrival);
            if depth == self.max_depth {
                break;
            }
            radiance += beta * self.direct(&surface, wo, depth, ray.time, cx);

            cx.sampler.at(dimension::vertex(depth, Use::Bsdf));
            let (choice, u) = (cx.sampler.next_1d(), cx.sampler.next_2d());
            let Some((wi, sample)) = surface.sample(wo, choice, u, TransportMode::Radiance) else { break };
            beta *= sample.weight;
            compression *= sample.eta * sample.eta;
            let Some(survivors) = self.roulette.survive(depth, beta * compression, cx.sampler) else { break };
            beta *= survivors;
            arrival = Arrival { from: surface.lit, density: sample.density };
            ray = surface.spawn(wi, ray.time);
        }
        radiance
    }
}

impl Walk {
    /// Emission of the surface that BSDF sampling found, weighed against light sampling.
    fn emission(&self, surface: &Surface, wo: Vec3, arrival: Arrival) -> Spectrum {
        let emitted = surface.emitted(wo);
        match arrival.density {
            Density::Smooth(pdf) if !emitted.is_black() => {
                emitted * power_heuristic(pdf, self.scene.lights().pdf(surface.light, arrival.from, &surface.point))
            }
            _ => emitted,
        }
    }

    /// The same for what comes from infinitely far away.
    fn background(&self, ray: &Ray, arrival: Arrival) -> Spectrum {
        let background = self.scene.lights().background(ray);
        match arrival.density {
            Density::Smooth(pdf) => background * power_heuristic(pdf, self.scene.lights().background_pdf(ray.direction)),
            Density::Delta => background,
        }
    }

    /// Light that one light sample brings to the surface, weighed against BSDF sampling.
    fn direct(&self, surface: &Surface, wo: Vec3, depth: u32, time: f32, cx: &mut Context) -> Spectrum {
        let Some((direct, light)) = sample_light(&*self.scene, surface, wo, depth, time, cx) else { return Spectrum::BLACK };
        match light.density {
            Density::Smooth(pdf) => direct * power_heuristic(pdf, surface.pdf(wo, light.wi)),
            Density::Delta => direct,
        }
    }
}
