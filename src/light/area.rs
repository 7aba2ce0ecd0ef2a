//! Surfaces that emit.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::{Offer, Target};
use crate::math::{Density, Spectrum};
use crate::shape::{Shape, SurfacePoint};
use crate::texture::Texture;

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

/// What a shape emits all over: the same everywhere, or that times a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitter {
    pub emission: Emission,
    pub texture: Option<Arc<Texture>>,
}

impl From<Emission> for Emitter {
    fn from(emission: Emission) -> Emitter {
        Emitter { emission, texture: None }
    }
}

impl Emitter {
    pub fn at(&self, point: &SurfacePoint) -> Emission {
        match &self.texture {
            None => self.emission,
            Some(texture) => Emission { radiance: self.emission.radiance * texture.at(point), ..self.emission },
        }
    }

    /// The same after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Emitter {
        Emitter { texture: self.texture.map(|texture| Arc::new(Texture::clone(&texture).recentred(origin))), ..self }
    }
}

/// One emitting primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    pub shape: u32,
    pub primitive: u32,
    pub emitter: Emitter,
}

/// Where a texture is asked how bright it is, along each side of a primitive.
const LOOKS: u32 = 4;

/// Of what it would be if white: what a textured primitive's power is said to be at least. It is a guess from a few points, and must
/// not be nothing where something may shine.
const LEAST_POWER: f32 = 1.0 / 1024.0;

impl Area {
    pub(super) fn sample(&self, shapes: &[Box<dyn Shape>], from: Vec3, u: Vec2) -> Option<Offer> {
        let (point, pdf) = shapes[self.shape as usize].sample_from(self.primitive, from, u)?;
        let wi = towards(from, &point)?;
        let li = self.emitter.at(&point).towards(point.ng, -wi);
        (!li.is_black()).then_some(Offer { wi, li, density: Density::Smooth(pdf), target: Target::Surface(point) })
    }

    /// Whether it emits and cannot be sampled: paths meet it by chance.
    pub(super) fn is_found(&self, shapes: &[Box<dyn Shape>]) -> bool {
        !shapes[self.shape as usize].is_sampled() && !self.emitter.emission.radiance.is_black()
    }

    /// Φ = π A L, on each side that emits; with the mean of a texture at a few points.
    pub(super) fn power(&self, shapes: &[Box<dyn Shape>]) -> f64 {
        let shape = &shapes[self.shape as usize];
        let Emission { radiance, two_sided } = self.emitter.emission;
        let sides = if two_sided { 2.0 } else { 1.0 };
        let seen = if self.emitter.texture.is_none() { radiance } else { radiance * LEAST_POWER + self.mean(shape.as_ref()) };
        sides * PI * f64::from(shape.area(self.primitive)) * f64::from(seen.average())
    }

    fn mean(&self, shape: &dyn Shape) -> Spectrum {
        let middle = |k: u32| (k as f32 + 0.5) / LOOKS as f32;
        let looks = (0..LOOKS * LOOKS).map(|k| Vec2::new(middle(k % LOOKS), middle(k / LOOKS)));
        let seen = looks.map(|u| self.emitter.at(&shape.sample_area(self.primitive, u).0).radiance);
        seen.fold(Spectrum::BLACK, |sum, radiance| sum + radiance) / (LOOKS * LOOKS) as f32
    }
}

fn towards(from: Vec3, point: &SurfacePoint) -> Option<Vec3> {
    (point.p - from).try_normalize()
}
