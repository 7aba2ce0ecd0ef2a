//! Spotlights.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::bounds::LightBounds;
use super::emitted_ray::EmissionContext;
use super::point::direction_and_square;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{Aabb, Density, Frame, Local, Rgb, SolidAnglePdf, Spectrum, float, warp};

/// Point light with full intensity within an inner cone, none beyond an outer cone, and a [`Falloff`] between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Position (m).
    pub position: DVec3,
    /// Unit axis of the cones, pointing away from the light.
    pub axis: Vec3,
    /// Intensity on the axis [W·sr⁻¹].
    pub intensity: Rgb,
    /// Cosine of the inner cone, in f64 because the cosines of narrow cones differ from 1 by less than an f32 resolves.
    pub cos_inner: f64,
    /// Cosine of the outer cone: below `cos_inner`, or equal to it for a hard edge.
    pub cos_outer: f64,
    /// Shape of the falloff between the cones.
    pub falloff: Falloff,
}

/// Falloff from 1 at the inner cone to 0 at the outer cone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// s²(3 − 2s), with s linear in the cosine.
    #[default]
    Smooth,
    /// Linear in the angle.
    Linear,
    /// s², with s linear in the cosine, as glTF recommends.
    Squared,
}

impl Spot {
    pub(super) fn sample(&self, from: Vec3) -> Option<LightLiSample> {
        let (wi, d2) = direction_and_square(from, self.position.as_vec3())?;
        let li = Spectrum::from_illuminant(self.intensity) * (self.falloff(-wi) / d2);
        (!li.is_black()).then_some(LightLiSample { wi, li, density: Density::Delta, target: ShadowTarget::Point(self.position.as_vec3()) })
    }

    /// A ray in a uniformly distributed direction within the outer cone.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        self.emit_within(self.cos_outer, cx)
    }

    /// A ray in a uniformly distributed direction within a cone around the axis.
    ///
    /// - `cos_outer`: cosine of half the angle of the cone
    pub(super) fn emit_within(&self, cos_outer: f64, cx: &EmissionContext) -> Option<EmittedRay> {
        let opening = (1.0 - cos_outer) as f32;
        let w = Frame::around(self.axis).to_world(Local(warp::uniform_cone(cx.direction, opening))).normalize();
        let pdf = SolidAnglePdf::new(warp::uniform_cone_pdf(opening));
        cx.ray_from_position(self.position.as_vec3(), w, Spectrum::from_illuminant(self.intensity) * self.falloff(w), pdf)
    }

    /// Density of an emitted direction: uniform within the outer cone.
    pub(super) fn emission_pdf(&self, w: Vec3) -> SolidAnglePdf {
        self.emission_pdf_within(self.cos_outer, w)
    }

    /// Density of a direction that [`Spot::emit_within`] samples.
    pub(super) fn emission_pdf_within(&self, cos_outer: f64, w: Vec3) -> SolidAnglePdf {
        let is_inside = self.cos(w) > cos_outer;
        if is_inside { SolidAnglePdf::new(warp::uniform_cone_pdf((1.0 - cos_outer) as f32)) } else { SolidAnglePdf::ZERO }
    }

    /// cos ∠(axis, w) = 1 − |axis − w|²/2 for unit vectors.
    fn cos(&self, w: Vec3) -> f64 {
        1.0 - 0.5 * (self.axis.as_dvec3() - w.as_dvec3()).length_squared()
    }

    /// Relative intensity in the direction w.
    fn falloff(&self, w: Vec3) -> f32 {
        let cos = self.cos(w);
        if cos >= self.cos_inner {
            return 1.0;
        }
        if cos <= self.cos_outer {
            return 0.0;
        }
        let s = (cos - self.cos_outer) / (self.cos_inner - self.cos_outer);
        match self.falloff {
            Falloff::Smooth => (s * s * (3.0 - 2.0 * s)) as f32,
            Falloff::Squared => (s * s) as f32,
            Falloff::Linear => {
                let [inner, here, outer] = [self.cos_inner, cos, self.cos_outer].map(float::acos_f64);
                ((outer - here) / (outer - inner)) as f32
            }
        }
    }

    /// Bounds for the choice of the light.
    pub(super) fn bounds(&self) -> LightBounds {
        self.bounds_within(self.cos_outer, 1.0)
    }

    /// Bounds for the choice of a light that emits within a cone around the axis, with a share of the intensity.
    ///
    /// - `cos_outer`: cosine of half the angle of the cone
    pub(super) fn bounds_within(&self, cos_outer: f64, share: f64) -> LightBounds {
        LightBounds::cone(Aabb::around([self.position.as_vec3()]), self.axis.as_dvec3(), cos_outer, self.peak() * share)
    }

    /// Intensity on the axis, the mean of the colour components [W·sr⁻¹].
    pub(super) fn peak(&self) -> f64 {
        f64::from(Spectrum::from_illuminant(self.intensity).average())
    }

    /// Flux Φ ≈ 2π I (1 − (cos inner + cos outer)/2), as if the mean of the falloff were ½ (W).
    pub(super) fn power(&self) -> f64 {
        TAU * self.peak() * (1.0 - 0.5 * (self.cos_inner + self.cos_outer))
    }
}
