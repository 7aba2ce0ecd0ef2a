//! The walk in double precision.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::materials::disk;
use super::read::DoubleScene;
use crate::integrator::{CameraSample, Context, Estimator};
use crate::math::Spectrum;
use crate::sampler::dimension::{self, Use};

/// Numbers of scattering events: the greatest one, and that from which Russian roulette may end a path.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub max_depth: u32,
    pub roulette_depth: u32,
}

/// Path tracing that follows one path from the camera and adds up the emission of the surfaces that it hits.
pub struct Walk {
    pub scene: Arc<DoubleScene>,
    pub limits: Limits,
    /// Size of the film (pixels).
    pub film: DVec2,
}

impl Estimator for Walk {
    fn li(&self, sample: &CameraSample, cx: &mut Context) -> Spectrum {
        let radiance = self.radiance(sample, cx);
        Spectrum::rgb(radiance.x as f32, radiance.y as f32, radiance.z as f32)
    }
}

impl Walk {
    /// Σ β Le over the vertices of a path, β = Π f |cos| / p.
    fn radiance(&self, sample: &CameraSample, cx: &mut Context) -> DVec3 {
        let lens = if self.scene.has_lens() { disk(cx.numbers.get_2d(dimension::LENS).as_dvec2()) } else { DVec2::ZERO };
        let mut ray = self.scene.camera.ray(sample.raster.as_dvec2() / self.film, self.film.x / self.film.y, lens);
        let (mut beta, mut radiance, mut eta_scale) = (DVec3::ONE, DVec3::ZERO, 1.0);
        for depth in 0.. {
            let Some(hit) = self.scene.surfaces.closest(&ray) else { return radiance + beta * self.scene.background };
            let wo = -ray.direction;
            let front = hit.ng.dot(wo);
            if hit.appearance.two_sided || front > 0.0 {
                radiance += beta * hit.appearance.emission;
            }
            if depth == self.limits.max_depth || cx.interrupt.ends(depth) {
                break;
            }
            let (choice, u) = cx.numbers.get_3d(dimension::vertex(depth, Use::Bsdf));
            let local = hit.frame.to_local(wo);
            let inside = if front < 0.0 { hit.t } else { 0.0 };
            let Some(sampled) = hit.appearance.material.sample(local, choice.into(), u.as_dvec2(), inside) else { break };
            let wi = hit.frame.to_world(sampled.wi).normalize();
            // Where shading normal and geometric normal disagree about the side of a direction, nothing is scattered.
            if (front * hit.ng.dot(wi) > 0.0) != (local.z * sampled.wi.z > 0.0) {
                break;
            }
            beta *= sampled.weight;
            eta_scale *= sampled.eta * sampled.eta;
            if depth >= self.limits.roulette_depth {
                let q = (beta * eta_scale).max_element().min(1.0);
                if f64::from(cx.numbers.get_1d(dimension::vertex(depth, Use::Roulette))) >= q {
                    break;
                }
                beta /= q;
            }
            ray = hit.spawn(&ray, wi);
        }
        radiance
    }
}
