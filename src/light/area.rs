//! Area lights.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::bounds::LightBounds;
use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{AreaPdf, Density, Frame, Local, Ray, Rgb, SolidAnglePdf, Spectrum, warp};
use crate::shape::{Shape, SurfacePoint, offset_ray_origin};
use crate::texture::{Texture, TextureContext};

/// Diffuse emission of a point, with the same radiance in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Radiance [W·m⁻²·sr⁻¹].
    pub radiance: Spectrum,
    /// Whether both sides emit, not only the side of the normal.
    pub two_sided: bool,
}

impl Emission {
    /// Radiance that a surface with normal `ng` emits in the direction `w`.
    pub fn towards(&self, ng: Vec3, w: Vec3) -> Spectrum {
        if self.two_sided || ng.dot(w) > 0.0 { self.radiance } else { Spectrum::BLACK }
    }
}

/// Settings of the emission of a shape, optionally multiplied by a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitter {
    /// Radiance [W·m⁻²·sr⁻¹], or its value where the texture is 1.
    pub radiance: Rgb,
    /// Whether both sides emit, not only the side of the normal.
    pub two_sided: bool,
    /// Factor that varies over the surface.
    pub texture: Option<Arc<Texture>>,
}

impl Emitter {
    /// Emission of one side, the same everywhere.
    pub fn new(radiance: Rgb) -> Emitter {
        Emitter { radiance, two_sided: false, texture: None }
    }

    /// Emission at a point.
    pub fn at(&self, at: &TextureContext) -> Emission {
        let (whole, two_sided) = (Spectrum::from_illuminant(self.radiance), self.two_sided);
        match &self.texture {
            None => Emission { radiance: whole, two_sided },
            Some(texture) => Emission { radiance: whole * Spectrum::from_coefficients(texture.at(at)), two_sided },
        }
    }

    /// The emitter in coordinates shifted by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Emitter {
        Emitter { texture: self.texture.map(|texture| Arc::new(Texture::clone(&texture).recentred(origin))), ..self }
    }
}

/// Area light: one emitting primitive of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Index of the shape.
    pub shape: u32,
    /// Index of the primitive within the shape.
    pub primitive: u32,
    /// Emission of the primitive.
    pub emitter: Emitter,
}

/// Number of texture lookups along each side of a primitive, for the estimate of its power.
const LOOKUPS: u32 = 4;

/// Least power of a textured primitive, as a fraction of its power with a white texture. The power is estimated from a few points
/// and must not be 0 where the primitive may emit.
const MIN_POWER: f32 = 1.0 / 1024.0;

impl Area {
    #[inline]
    pub(super) fn sample(&self, shapes: &[Box<dyn Shape>], from: Vec3, u: Vec2) -> Option<LightLiSample> {
        let (point, pdf) = shapes[self.shape as usize].sample_from(self.primitive, from, u)?;
        let wi = towards(from, &point)?;
        let li = self.emitter.at(&TextureContext::exact(&point)).towards(point.ng, -wi);
        (!li.is_black()).then_some(LightLiSample { wi, li, density: Density::Smooth(pdf), target: ShadowTarget::Surface(point) })
    }

    /// A ray in a direction around the normal, with a density proportional to the cosine. A two-sided emitter chooses the side first.
    pub(super) fn emit(&self, shapes: &[Box<dyn Shape>], cx: &EmissionContext) -> Option<EmittedRay> {
        let shape = &shapes[self.shape as usize];
        if !shape.is_sampled() {
            return None;
        }
        let (point, pdf) = shape.sample_area(self.primitive, cx.position);
        let (side, share, x) = match self.emitter.two_sided {
            true if cx.direction.x < 0.5 => (1.0, 0.5, 2.0 * cx.direction.x),
            true => (-1.0, 0.5, 2.0 * cx.direction.x - 1.0),
            false => (1.0, 1.0, cx.direction.x),
        };
        let local = warp::cosine_hemisphere(Vec2::new(x, cx.direction.y));
        let w = Frame::around(point.ng * side).to_world(Local(local)).normalize();
        let le = self.emitter.at(&TextureContext::exact(&point)).towards(point.ng, w);
        let ray = Ray { from: point.p, time: cx.time, ..Ray::new(offset_ray_origin(&point, w), w) };
        let direction = Density::Smooth(SolidAnglePdf::new(share * warp::cosine_hemisphere_pdf(local)));
        let (position, &EmissionContext { light, probability, .. }) = (Density::Smooth(pdf), cx);
        let ray = EmittedRay { ray, point: Some(point), le, cos: local.z, position, direction, probability, light };
        (!le.is_black() && local.z > 0.0).then_some(ray)
    }

    /// Densities of a given ray that starts at `point`, for a two-sided emitter with the probability ½ of the side.
    pub(super) fn emission_density(&self, shapes: &[Box<dyn Shape>], point: Option<&SurfacePoint>, w: Vec3) -> (Density<AreaPdf>, Density) {
        let Some(point) = point else { return (Density::Smooth(AreaPdf::new(0.0)), Density::Smooth(SolidAnglePdf::ZERO)) };
        let cos = point.ng.dot(w);
        let share = match self.emitter.two_sided {
            true => 0.5,
            false if cos > 0.0 => 1.0,
            false => 0.0,
        };
        let local = Vec3::Z * cos.abs();
        let direction = SolidAnglePdf::new(share * warp::cosine_hemisphere_pdf(local));
        (Density::Smooth(shapes[self.shape as usize].area_pdf(self.primitive, point)), Density::Smooth(direction))
    }

    /// Whether the primitive emits and cannot be sampled, so that paths hit it only by chance.
    pub(super) fn is_unsampled(&self, shapes: &[Box<dyn Shape>]) -> bool {
        !shapes[self.shape as usize].is_sampled() && !self.emitter.radiance.is_black()
    }

    /// Bounds for the choice of the light. The intensity of a flat surface is A L along its normal. That of a closed surface is A L / 4 in
    /// the mean over all directions, because max(0, cos θ) is ¼ in the mean.
    pub(super) fn bounds(&self, shapes: &[Box<dyn Shape>]) -> LightBounds {
        let shape = &shapes[self.shape as usize];
        let (space, two_sided) = (shape.bounds(self.primitive), self.emitter.two_sided);
        let of_a_side = self.power(shapes) / if two_sided { 2.0 * PI } else { PI };
        if shape.is_flat(self.primitive) {
            let normal = shape.sample_area(self.primitive, Vec2::splat(0.5)).0.ng.as_dvec3();
            LightBounds::flat(space, normal, two_sided, of_a_side)
        } else {
            LightBounds::all_directions(space, 0.25 * of_a_side)
        }
    }

    /// Flux Φ = π A L of each side that emits, with the mean of the texture at a few points (W).
    pub(super) fn power(&self, shapes: &[Box<dyn Shape>]) -> f64 {
        let shape = &shapes[self.shape as usize];
        let radiance = Spectrum::from_illuminant(self.emitter.radiance);
        let sides = if self.emitter.two_sided { 2.0 } else { 1.0 };
        let seen = if self.emitter.texture.is_none() { radiance } else { radiance * MIN_POWER + self.mean(shape.as_ref()) };
        sides * PI * f64::from(shape.area(self.primitive)) * f64::from(seen.average())
    }

    /// Mean of the emitted radiance at a grid of points.
    fn mean(&self, shape: &dyn Shape) -> Spectrum {
        let middle = |k: u32| (k as f32 + 0.5) / LOOKUPS as f32;
        let points = (0..LOOKUPS * LOOKUPS).map(|k| Vec2::new(middle(k % LOOKUPS), middle(k / LOOKUPS)));
        let seen = points.map(|u| self.emitter.at(&TextureContext::exact(&shape.sample_area(self.primitive, u).0)).radiance);
        seen.fold(Spectrum::BLACK, |sum, radiance| sum + radiance) / (LOOKUPS * LOOKUPS) as f32
    }
}

/// Least squared distance whose digits are all there in an f32 (m²).
pub(crate) const MIN_SQUARE: f32 = f32::MIN_POSITIVE / f32::EPSILON;

/// Unit direction to a point; `None` if it is `from` itself.
fn towards(from: Vec3, point: &SurfacePoint) -> Option<Vec3> {
    let line = point.p - from;
    if line.length_squared() >= MIN_SQUARE { line.try_normalize() } else { line.as_dvec3().try_normalize().map(|w| w.as_vec3()) }
}
