//! Area lights.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::bounds::LightBounds;
use super::emission_distribution::EmissionDistribution;
use super::emitted_ray::EmissionContext;
use super::emitter::Emitter;
use super::{EmittedRay, EmitterMotion, Light, LightLiSample, LightSampleContext, ShadowTarget};
use crate::math::{AreaPdf, Density, Frame, Local, Ray, SolidAnglePdf, Spectrum, warp};
use crate::shape::{Shape, SurfacePoint, offset_ray_origin};
use crate::texture::TextureContext;

/// Area light: one emitting primitive of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Index of the shape.
    pub shape: u32,
    /// Index of the primitive within the shape.
    pub primitive: u32,
    /// Emission of the primitive.
    pub emitter: Emitter,
    /// Where on the primitive its light comes from; `None` without a texture and before the light is part of a scene.
    distribution: Option<Arc<EmissionDistribution>>,
    /// Motion of the shape, which is at rest in its own space; `None` if it does not move.
    motion: Option<Arc<EmitterMotion>>,
}

/// Number of texture lookups for all lights of a scene together, which bounds the time to load it.
const LOOKUPS: usize = 1 << 21;

/// Least power of a textured primitive, as a fraction of its power with a white texture. The power is estimated from some points
/// and must not be 0 where the primitive may emit.
const MIN_POWER: f32 = 1.0 / 1024.0;

/// Finds out for each light with a texture where on its primitive the light comes from.
pub(super) fn distributed(mut lights: Vec<Light>, shapes: &[Box<dyn Shape>]) -> Vec<Light> {
    let is_textured = |light: &Light| matches!(light, Light::Area(area) if area.emitter.texture.is_some());
    let count = lights.iter().filter(|light| is_textured(light)).count();
    let lookups = (LOOKUPS / count.max(1)) as u32;
    lights.par_iter_mut().filter(|light| is_textured(light)).for_each(|light| {
        if let Light::Area(area) = light {
            area.distribute(&*shapes[area.shape as usize], lookups);
        }
    });
    lights
}

impl Area {
    /// The light of a primitive.
    ///
    /// - `shape`: index of the shape
    /// - `primitive`: index of the primitive within the shape
    pub fn new(shape: u32, primitive: u32, emitter: Emitter) -> Area {
        Area { shape, primitive, emitter, distribution: None, motion: None }
    }

    fn distribute(&mut self, shape: &dyn Shape, lookups: u32) {
        if shape.is_sampled() {
            self.distribution = Some(Arc::new(EmissionDistribution::new(shape, self.primitive, &self.emitter, lookups)));
        }
    }

    /// The light of a primitive that moves.
    pub(crate) fn moving(self, motion: Option<Arc<EmitterMotion>>) -> Area {
        Area { motion, ..self }
    }

    #[inline]
    pub(super) fn sample(&self, shapes: &[Box<dyn Shape>], cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        let shape = &*shapes[self.shape as usize];
        let (point, pdf) = match &self.motion {
            None => self.sample_at_rest(shape, cx.p, u)?,
            Some(motion) => {
                let moment = motion.at(cx.time);
                let (point, pdf) = self.sample_at_rest(shape, moment.to_local(cx.p), u)?;
                let point = moment.place(&point);
                (point, moment.by_solid_angle(pdf, towards(cx.p, &point)?))
            }
        };
        let wi = towards(cx.p, &point)?;
        let li = self.emitter.at(&TextureContext::exact(&point)).towards(point.ng, -wi);
        (!li.is_black()).then_some(LightLiSample { wi, li, density: Density::Smooth(pdf), target: ShadowTarget::Surface(point) })
    }

    /// Samples a point for the point `from`, both in the space of the shape, with its density by solid angle. It has texture coordinates only
    /// if the emission depends on them.
    #[inline]
    fn sample_at_rest(&self, shape: &dyn Shape, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        let (mut point, pdf) = match &self.distribution {
            None => shape.sample_from(self.primitive, from, u)?,
            Some(distribution) => distribution.sample_from(shape, self.primitive, from, u)?,
        };
        if self.emitter.texture.is_some() {
            point.uv = shape.texture_coordinates(self.primitive, &point);
        }
        Some((point, pdf))
    }

    /// Density by solid angle with which [`Area::sample`] samples `point` for the point of `cx`.
    #[inline]
    pub(super) fn pdf_from(&self, shapes: &[Box<dyn Shape>], cx: &LightSampleContext, point: &SurfacePoint) -> SolidAnglePdf {
        let at_rest = |from: Vec3, point: &SurfacePoint| {
            let shape = &*shapes[self.shape as usize];
            match &self.distribution {
                None => shape.pdf_from(self.primitive, from, point),
                Some(distribution) => distribution.pdf_from(shape, self.primitive, from, point),
            }
        };
        let Some(motion) = &self.motion else { return at_rest(cx.p, point) };
        let moment = motion.at(cx.time);
        let pdf = at_rest(moment.to_local(cx.p), &moment.point_to_local(point));
        towards(cx.p, point).map_or(SolidAnglePdf::ZERO, |wi| moment.by_solid_angle(pdf, wi))
    }

    /// A point of the surface at a time, if points of it can be sampled.
    pub(super) fn place(&self, shapes: &[Box<dyn Shape>], u: Vec2, time: f32) -> Option<Vec3> {
        let shape = &shapes[self.shape as usize];
        let point = shape.is_sampled().then(|| shape.sample_area(self.primitive, u).0)?;
        Some(self.motion.as_ref().map_or(point, |motion| motion.at(time).place(&point)).p)
    }

    /// A ray in a direction around the normal, with a density proportional to the cosine. A two-sided emitter chooses the side first.
    pub(super) fn emit(&self, shapes: &[Box<dyn Shape>], cx: &EmissionContext) -> Option<EmittedRay> {
        let shape = &*shapes[self.shape as usize];
        if !shape.is_sampled() {
            return None;
        }
        let (point, pdf) = match &self.distribution {
            None => shape.sample_area(self.primitive, cx.position),
            Some(distribution) => distribution.sample_area(shape, self.primitive, cx.position),
        };
        let (point, pdf) = match &self.motion {
            None => (point, pdf),
            Some(motion) => {
                let moment = motion.at(cx.time);
                (moment.place(&point), moment.by_area(pdf, point.ng))
            }
        };
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
    pub(super) fn emission_density(
        &self,
        shapes: &[Box<dyn Shape>],
        point: Option<&SurfacePoint>,
        w: Vec3,
        time: f32,
    ) -> (Density<AreaPdf>, Density) {
        let Some(point) = point else { return (Density::Smooth(AreaPdf::new(0.0)), Density::Smooth(SolidAnglePdf::ZERO)) };
        let cos = point.ng.dot(w);
        let share = match self.emitter.two_sided {
            true => 0.5,
            false if cos > 0.0 => 1.0,
            false => 0.0,
        };
        let local = Vec3::Z * cos.abs();
        let direction = SolidAnglePdf::new(share * warp::cosine_hemisphere_pdf(local));
        let at_rest = |point: &SurfacePoint| {
            let shape = &*shapes[self.shape as usize];
            match &self.distribution {
                None => shape.area_pdf(self.primitive, point),
                Some(distribution) => distribution.area_pdf(shape, self.primitive, point),
            }
        };
        let position = self.motion.as_ref().map_or_else(
            || at_rest(point),
            |motion| {
                let moment = motion.at(time);
                let local = moment.point_to_local(point);
                moment.by_area(at_rest(&local), local.ng)
            },
        );
        (Density::Smooth(position), Density::Smooth(direction))
    }

    /// Whether the primitive emits and cannot be sampled, so that paths hit it only by chance.
    pub(super) fn is_unsampled(&self, shapes: &[Box<dyn Shape>]) -> bool {
        !shapes[self.shape as usize].is_sampled() && !self.emitter.radiance.is_black()
    }

    /// Bounds for the choice of the light. The intensity of a flat surface is A L along its normal, and that of a surface with similar
    /// normals at most that along their mean. That of a surface with any normals is A L / 4 in the mean over all directions, because
    /// max(0, cos θ) is ¼ in the mean.
    pub(super) fn bounds(&self, shapes: &[Box<dyn Shape>]) -> LightBounds {
        let shape = &shapes[self.shape as usize];
        let (space, two_sided) = (shape.bounds(self.primitive), self.emitter.two_sided);
        let of_a_side = self.power(shapes) / if two_sided { 2.0 * PI } else { PI };
        // What moves may also turn.
        if let Some(motion) = &self.motion {
            return LightBounds::all_directions(motion.bounds(&space), 0.5 * of_a_side);
        }
        if shape.is_flat(self.primitive) {
            let normal = shape.sample_area(self.primitive, Vec2::splat(0.5)).0.ng.as_dvec3();
            LightBounds::flat(space, normal, two_sided, of_a_side)
        } else if let Some((axis, angle)) = shape.normal_cone(self.primitive) {
            LightBounds::around(space, axis, angle, two_sided, of_a_side)
        } else {
            LightBounds::all_directions(space, 0.25 * of_a_side)
        }
    }

    /// Flux Φ = π A L of each side that emits (W).
    pub(super) fn power(&self, shapes: &[Box<dyn Shape>]) -> f64 {
        let whole = Spectrum::from_illuminant(self.emitter.radiance).average();
        let sides = if self.emitter.two_sided { 2.0 } else { 1.0 };
        let mean = self.distribution.as_ref().map_or(whole, |distribution| whole * MIN_POWER + distribution.mean);
        let shape = &shapes[self.shape as usize];
        let normal = || shape.is_flat(self.primitive).then(|| shape.sample_area(self.primitive, Vec2::splat(0.5)).0.ng);
        let growth = self.motion.as_ref().map_or(1.0, |motion| motion.growth(normal()));
        sides * PI * f64::from(shape.area(self.primitive)) * f64::from(mean) * growth
    }
}

/// Least squared distance whose digits are all there in an f32 (m²).
pub(crate) const MIN_SQUARE: f32 = f32::MIN_POSITIVE / f32::EPSILON;

/// Unit direction to a point; `None` if it is `from` itself.
fn towards(from: Vec3, point: &SurfacePoint) -> Option<Vec3> {
    let line = point.p - from;
    if line.length_squared() >= MIN_SQUARE { line.try_normalize() } else { line.as_dvec3().try_normalize().map(|w| w.as_vec3()) }
}
