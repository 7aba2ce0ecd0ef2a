//! Russian roulette and light sampling, shared by integrators.

use crate::bsdf::TransportMode;
use crate::light::LightSample;
use crate::math::{Spectrum, Vec3};
use crate::sampler::Sampler;
use crate::sampler::dimension::{self, Use};
use crate::scene::{Scene, Surface};

/// Russian roulette: ends paths of low throughput early and weights the surviving paths up.
///
/// Survival probability q = min(1, max β·η²), where β is the throughput and η² undoes the compression of radiance in glass. The
/// probability depends on the throughput alone, never on radiance, so that emission ×2^k gives pixels ×2^k.
///
/// Where β falls by a factor ρ at each bounce, survivors carry β/q = 1 again. An upper bound on q below 1 would let their weight
/// grow by ρ/q per bounce, and for ρ² > q the variance would be unbounded. A path between perfect mirrors is therefore ended by
/// the depth limit, not by roulette.
///
/// Source: Arvo and Kirk, *Particle Transport and Image Synthesis* (1990). Tests: roulette_keeps_the_mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette {
    /// Depth of the first vertex at which a path may end.
    pub from_depth: u32,
}

impl Roulette {
    /// Probability with which a path continues.
    pub fn chance(&self, depth: u32, beta: Spectrum) -> f32 {
        if depth < self.from_depth { 1.0 } else { beta.max().min(1.0) }
    }

    /// Factor for the throughput of a path that continues; `None` if the path ends here.
    ///
    /// - `beta`: throughput without the compression by refraction
    pub fn survive(&self, depth: u32, beta: Spectrum, sampler: &mut dyn Sampler) -> Option<f32> {
        if depth < self.from_depth {
            return Some(1.0);
        }
        let q = self.chance(depth, beta);
        sampler.at(dimension::vertex(depth, Use::Roulette));
        (sampler.next_1d() < q).then(|| 1.0 / q)
    }
}

/// Direct light of one light sample, f·|cos|·Li / pdf, and the sample.
///
/// `None` where the surface has only delta lobes, does not scatter the light towards `wo`, or is in shadow.
pub fn sample_light(
    scene: &dyn Scene,
    surface: &Surface,
    wo: Vec3,
    depth: u32,
    time: f32,
    sampler: &mut dyn Sampler,
) -> Option<(Spectrum, LightSample)> {
    if !surface.bsdf.has_smooth_lobe() {
        return None;
    }
    sampler.at(dimension::vertex(depth, Use::Light));
    let (choice, u) = (sampler.next_1d(), sampler.next_2d());
    let light = scene.lights().sample(surface.shadow_origin, choice, u)?;
    let f = surface.eval(wo, light.wi, TransportMode::Radiance);
    let reached = !f.is_black() && !scene.occluded(&surface.shadow_ray(light.wi, &light.target, time));
    reached.then(|| (f * light.weight, light))
}
