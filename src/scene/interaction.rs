//! What all points have in common where light is scattered: on surfaces and in media.

use glam::{Vec2, Vec3};

use super::{ROUNDING, Surface};
use crate::bsdf::{BsdfSample, Lobe, TransportMode};
use crate::light::{LightSampleContext, ShadowTarget};
use crate::math::{Density, Local, Ray, SolidAnglePdf, Spectrum};
use crate::medium::Phase;
use crate::shape::{SurfacePoint, offset_ray_origin};

/// Point where light is scattered. Directions are in world space and point away from the point.
pub trait Interaction {
    /// The point as lights are sampled for it.
    ///
    /// - `wo`: direction to the viewer
    fn light_context(&self, wo: Vec3, time: f32) -> LightSampleContext;

    /// Whether [`Interaction::eval`] is not 0 everywhere.
    fn has_smooth_lobe(&self) -> bool;

    /// f(wo, wi)·|cos θi|, or the phase function [sr⁻¹]; 0 for delta lobes.
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum;

    /// Density with which [`Interaction::sample`] returns `wi`, if it does.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> SolidAnglePdf;

    /// Samples a direction with uniform numbers; returns it in world space, and the sample.
    fn sample(&self, wo: Vec3, choice: f32, u: Vec2, mode: TransportMode) -> Option<(Vec3, BsdfSample)>;

    /// Shading normal; `None` where there is no surface.
    fn normal(&self) -> Option<Vec3>;

    /// Ray in the direction `wi`.
    fn spawn(&self, wi: Vec3, time: f32) -> Ray;

    /// Shadow ray to `target` in the direction `wi`.
    fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray;
}

impl Interaction for Surface<'_> {
    #[inline(always)]
    fn light_context(&self, wo: Vec3, time: f32) -> LightSampleContext {
        self.light_context(wo, time)
    }

    #[inline(always)]
    fn has_smooth_lobe(&self) -> bool {
        self.bsdf.has_smooth_lobe()
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        self.eval(wo, wi, mode)
    }

    #[inline(always)]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> SolidAnglePdf {
        self.pdf(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3, choice: f32, u: Vec2, mode: TransportMode) -> Option<(Vec3, BsdfSample)> {
        self.sample(wo, choice, u, mode)
    }

    #[inline(always)]
    fn normal(&self) -> Option<Vec3> {
        Some(self.frame.z)
    }

    #[inline(always)]
    fn spawn(&self, wi: Vec3, time: f32) -> Ray {
        self.spawn(wi, time)
    }

    #[inline(always)]
    fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray {
        self.shadow_ray(wi, target, time)
    }
}

/// Point of a medium where light is scattered.
#[derive(Clone, Copy, Debug)]
pub struct MediumPoint<'a> {
    /// Position (m).
    pub p: Vec3,
    /// Phase function of the medium.
    pub phase: &'a Phase,
}

impl Interaction for MediumPoint<'_> {
    fn light_context(&self, _wo: Vec3, time: f32) -> LightSampleContext {
        LightSampleContext { time, ..LightSampleContext::at(self.p) }
    }

    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn eval(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> Spectrum {
        Spectrum::gray(self.phase.eval(wo, wi))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> SolidAnglePdf {
        SolidAnglePdf::new(self.phase.eval(wo, wi))
    }

    fn sample(&self, wo: Vec3, choice: f32, u: Vec2, _mode: TransportMode) -> Option<(Vec3, BsdfSample)> {
        let wi = self.phase.sample(wo, choice, u);
        let density = Density::Smooth(self.pdf(wo, wi));
        Some((wi, BsdfSample { wi: Local(wi), weight: Spectrum::ONE, density, lobe: Lobe::Medium, eta: 1.0 }))
    }

    fn normal(&self) -> Option<Vec3> {
        None
    }

    fn spawn(&self, wi: Vec3, time: f32) -> Ray {
        Ray { time, ..Ray::new(self.p, wi) }
    }

    fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray {
        shadow_ray([self.p; 2], wi, target, time)
    }
}

/// Shadow ray to `target` in the direction `wi`.
///
/// - `from`, `origin`: point that the ray leaves, and its origin off that point
// Always inlined: otherwise the compiler would keep it out of line in `integrator::sample_light`.
#[inline(always)]
pub(super) fn shadow_ray([from, origin]: [Vec3; 2], wi: Vec3, target: &ShadowTarget, time: f32) -> Ray {
    let end = match target {
        ShadowTarget::Infinity => return Ray { origin, from, direction: wi, t_max: f32::INFINITY, time },
        ShadowTarget::Point(end) => *end,
        // The rounding of the direction moves the far end of the ray: end that much farther off the light, whose own offset covers
        // only the rounding of its own coordinates.
        ShadowTarget::Surface(point) => {
            // The sum of the coordinates is an upper bound of the length.
            let deviation = ROUNDING * (point.p - origin).abs().element_sum();
            offset_ray_origin(&SurfacePoint { offset: point.offset + deviation, ..*point }, -wi)
        }
    };
    ray_to(end, [from, origin], time)
}

/// Ray to a point, which ends before it.
///
/// - `from`, `origin`: point that the ray leaves, and its origin off that point
#[inline(always)]
fn ray_to(end: Vec3, [from, origin]: [Vec3; 2], time: f32) -> Ray {
    let line = end - origin;
    let distance = line.length();
    // t of a hit is rounded a few times: stop short of the end by that much.
    let t_max = distance * (1.0 - ROUNDING);
    Ray { origin, from, direction: line / distance, t_max, time }
}
