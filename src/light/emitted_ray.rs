//! Rays that lights emit, for paths that start at the lights.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use crate::math::{AreaPdf, Density, Frame, Local, Ray, SolidAnglePdf, Spectrum, warp};
use crate::shape::SurfacePoint;

/// Ray that a light emits, with the densities of its start and of its direction.
///
/// Source: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), §8.2. Tests: emitted_flux_is_the_power,
/// emitted_rays_light_what_light_samples_light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmittedRay {
    /// The ray, off the surface of the light.
    pub ray: Ray,
    /// Point on the surface of the light; `None` for lights that are no surface.
    pub point: Option<SurfacePoint>,
    /// Radiance; intensity of a point or spot light [W·sr⁻¹]; irradiance on a plane perpendicular to parallel light [W·m⁻²].
    pub le: Spectrum,
    /// |cos θ| between the ray and the normal of the area that the start is sampled on.
    pub cos: f32,
    /// Density of the start on that area.
    pub position: Density<AreaPdf>,
    /// Density of the direction.
    pub direction: Density,
    /// Probability with which the light was chosen, which the densities do not include.
    pub probability: f32,
    /// Index of the light.
    pub light: u32,
}

impl EmittedRay {
    /// Whether the light is infinitely far away. The ray then starts outside of the scene.
    pub fn is_distant(&self) -> bool {
        self.point.is_none() && matches!(self.position, Density::Smooth(_))
    }

    /// Flux that the ray carries: le·|cos θ| / (p(position) p(direction) P(light))  (W)
    ///
    /// Its mean over all random numbers is the flux of all lights.
    pub fn flux(&self) -> Spectrum {
        let position = self.position.smooth().map_or(1.0, AreaPdf::get);
        let direction = self.direction.smooth().map_or(1.0, SolidAnglePdf::get);
        self.le * (self.cos / (position * direction)) / self.probability
    }
}

/// Densities with which a light emits a given ray, without the probability of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionDensity {
    /// Density of the start, as in [`EmittedRay::position`].
    pub position: Density<AreaPdf>,
    /// Density of the direction.
    pub direction: Density,
}

/// Chosen light, the scene that it lights, and the random numbers for its ray.
#[derive(Clone, Copy)]
pub(super) struct EmissionContext {
    /// Index of the light.
    pub light: u32,
    /// Probability of the choice.
    pub probability: f32,
    /// Centre and radius of the scene's bounding sphere (m).
    pub bounds: (Vec3, f32),
    /// Uniform numbers that choose the start.
    pub position: Vec2,
    /// Uniform numbers that choose the direction.
    pub direction: Vec2,
    /// Fraction of the shutter interval.
    pub time: f32,
}

impl EmissionContext {
    /// Ray from a position without extent.
    ///
    /// - `le`: intensity in the direction `w` [W·sr⁻¹]
    pub fn ray_from_position(&self, position: Vec3, w: Vec3, le: Spectrum, direction: SolidAnglePdf) -> Option<EmittedRay> {
        self.ray(Ray::new(position, w), le, Density::Delta, Density::Smooth(direction))
    }

    /// Ray from infinitely far away, which starts on a disk that covers the scene as seen along the ray.
    pub fn ray_from_infinity(&self, w: Vec3, le: Spectrum, direction: Density) -> Option<EmittedRay> {
        let (center, radius) = self.bounds;
        let offset = Frame::around(w).to_world(Local(warp::disk(self.position).extend(0.0)));
        let position = Density::Smooth(pdf_from_infinity(radius));
        self.ray(Ray::new(center + (offset - w) * radius, w), le, position, direction).filter(|_| radius > 0.0)
    }

    /// Ray along the normal of the area that its start is sampled on, and from no surface; `None` if it carries no light.
    fn ray(&self, ray: Ray, le: Spectrum, position: Density<AreaPdf>, direction: Density) -> Option<EmittedRay> {
        let EmissionContext { light, probability, .. } = *self;
        let ray = Ray { time: self.time, ..ray };
        (!le.is_black()).then_some(EmittedRay { ray, point: None, le, cos: 1.0, position, direction, probability, light })
    }
}

/// Density of the start of a ray from infinitely far away, for a scene with the given radius (m).
pub(super) fn pdf_from_infinity(radius: f32) -> AreaPdf {
    AreaPdf::new(1.0 / (PI * radius * radius))
}
