//! Recording of what happens along a path.
//!
//! A walk is written once, generic over a [`Recorder`], and compiled twice: for [`NoRecorder`], whose calls leave no instructions
//! behind, and for `dyn PathRecorder`. An integrator that implements [`PathWalk`](crate::integrator::PathWalk) gets both.
//!
//! Tests: the recorded light adds up to the radiance, bit for bit; recording changes no picture.

mod clamp;
mod light_split;

use glam::Vec3;

use crate::bsdf::{BsdfSample, Lobe, TransportMode};
use crate::film::Splat;
use crate::light::{EmittedRay, LightSample};
use crate::math::{Density, Ray, Spectrum, Wavelength};
use crate::medium::MediumId;
use crate::primitive::Hit;
use crate::scene::{Interaction, MediumPoint, Surface};
use crate::shape::SurfacePoint;

pub use clamp::Clamp;
pub use light_split::LightSplit;

/// Receiver of the events along the paths of a camera sample.
pub trait PathRecorder {
    /// Takes the next event. Events arrive in the order in which they happen; where a path branches, one branch is followed to its
    /// end before the next.
    fn record(&mut self, event: Event);

    /// Returns the part of some light that counts. Returning less than all of it biases the picture.
    ///
    /// - `light`: contribution that is about to be added to the radiance
    /// - `depth`: scattering events between emitter and camera
    fn clamp(&mut self, light: Spectrum, _depth: u32) -> Spectrum {
        light
    }
}

/// One event along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The path hit a surface.
    Vertex(Vertex),
    /// A medium scattered the path.
    Medium(MediumVertex),
    /// The path took a wavelength, because scattering at the surface that it hit depends on it.
    Wavelength {
        /// Scattering events before the surface.
        depth: u32,
        /// The wavelength, which the path keeps.
        wavelength: Wavelength,
        /// Factors of the path's throughput.
        factors: Spectrum,
    },
    /// Light was added to the radiance.
    Light(Contribution),
    /// The path was scattered and goes on.
    Scattering(Scattering),
    /// A path starts at a light.
    Emission(EmittedRay),
    /// Light was added to the film at another place than that of the sample.
    Splat(Splat),
    /// The path ended.
    End {
        /// Scattering events before the end.
        depth: u32,
        /// Reason for the end.
        why: End,
    },
}

/// Hit of a path with a surface. Vectors are in the coordinates of the built scene and point away from the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Scattering events before this vertex.
    pub depth: u32,
    /// Distance from the previous vertex, or from the camera (m).
    pub distance: f32,
    /// Shape and primitive that were hit.
    pub hit: Hit,
    /// Position (m).
    pub point: Vec3,
    /// Geometric normal.
    pub ng: Vec3,
    /// Shading normal.
    pub ns: Vec3,
    /// Direction towards the previous vertex or the camera.
    pub wo: Vec3,
    /// Name of the scattering model, as in scene files.
    pub model: &'static str,
    /// Throughput on arrival.
    pub beta: Spectrum,
}

/// Point of a medium at which a path is scattered. Vectors are in the coordinates of the built scene and point away from the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumVertex {
    /// Scattering events before this vertex.
    pub depth: u32,
    /// Distance from the previous vertex, or from the last boundary of a medium (m).
    pub distance: f32,
    /// Medium.
    pub medium: MediumId,
    /// Position (m).
    pub point: Vec3,
    /// Direction towards the previous vertex or the camera.
    pub wo: Vec3,
    /// Name of the phase function, as in scene files.
    pub phase: &'static str,
    /// Throughput on arrival, with the share of the light that is scattered.
    pub beta: Spectrum,
}

/// Light that is added to the radiance. The radiance of a camera sample is the sum of all `value`s in the order of the events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// Scattering events between emitter and camera: 0 emission seen directly, 1 direct light, more indirect light.
    pub depth: u32,
    /// Radiance added, with throughput and weight.
    pub value: Spectrum,
    /// Radiance before clamping.
    pub whole: Spectrum,
    /// Light and sampling technique it comes from.
    pub origin: Origin,
}

/// Light that a contribution comes from, and the technique that found it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// Index of the light among the lights; `None` for media.
    pub light: Option<u32>,
    /// Sampling technique.
    pub technique: Technique,
    /// Weight of multiple importance sampling; 1 where no other technique could have found the light.
    pub weight: f32,
}

/// Technique by which light is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Technique {
    /// The path hit the emitter, with the density of its last scattering.
    Emission,
    /// A light was sampled.
    Light {
        /// Direction towards the light.
        wi: Vec3,
        /// Density of that direction.
        density: Density,
    },
}

/// Scattering by which a path goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// Scattering events before this one.
    pub depth: u32,
    /// Direction in which the path goes on.
    pub wi: Vec3,
    /// ns · wi; 1 in media
    pub cos: f32,
    /// Reflection or transmission.
    pub lobe: Lobe,
    /// Density of `wi`.
    pub density: Density,
    /// f·|cos|, or the phase function [sr⁻¹]; 0 for delta lobes.
    pub value: Spectrum,
    /// f·|cos| / density
    pub weight: Spectrum,
    /// Probability with which Russian roulette continues the path.
    pub survival: f32,
}

/// Reason for the end of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The path left the scene.
    Escaped,
    /// The path reached the greatest allowed number of scattering events. This is a bias.
    DepthLimit,
    /// The sampled direction scatters no light.
    Absorbed,
    /// Russian roulette ended the path.
    Roulette,
    /// The method follows only mirrors and glass, and the surface is neither.
    NotFollowed,
}

/// Recorder that a walk is generic over. Events are built by closures, which run only if the events are recorded.
pub trait Recorder {
    /// Records an event.
    fn record(&mut self, event: impl FnOnce() -> Event);

    /// Records light that has scattered `depth` times, and returns the part of it that counts.
    fn light(&mut self, light: Spectrum, depth: u32, origin: impl FnOnce() -> Origin) -> Spectrum;
}

/// Recorder that does nothing and costs nothing.
pub struct NoRecorder;

impl Recorder for NoRecorder {
    #[inline(always)]
    fn record(&mut self, _: impl FnOnce() -> Event) {}

    #[inline(always)]
    fn light(&mut self, light: Spectrum, _: u32, _: impl FnOnce() -> Origin) -> Spectrum {
        light
    }
}

impl Recorder for dyn PathRecorder + '_ {
    fn record(&mut self, event: impl FnOnce() -> Event) {
        PathRecorder::record(self, event());
    }

    fn light(&mut self, light: Spectrum, depth: u32, origin: impl FnOnce() -> Origin) -> Spectrum {
        let value = self.clamp(light, depth);
        if !light.is_black() {
            PathRecorder::record(self, Event::Light(Contribution { depth, value, whole: light, origin: origin() }));
        }
        value
    }
}

/// Keeps every event.
impl PathRecorder for Vec<Event> {
    fn record(&mut self, event: Event) {
        self.push(event);
    }
}

impl Event {
    /// Event of a hit with a surface.
    pub fn vertex(depth: u32, ray: &Ray, hit: &Hit, surface: &Surface, beta: Spectrum) -> Event {
        let SurfacePoint { p: point, ng, ns, .. } = surface.point;
        let (distance, wo) = (ray.length(hit.t, ng), -ray.direction);
        Event::Vertex(Vertex { depth, distance, hit: *hit, point, ng, ns, wo, model: surface.bsdf.name(), beta })
    }

    /// Event of scattering in a medium.
    pub fn medium(depth: u32, distance: f32, medium: MediumId, point: &MediumPoint, wo: Vec3, beta: Spectrum) -> Event {
        Event::Medium(MediumVertex { depth, distance, medium, point: point.p, wo, phase: point.phase.name(), beta })
    }

    /// Event of scattering into a sampled direction.
    ///
    /// - `survival`: probability with which Russian roulette continues the path
    pub fn scattering<I: Interaction>(depth: u32, at: &I, wo: Vec3, (wi, sample): &(Vec3, BsdfSample), survival: f32) -> Event {
        let value = at.eval(wo, *wi, TransportMode::Radiance);
        let cos = at.normal().map_or(1.0, |normal| normal.dot(*wi));
        let BsdfSample { lobe, density, weight, .. } = *sample;
        Event::Scattering(Scattering { depth, wi: *wi, cos, lobe, density, value, weight, survival })
    }

    /// Event of scattering by a delta lobe, with its direction and weight.
    pub fn delta(depth: u32, surface: &Surface, wo: Vec3, &(wi, weight): &(Vec3, Spectrum)) -> Event {
        let (ng, cos) = (surface.point.ng, surface.point.ns.dot(wi));
        let lobe = if ng.dot(wo) * ng.dot(wi) > 0.0 { Lobe::Reflection } else { Lobe::Transmission };
        Event::Scattering(Scattering { depth, wi, cos, lobe, density: Density::Delta, value: Spectrum::BLACK, weight, survival: 1.0 })
    }

    /// Event of the end of a path.
    pub fn end(depth: u32, why: End) -> Event {
        Event::End { depth, why }
    }
}

impl Origin {
    /// Origin of light that a hit surface emits.
    pub fn emission(surface: &Surface, weight: f32) -> Origin {
        Origin { light: surface.emission.map(|_| surface.light), technique: Technique::Emission, weight }
    }

    /// Origin of light that arrives from infinitely far away.
    ///
    /// - `light`: index of the light
    pub fn background(light: u32, weight: f32) -> Origin {
        Origin { light: Some(light), technique: Technique::Emission, weight }
    }

    /// Origin of light that a medium emits.
    pub fn medium() -> Origin {
        Origin { light: None, technique: Technique::Emission, weight: 1.0 }
    }

    /// Origin of light found by sampling a light.
    pub fn light(sample: &LightSample, weight: f32) -> Origin {
        Origin { light: Some(sample.light), technique: Technique::Light { wi: sample.wi, density: sample.density }, weight }
    }
}
