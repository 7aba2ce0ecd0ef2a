//! Surfaces that emit.

use std::f64::consts::PI;

use glam::{Vec2, Vec3};

use super::{Offer, Target};
use crate::math::{Density, Spectrum};
use crate::shape::{Shape, SurfacePoint};

/// Diffuse emission: the same radiance at every angle  [W·m⁻²·sr⁻¹].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    pub radiance: Spectrum,
    /// Else from the side of the normal alone.
    pub two_sided: bool,
}

impl Emission {
    pub fn new(radiance: Spectrum) -> Emission {
        Emission { radiance, two_sided: false }
    }

    /// Radiance that leaves a surface with normal `ng` into `w`.
    pub fn towards(&self, ng: Vec3, w: Vec3) -> Spectrum {
        if self.two_sided || ng.dot(w) > 0.0 { self.radiance } else { Spectrum::BLACK }
    }
}

/// One emitting primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub shape: u32,
    pub primitive: u32,
    pub emission: Emission,
}

impl Area {
    pub(super) fn sample(&self, shapes: &[Box<dyn Shape>], from: Vec3, u: Vec2) -> Option<Offer> {
        let (point, pdf) = shapes[self.shape as usize].sample_from(self.primitive, from, u)?;
        let wi = towards(from, &point)?;
        let li = self.emission.towards(point.ng, -wi);
        (!li.is_black()).then_some(Offer { wi, li, density: Density::Smooth(pdf), target: Target::Surface(point) })
    }

    /// Whether it emits and cannot be sampled: paths meet it by chance.
    pub(super) fn is_found(&self, shapes: &[Box<dyn Shape>]) -> bool {
        !shapes[self.shape as usize].is_sampled() && !self.emission.radiance.is_black()
    }

    /// Φ = π A L, on each side that emits.
    pub(super) fn power(&self, shapes: &[Box<dyn Shape>]) -> f64 {
        let sides = if self.emission.two_sided { 2.0 } else { 1.0 };
        sides * PI * f64::from(shapes[self.shape as usize].area(self.primitive)) * f64::from(self.emission.radiance.average())
    }
}

fn towards(from: Vec3, point: &SurfacePoint) -> Option<Vec3> {
    (point.p - from).try_normalize()
}
