//! Light sampling, shared by integrators.

use super::space::Space;
use crate::bsdf::TransportMode;
use crate::light::LightSample;
use crate::math::{Spectrum, Vec3};
use crate::sampler::SampleNumbers;
use crate::scene::{Interaction, Scene};

/// Direct light of one light sample, f·|cos|·Li / pdf, and the sample.
///
/// - `space`: space between the point and the lights
/// - `dimension`: first of the three random numbers
///
/// `None` where the point has only delta lobes, does not scatter the light towards `wo`, or is in shadow.
pub fn sample_light<I: Interaction, S: Space>(
    scene: &dyn Scene,
    space: &S,
    at: &I,
    wo: Vec3,
    dimension: u32,
    time: f32,
    numbers: &mut SampleNumbers,
) -> Option<(Spectrum, LightSample)> {
    if !at.has_smooth_lobe() {
        return None;
    }
    let (choice, u) = numbers.get_3d(dimension);
    let light = scene.lights().sample(&at.light_context(wo, time), choice, u)?;
    let f = at.eval(wo, light.wi, TransportMode::Radiance);
    if f.is_black() {
        return None;
    }
    let passed = space.transmittance(scene, &at.shadow_ray(light.wi, &light.target, time), dimension, numbers)?;
    Some((f * passed * light.weight(), light))
}
