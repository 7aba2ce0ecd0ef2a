//! Distance fields in world space.

use glam::{DAffine3, DVec3, Vec2, Vec3};

use super::march::{Fixed, Line, March};
use super::space::around;
use super::{Dual, Sdf};
use crate::math::transform::greatest_stretch;
use crate::math::{Aabb, AreaPdf, Ray, SolidAnglePdf, Transform};
use crate::shape::{Facet, Shape, ShapeHit, SurfacePoint, VertexColor, offset_bound, unit_change};

/// Solid in world space.
///
/// Rays are transformed to the space of the field in f64 and keep the t of world space. |d| is a bound of distances in the space of the
/// field, whatever the transform.
///
/// The `uv` of a hit is (index of the part, 0).
pub struct Solid {
    sdf: Sdf,
    to_world: Transform,
    to_object: DAffine3,
    /// Bounding box within which rays are marched, in the space of the field.
    extent: [DVec3; 2],
    bounds: Aabb,
    /// Half an ulp of the greatest coordinate, the rounding error of a point in f32 (m): in world space.
    rounding: f64,
    /// Length of `rounding` in the space of the field.
    floor: f64,
}

impl Solid {
    /// A solid whose extent is finite along every axis.
    pub fn new(sdf: Sdf, to_world: &Transform) -> Solid {
        let extent = sdf.extent();
        let [low, high] = around(extent, to_world);
        let rounding = 0.5 * f64::from(f32::EPSILON) * low.abs().max(high.abs()).max_element();
        let bounds = Aabb { min: (low - 4.0 * rounding).as_vec3(), max: (high + 4.0 * rounding).as_vec3() };
        let floor = rounding / greatest_stretch(to_world.matrix().matrix3);
        Solid { sdf, to_world: *to_world, to_object: to_world.inverse().matrix(), extent, bounds, rounding, floor }
    }

    /// Segment of a ray within the bounding box.
    fn line(&self, ray: &Ray) -> Option<Line> {
        let origin = self.to_object.transform_point3(ray.origin.as_dvec3());
        let direction = self.to_object.transform_vector3(ray.direction.as_dvec3());
        let [low, high] = self.extent;
        let (mut from, mut to) = (0f64, f64::from(ray.t_max));
        for axis in 0..3 {
            let (a, b) = ((low[axis] - origin[axis]) / direction[axis], (high[axis] - origin[axis]) / direction[axis]);
            if direction[axis] == 0.0 {
                let is_outside = origin[axis] < low[axis] || origin[axis] > high[axis];
                to = if is_outside { f64::NEG_INFINITY } else { to };
            } else {
                // The slack covers surfaces that lie in a side of the box.
                let slack = self.floor / direction[axis].abs();
                (from, to) = (from.max(a.min(b) - slack), to.min(a.max(b) + slack));
            }
        }
        (from <= to && to.is_finite() && origin.is_finite() && direction.is_finite()).then_some(Line { origin, direction, from, to })
    }

    /// Moves a point to the surface along the gradient, and returns it with the remaining distance and the gradient.
    fn project(&self, mut p: DVec3) -> (DVec3, Dual) {
        let mut here = self.sdf.distance(Dual::coordinates(p));
        for _ in 0..2 {
            let square = here.gradient.length_squared();
            if here.value == 0.0 || square == 0.0 {
                break;
            }
            p -= here.gradient * (here.value / square);
            here = self.sdf.distance(Dual::coordinates(p));
        }
        (p, here)
    }

    /// Surface point.
    ///
    /// - `apart`: greatest distance of `p` from the surface beyond its rounding (m)
    fn surface(&self, p: DVec3, gradient: DVec3, apart: f64, ray: &Ray) -> SurfacePoint {
        let normal = self.to_world.normal(gradient).as_vec3();
        // The gradient may be 0, for example at the tip of a cone or between two equal distances.
        let ng = if normal == Vec3::ZERO { -ray.direction } else { normal };
        let offset = offset_bound(ng, self.bounds.magnitude()) + (4.0 * self.rounding + apart) as f32;
        SurfacePoint { p: self.to_world.point(p).as_vec3(), offset, ng, ns: ng, uv: Vec2::ZERO, color: VertexColor::WHITE }
    }

    /// Derivative of the gradient along a vector in the space of the field, by central differences of the exact gradient.
    ///
    /// The step, ∛ε of the extent, keeps both the error of the difference and that of its rounding near 10⁻¹⁰.
    fn gradient_change(&self, p: DVec3, along: DVec3) -> DVec3 {
        let [low, high] = self.extent;
        let step = f64::EPSILON.cbrt() * (high - low).length() / along.length();
        let gradient = |p: DVec3| self.sdf.distance(Dual::coordinates(p)).gradient;
        (gradient(p + along * step) - gradient(p - along * step)) / (2.0 * step)
    }

    /// Forward differences (d(p + hx) − d, d(p + hy) − d, d(p + hz) − d), which point in the direction of the gradient.
    fn forward_difference(&self, p: DVec3, h: f64) -> DVec3 {
        let d = |p: DVec3| self.sdf.distance(p.to_array());
        DVec3::new(d(p + DVec3::X * h), d(p + DVec3::Y * h), d(p + DVec3::Z * h)) - d(p)
    }
}

impl Shape for Solid {
    fn count(&self) -> u32 {
        1
    }

    fn bounds(&self, _: u32) -> Aabb {
        self.bounds
    }

    /// The area is unknown.
    fn area(&self, _: u32) -> f32 {
        0.0
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let line = self.line(ray)?;
        let t = match &self.sdf.march {
            March::Exact => self.sdf.crossing(&line, self.floor)?,
            March::Fixed(fixed) => self.sdf.stop(&line, fixed)?,
        };
        let (_, part) = self.sdf.nearest(line.at(t));
        // Rays start off the surface. A hit at t = 0 is moved to the smallest positive t.
        let hit = ShapeHit { t: (t as f32).max(f32::MIN_POSITIVE), uv: Vec2::new(part as f32, 0.0) };
        (hit.t < ray.t_max).then_some(hit)
    }

    fn point(&self, _: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t);
        let p = self.to_object.transform_point3(p);
        match self.sdf.march {
            March::Exact => {
                let (p, left) = self.project(p);
                let apart = left.value.abs() * self.rounding / self.floor;
                self.surface(p, left.gradient, apart, ray)
            }
            March::Fixed(Fixed { stop, normal_step, .. }) => {
                // Twice the stop distance of the march, so that a ray which leaves the surface does not stop at once.
                let apart = 2.0 * stop * self.rounding / self.floor;
                self.surface(p, self.forward_difference(p, normal_step), apart, ray)
            }
        }
    }

    fn normal_change(&self, _: u32, _: Vec2, point: &SurfacePoint, along: Vec3, _: f32) -> Option<Vec3> {
        let p = self.to_object.transform_point3(point.p.as_dvec3());
        let gradient = self.sdf.distance(Dual::coordinates(p)).gradient;
        let change = self.gradient_change(p, self.to_object.transform_vector3(along.as_dvec3()));
        let to_world = self.to_object.matrix3.transpose();
        Some(unit_change(to_world * gradient, to_world * change).as_vec3()).filter(|change| change.is_finite())
    }

    fn part(&self, _: u32, uv: Vec2) -> u32 {
        uv.x as u32
    }

    /// The end of the ray bounds the interval in which the root is sought.
    fn hits_depend_on_end(&self) -> bool {
        true
    }

    fn distance(&self, p: DVec3) -> Option<(f64, u32)> {
        let (distance, part) = self.sdf.nearest(self.to_object.transform_point3(p));
        Some((distance / greatest_stretch(self.to_object.matrix3), part as u32))
    }

    fn is_sampled(&self) -> bool {
        false
    }

    /// Never called, because a light that cannot be sampled is never chosen.
    fn sample_area(&self, _: u32, _: Vec2) -> (SurfacePoint, AreaPdf) {
        let point =
            SurfacePoint { p: self.bounds.center(), offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::ZERO, color: VertexColor::WHITE };
        (point, AreaPdf::new(0.0))
    }

    fn area_pdf(&self, _: u32, _: &SurfacePoint) -> AreaPdf {
        AreaPdf::new(0.0)
    }

    fn sample_from(&self, _: u32, _: Vec3, _: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        None
    }

    fn pdf_from(&self, _: u32, _: Vec3, _: &SurfacePoint) -> SolidAnglePdf {
        SolidAnglePdf::ZERO
    }
}
