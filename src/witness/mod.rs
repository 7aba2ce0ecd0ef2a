//! Who goes along with a path and is told what happens on it.
//!
//! A walk is written once, over an [`Account`], and compiled twice: for [`Nobody`], which leaves nothing of it behind, and for a
//! [`Witness`], whoever that is. An estimator chooses between the two where it is asked for radiance:
//!
//! ```ignore
//! fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
//!     match cx.witness.take() {
//!         None => self.walk(camera, cx.sampler, &mut Nobody),
//!         Some(witness) => self.walk(camera, cx.sampler, witness),
//!     }
//! }
//! ```
//!
//! Tests: what is told adds up to the radiance, bit for bit; nobody costs no instruction and changes no picture.

mod clamp;
mod sorted;

use glam::Vec3;

use crate::bsdf::{BsdfSample, Lobe, TransportMode};
use crate::light::{LightSample, Lights};
use crate::math::{Density, Ray, Spectrum};
use crate::primitive::Hit;
use crate::scene::Surface;
use crate::shape::SurfacePoint;

pub use clamp::Clamp;
pub use sorted::Sorted;

/// Goes along with the paths of a camera sample.
pub trait Witness {
    /// What happened, in the order in which it did. Where a path branches, one branch is followed to its end and then the next.
    fn tell(&mut self, event: Event);

    /// What of some light counts: all of it, or else the picture is biased.
    ///
    /// - `light`: what is about to be added to the radiance
    /// - `depth`: scattering events between emitter and camera
    fn admit(&mut self, light: Spectrum, _depth: u32) -> Spectrum {
        light
    }
}

/// What a walk tells of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    Vertex(Vertex),
    Light(Contribution),
    Scattering(Scattering),
    End {
        /// Scattering events before.
        depth: u32,
        why: End,
    },
}

/// A surface is met. Vectors are in the coordinates of the built scene and point away from the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Scattering events before.
    pub depth: u32,
    /// From the vertex before, or from the camera (m).
    pub distance: f32,
    pub hit: Hit,
    pub point: Vec3,
    pub ng: Vec3,
    pub ns: Vec3,
    /// To where the path comes from.
    pub wo: Vec3,
    /// The scattering model, by the name that materials of scene files have.
    pub model: &'static str,
    /// The throughput on arrival.
    pub beta: Spectrum,
}

/// Light is added to the radiance. The radiance of a camera sample is the sum of all `value`s, in the order they are told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// Scattering events between emitter and camera: 0 emission seen directly, 1 direct light, more indirect light.
    pub depth: u32,
    /// Throughput and weight included.
    pub value: Spectrum,
    /// What it would have been, had all of it counted.
    pub whole: Spectrum,
    pub origin: Origin,
}

/// Whose light it is, and how it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// Its index among the lights.
    pub light: Option<u32>,
    pub technique: Technique,
    /// Against the other technique that could have found it; 1 where there is none.
    pub weight: f32,
}

/// How light is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Technique {
    /// The path met the emitter, by the density of its last scattering.
    Emission,
    /// A light was sampled: direction towards it, and its density.
    Light { wi: Vec3, density: Density },
}

/// The path goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// Scattering events before this one.
    pub depth: u32,
    pub wi: Vec3,
    /// ns · wi
    pub cos: f32,
    pub lobe: Lobe,
    pub density: Density,
    /// f·|cos| [sr⁻¹]; 0 for delta lobes.
    pub value: Spectrum,
    /// f·|cos| / density
    pub weight: Spectrum,
    /// The chance that Russian roulette lets it live.
    pub survival: f32,
}

/// Why a path is at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It left the scene.
    Escaped,
    /// It had as many scattering events as it may: a bias.
    DepthLimit,
    /// Nothing is scattered this way.
    Absorbed,
    Roulette,
    /// The method follows mirrors and glass alone.
    NotFollowed,
}

/// What a walk is written over: someone, or nobody. What is told is made only if someone listens.
pub trait Account {
    fn tell(&mut self, event: impl FnOnce() -> Event);

    /// What of `light` counts, which has scattered `depth` times.
    fn light(&mut self, light: Spectrum, depth: u32, origin: impl FnOnce() -> Origin) -> Spectrum;
}

/// No one goes along.
pub struct Nobody;

impl Account for Nobody {
    #[inline(always)]
    fn tell(&mut self, _: impl FnOnce() -> Event) {}

    #[inline(always)]
    fn light(&mut self, light: Spectrum, _: u32, _: impl FnOnce() -> Origin) -> Spectrum {
        light
    }
}

impl Account for dyn Witness + '_ {
    fn tell(&mut self, event: impl FnOnce() -> Event) {
        Witness::tell(self, event());
    }

    fn light(&mut self, light: Spectrum, depth: u32, origin: impl FnOnce() -> Origin) -> Spectrum {
        let value = self.admit(light, depth);
        if !light.is_black() {
            Witness::tell(self, Event::Light(Contribution { depth, value, whole: light, origin: origin() }));
        }
        value
    }
}

/// Remembers everything.
impl Witness for Vec<Event> {
    fn tell(&mut self, event: Event) {
        self.push(event);
    }
}

impl Event {
    pub fn vertex(depth: u32, ray: &Ray, hit: &Hit, surface: &Surface, beta: Spectrum) -> Event {
        let SurfacePoint { p: point, ng, ns, .. } = surface.point;
        let (distance, wo) = (ray.length(hit.t, ng), -ray.direction);
        Event::Vertex(Vertex { depth, distance, hit: *hit, point, ng, ns, wo, model: surface.bsdf.name(), beta })
    }

    /// - `survival`: the chance that Russian roulette lets the path live
    pub fn scattering(depth: u32, surface: &Surface, wo: Vec3, (wi, sample): &(Vec3, BsdfSample), survival: f32) -> Event {
        let value = surface.eval(wo, *wi, TransportMode::Radiance);
        let cos = surface.point.ns.dot(*wi);
        let BsdfSample { lobe, density, weight, .. } = *sample;
        Event::Scattering(Scattering { depth, wi: *wi, cos, lobe, density, value, weight, survival })
    }

    /// Into a single direction.
    pub fn delta(depth: u32, surface: &Surface, wo: Vec3, &(wi, weight): &(Vec3, Spectrum)) -> Event {
        let (ng, cos) = (surface.point.ng, surface.point.ns.dot(wi));
        let lobe = if ng.dot(wo) * ng.dot(wi) > 0.0 { Lobe::Reflection } else { Lobe::Transmission };
        Event::Scattering(Scattering { depth, wi, cos, lobe, density: Density::Delta, value: Spectrum::BLACK, weight, survival: 1.0 })
    }

    pub fn end(depth: u32, why: End) -> Event {
        Event::End { depth, why }
    }
}

impl Origin {
    /// Of a surface that was met.
    pub fn emission(surface: &Surface, weight: f32) -> Origin {
        Origin { light: surface.emission.map(|_| surface.light), technique: Technique::Emission, weight }
    }

    /// Of what lies behind everything.
    pub fn background(lights: &Lights, weight: f32) -> Origin {
        Origin { light: lights.environment(), technique: Technique::Emission, weight }
    }

    /// Of a light that was sampled.
    pub fn light(sample: &LightSample, weight: f32) -> Origin {
        Origin { light: Some(sample.light), technique: Technique::Light { wi: sample.wi, density: sample.density }, weight }
    }
}
