//! Layers of a picture: properties of the first surface that a camera ray hits, and the light of the picture's own paths.
//!
//! ```text
//! albedo   f·|cos θi| / pdf of one direction drawn from the surface's BSDF, without the 1/η² scaling of refracted radiance
//! ```
//!
//! The mean of the albedo is the fraction of light from the camera's direction that is scattered, reflected or transmitted. The albedo
//! is exact if the weight of a sample is the same for all directions (matte surfaces, mirrors, clear glass), and otherwise has the
//! noise of the picture's number of samples. The albedo of a surface that emits towards the camera is the colour of its light, scaled
//! to a largest component of 1.

use arrayvec::ArrayVec;
use glam::DVec3;

use crate::bsdf::TransportMode;
use crate::film::layer::MAX_CHANNELS;
use crate::film::{FilmSpec, Layer};
use crate::integrator::CameraSample;
use crate::math::Spectrum;
use crate::recorder::{LightSplit, PathRecorder};
use crate::sampler::SampleNumbers;
use crate::sampler::dimension::{self, Use};
use crate::scene::{Scene, Surface};

/// Accumulator of the layers of one pixel.
pub struct Aovs {
    layers: Vec<Layer>,
    /// Light of the current sample.
    split: LightSplit,
    /// Whether a layer needs the light of paths.
    needs_light: bool,
    /// Whether a layer needs the first surface.
    needs_hit: bool,
    /// Terms of the samples, a row for each.
    terms: Vec<f64>,
}

/// A sample that was taken for the picture.
pub struct Taken<'a> {
    /// Its camera ray.
    pub camera: &'a CameraSample,
    /// Its random numbers. Their use here does not change the picture.
    pub numbers: SampleNumbers<'a>,
    /// Whether it counts in the picture.
    pub is_valid: bool,
    /// Time that it took (s).
    pub seconds: f64,
}

/// Values of one layer, one per channel.
type Values = ArrayVec<f64, MAX_CHANNELS>;

impl Aovs {
    /// An accumulator without samples; `None` if the picture has no layers.
    pub fn new(spec: &FilmSpec) -> Option<Aovs> {
        let needs_light = spec.layers.iter().any(|layer| layer.is_light());
        let needs_hit = spec.layers.iter().any(|layer| !layer.is_light() && *layer != Layer::Time);
        let split = LightSplit::new(spec.lights.of.clone());
        (!spec.layers.is_empty()).then(|| Aovs { layers: spec.layers.clone(), split, needs_light, needs_hit, terms: vec![] })
    }

    /// Removes all samples, for the next pixel.
    pub fn clear(&mut self) {
        self.terms.clear();
    }

    /// The camera sample with the hit of its ray, if a layer needs the first surface.
    pub fn traced(&self, camera: CameraSample, scene: &dyn Scene) -> CameraSample {
        CameraSample { known_hit: self.needs_hit.then(|| scene.intersect(&camera.ray)), ..camera }
    }

    /// Recorder for the next sample, if a layer needs its light.
    pub fn recorder(&mut self) -> Option<&mut dyn PathRecorder> {
        self.split.clear();
        self.needs_light.then_some(&mut self.split as &mut dyn PathRecorder)
    }

    /// Adds a sample whose paths were recorded and whose camera ray was traced.
    pub fn add(&mut self, scene: &dyn Scene, sample: Taken) {
        let Taken { camera, mut numbers, is_valid, seconds } = sample;
        let surface = camera.known_hit.flatten().map(|hit| scene.surface(&camera.ray, &hit));
        for layer in &self.layers {
            let values = match (layer, &surface) {
                (Layer::Time, _) => Some([seconds].into_iter().collect()),
                // The light of an invalid sample is black, as in the picture.
                (layer, _) if layer.is_light() => Some(if is_valid { rgb(self.split.of(*layer)) } else { rgb(Spectrum::BLACK) }),
                (_, None) => None,
                (_, Some(surface)) => Some(values(scene, *layer, camera, surface, &mut numbers)),
            };
            layer.add_terms(f64::from(camera.weight), values.as_deref(), &mut self.terms);
        }
    }

    /// Sums of the terms of all samples, added in the order of the tree of samples. The number of samples must be a power of two.
    ///
    /// - `width`: number of terms of a sample
    pub fn sums(&mut self, width: usize) -> &[f64] {
        let rows = &mut self.terms;
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
}

/// Values of a layer at a surface.
fn values(scene: &dyn Scene, layer: Layer, camera: &CameraSample, surface: &Surface, numbers: &mut SampleNumbers) -> Values {
    let point = &surface.point;
    let vector = |v: DVec3| v.to_array().into_iter().collect();
    match layer {
        Layer::Albedo => rgb(albedo(surface, camera, numbers)),
        Layer::Normal => vector(point.ng.as_dvec3()),
        Layer::ShadingNormal => vector(point.ns.as_dvec3()),
        Layer::Position => vector(point.p.as_dvec3() + scene.origin()),
        Layer::Depth => [scene.camera().depth(point.p.as_dvec3(), camera.ray.time)].into_iter().collect(),
        Layer::Uv => point.uv.to_array().map(f64::from).into_iter().collect(),
        Layer::Time | Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_) => Values::new(),
    }
}

fn rgb(color: Spectrum) -> Values {
    color.to_rgb().map(f64::from).into_iter().collect()
}

/// Albedo sample of the surface, or the colour of its light if it emits.
fn albedo(surface: &Surface, camera: &CameraSample, numbers: &mut SampleNumbers) -> Spectrum {
    let wo = -camera.ray.direction;
    let emitted = surface.emitted(wo);
    if !emitted.is_black() {
        return emitted.map(|c| c / emitted.max());
    }
    let (choice, u) = numbers.get_3d(dimension::vertex(0, Use::Bsdf));
    // Importance is not compressed by refraction, so that the light entering glass counts fully.
    let sample = surface.bsdf.sample(surface.frame.to_local(wo), choice, u, TransportMode::Importance);
    sample.map_or(Spectrum::BLACK, |sample| sample.weight)
}

impl LightSplit {
    fn of(&self, layer: Layer) -> Spectrum {
        match layer {
            Layer::Emission => self.emission,
            Layer::Direct => self.direct,
            Layer::Indirect => self.indirect,
            Layer::Light(i) => self.groups.get(i as usize).copied().unwrap_or(Spectrum::BLACK),
            _ => Spectrum::BLACK,
        }
    }
}
