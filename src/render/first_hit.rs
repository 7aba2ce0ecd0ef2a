//! Layers with properties of the first surface that a camera ray hits.
//!
//! ```text
//! albedo   f·|cos θi| / pdf of one direction drawn from the surface's BSDF, without the compression of radiance in glass
//! ```
//!
//! The mean of the albedo is the fraction of light from the camera's direction that is scattered, reflected or transmitted. The albedo
//! is exact if the weight of a sample is the same for all directions (matte surfaces, mirrors, clear glass), and otherwise has the
//! noise of the picture's number of samples. The albedo of a surface that emits towards the camera is the colour of its light, scaled
//! to a largest component of 1.

use arrayvec::ArrayVec;
use glam::DVec3;

use crate::bsdf::TransportMode;
use crate::film::Layer;
use crate::film::layer::MAX_CHANNELS;
use crate::integrator::CameraSample;
use crate::math::Spectrum;
use crate::sampler::Sampler;
use crate::sampler::dimension::{self, Use};
use crate::scene::{Scene, Surface};

/// Values of one layer, one per channel.
type Values = ArrayVec<f64, MAX_CHANNELS>;

/// Time and light of a sample, measured when it was taken for the picture.
pub struct SampleRecord<'a> {
    /// Time that the sample took (s).
    pub seconds: f64,
    /// Red, green and blue of each light layer.
    pub light: &'a [f64],
}

/// Appends the terms that one sample adds to the layers, in their order.
///
/// - `sampler`: sampler of the sample after the camera's numbers. Its use here does not change the numbers of the picture.
pub fn add_terms(
    scene: &dyn Scene,
    layers: &[Layer],
    camera: &CameraSample,
    sampler: &mut dyn Sampler,
    record: SampleRecord,
    terms: &mut Vec<f64>,
) {
    let hit = scene.intersect(&camera.ray);
    let surface = hit.map(|hit| scene.surface(&camera.ray, &hit));
    let mut light = record.light.chunks_exact(3);
    for layer in layers {
        let values = match (layer, &surface) {
            (Layer::Time, _) => Some([record.seconds].into_iter().collect()),
            (layer, _) if layer.is_light() => light.next().map(|rgb| rgb.iter().copied().collect()),
            (_, None) => None,
            (_, Some(surface)) => Some(values(scene, *layer, camera, surface, sampler)),
        };
        layer.add_terms(f64::from(camera.weight), values.as_deref(), terms);
    }
}

/// Values of a layer at a surface.
fn values(scene: &dyn Scene, layer: Layer, camera: &CameraSample, surface: &Surface, sampler: &mut dyn Sampler) -> Values {
    let point = &surface.point;
    let vector = |v: DVec3| v.to_array().into_iter().collect();
    match layer {
        Layer::Albedo => albedo(surface, camera, sampler).to_rgb().map(f64::from).into_iter().collect(),
        Layer::Normal => vector(point.ng.as_dvec3()),
        Layer::ShadingNormal => vector(point.ns.as_dvec3()),
        Layer::Position => vector(point.p.as_dvec3() + scene.origin()),
        Layer::Depth => [scene.camera().depth(point.p.as_dvec3())].into_iter().collect(),
        Layer::Uv => point.uv.to_array().map(f64::from).into_iter().collect(),
        Layer::Time | Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_) => Values::new(),
    }
}

/// Albedo sample of the surface, or the colour of its light if it emits.
fn albedo(surface: &Surface, camera: &CameraSample, sampler: &mut dyn Sampler) -> Spectrum {
    let wo = -camera.ray.direction;
    let emitted = surface.emitted(wo);
    if !emitted.is_black() {
        return emitted.map(|c| c / emitted.max());
    }
    sampler.at(dimension::vertex(0, Use::Bsdf));
    let (choice, u) = (sampler.next_1d(), sampler.next_2d());
    // Importance is not compressed by refraction, so that the light entering glass counts fully.
    let sample = surface.bsdf.sample(surface.frame.to_local(wo), choice, u, TransportMode::Importance);
    sample.map_or(Spectrum::BLACK, |sample| sample.weight)
}

/// Sum of the rows of `width` numbers, added in the order of the tree of samples. The number of rows must be a power of two.
pub fn joined(rows: &mut [f64], width: usize) -> &[f64] {
    let mut apart = width;
    while apart < rows.len() {
        for pair in rows.chunks_mut(2 * apart) {
            let (left, right) = pair.split_at_mut(apart);
            left.iter_mut().zip(right).take(width).for_each(|(a, b)| *a += *b);
        }
        apart *= 2;
    }
    &rows[..width]
}
