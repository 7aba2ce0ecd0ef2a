//! Spheres, which a transform may stretch to ellipsoids.

mod lanes;

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3, Vec2, Vec3};

use super::{Facet, Geometry, Shape, ShapeHit, SurfacePoint, VertexColor, area_to_solid_angle, offset_bound, stretch, unit_change};
use crate::error::Result;
use crate::math::{Aabb, AreaPdf, Frame, Ray, SolidAnglePdf, Transform, float, warp};

pub(crate) use self::lanes::PointLanes;

/// Sphere x² + y² + z² = r² around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Radius r (m).
    pub radius: f64,
}

impl Geometry for Sphere {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let baked = self.place(to_world);
        (baked.center - baked.reach, baked.center + baked.reach)
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(self.place(to_world)))
    }
}

impl Sphere {
    fn place(&self, to_world: &Transform) -> Ellipsoid {
        let linear = to_world.matrix().matrix3 * self.radius;
        let rows = linear.transpose();
        let reach = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        Ellipsoid {
            center: to_world.point(DVec3::ZERO),
            linear,
            inverse: to_world.inverse().matrix().matrix3 * (1.0 / self.radius),
            reach,
            radius: uniform_radius(linear),
            area: surface_area(linear),
        }
    }
}

/// Common length of the columns if they are orthogonal and equally long (to f32 precision).
pub(super) fn uniform_radius(linear: DMat3) -> Option<f64> {
    let square = linear.transpose() * linear;
    let r2 = (square.x_axis.x + square.y_axis.y + square.z_axis.z) / 3.0;
    let near = |m: DVec3, e: DVec3| (m - e * r2).abs().max_element() <= r2 * f32::EPSILON as f64;
    let is_round = near(square.x_axis, DVec3::X) && near(square.y_axis, DVec3::Y) && near(square.z_axis, DVec3::Z);
    is_round.then(|| r2.sqrt())
}

/// Area ∫ |det M|·|M⁻ᵀn| dn over the unit sphere: 4π r² for a sphere, otherwise by the midpoint rule.
fn surface_area(linear: DMat3) -> f64 {
    if let Some(r) = uniform_radius(linear) {
        return 4.0 * PI * r * r;
    }
    const N: usize = 256;
    let cell = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    let mut sum = 0.0;
    for (i, j) in (0..N).flat_map(|i| (0..2 * N).map(move |j| (i, j))) {
        let z = 1.0 - 2.0 * cell(i, N);
        let (sin, cos) = float::sin_cos_degrees(360.0 * cell(j, 2 * N));
        let r = (1.0 - z * z).sqrt();
        sum += stretch(linear, DVec3::new(r * cos, r * sin, z));
    }
    sum * 4.0 * PI / (2 * N * N) as f64
}

/// Texture coordinates at the point `n` of the unit sphere.
pub(super) fn uv(n: DVec3) -> Vec2 {
    let phi = float::atan2(n.y as f32, n.x as f32) * std::f32::consts::FRAC_1_PI * 0.5;
    let theta = float::acos((n.z as f32).clamp(-1.0, 1.0)) * std::f32::consts::FRAC_1_PI;
    Vec2::new(if phi < 0.0 { phi + 1.0 } else { phi }, theta)
}

/// Derivatives of the point `n` of the unit sphere by [`uv`]: along the circles of latitude and longitude; `None` at the poles.
pub(super) fn tangents(n: DVec3) -> Option<[DVec3; 2]> {
    let sine = n.truncate().length();
    let (east, south) = (DVec3::new(-n.y, n.x, 0.0) * TAU, DVec3::new(n.x * n.z, n.y * n.z, -sine * sine) * (PI / sine));
    (sine > 0.0).then_some([east, south])
}

/// Image of the unit sphere under p ↦ center + linear·p, in f64 because curved shapes are few.
pub struct Ellipsoid {
    center: DVec3,
    linear: DMat3,
    inverse: DMat3,
    /// Half the size of the bounding box.
    reach: DVec3,
    /// Radius if it is a sphere.
    radius: Option<f64>,
    area: f64,
}

impl Ellipsoid {
    /// Density by area of a uniformly sampled point `n` of the unit sphere.
    fn pdf_at(&self, n: DVec3) -> AreaPdf {
        AreaPdf::new((1.0 / (4.0 * PI * stretch(self.linear, n))) as f32)
    }

    /// Surface point for the point `n` of the unit sphere.
    fn at(&self, n: DVec3) -> SurfacePoint {
        SurfacePoint { uv: uv(n), ..self.without_uv(n) }
    }

    /// [`Ellipsoid::at`] with the texture coordinates 0.
    fn without_uv(&self, n: DVec3) -> SurfacePoint {
        let ng = (self.inverse.transpose() * n).normalize().as_vec3();
        let p = (self.center + self.linear * n).as_vec3();
        SurfacePoint { p, offset: offset_bound(ng, self.magnitude()), ng, ns: ng, uv: Vec2::ZERO, color: VertexColor::WHITE }
    }

    /// Greatest absolute value of a coordinate on each axis (m).
    #[inline(always)]
    fn magnitude(&self) -> Vec3 {
        (self.center.abs() + self.reach).as_vec3()
    }

    /// Whether it is a sphere, not a stretched one.
    pub(crate) fn is_sphere(&self) -> bool {
        self.radius.is_some()
    }

    /// Cone of directions that the sphere covers, seen from `p`; `None` for an ellipsoid or if `p` is not outside.
    ///
    /// The point must be outside by more than the rounding error, because a point of the inside that was rounded to the outside would
    /// not see the light that it should.
    fn cone(&self, p: Vec3) -> Option<Cone> {
        let radius = self.radius?;
        let line = p.as_dvec3() - self.center;
        let distance = line.length();
        let axis = line / distance;
        let rounding = offset_bound(axis.as_vec3(), self.magnitude()) as f64;
        let sin2 = (radius / distance) * (radius / distance);
        (distance - radius > rounding).then(|| Cone { axis, distance, radius, one_minus_cos: sin2 / (1.0 + (1.0 - sin2).sqrt()) })
    }
}

/// Cone of directions that a sphere covers.
struct Cone {
    /// Unit direction from the centre of the sphere to the viewer.
    axis: DVec3,
    distance: f64,
    radius: f64,
    /// One minus the cosine of half the opening angle.
    one_minus_cos: f64,
}

impl Cone {
    /// Density 1 / Ω with Ω = 2π (1 − cos θ).
    fn pdf(&self) -> SolidAnglePdf {
        SolidAnglePdf::new((1.0 / (TAU * self.one_minus_cos)) as f32)
    }

    /// Normal on the near side where a sampled direction, uniform in the cone, hits the sphere.
    fn normal(&self, u: Vec2) -> DVec3 {
        let one_minus_cos = self.one_minus_cos * u.x as f64;
        let (cos, sin2) = (1.0 - one_minus_cos, one_minus_cos * (2.0 - one_minus_cos));
        let (d, r) = (self.distance, self.radius);
        let to_hit = d * cos - (r * r - d * d * sin2).max(0.0).sqrt();
        let along = (d - to_hit * cos) / r;
        let across = to_hit * sin2.sqrt() / r;
        let (sin_phi, cos_phi) = float::sin_cos(std::f32::consts::TAU * u.y);
        let frame = Frame::around(self.axis.as_vec3());
        let side = frame.x.as_dvec3() * cos_phi as f64 + frame.y.as_dvec3() * sin_phi as f64;
        (self.axis * along + side * across).normalize()
    }
}

impl Shape for Ellipsoid {
    fn count(&self) -> u32 {
        1
    }

    fn bounds(&self, _: u32) -> Aabb {
        Aabb { min: (self.center - self.reach).as_vec3(), max: (self.center + self.reach).as_vec3() }
    }

    fn area(&self, _: u32) -> f32 {
        self.area as f32
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    fn ellipsoid(&self) -> Option<&Ellipsoid> {
        Some(self)
    }

    /// Solves |o + t d| = 1 in the space of the unit sphere: t = m ± √((1 − |o + m d|²)/d²) with m = −o·d/d².
    ///
    /// The distance of the line from the centre is computed first, because o² − 1 loses the digits of a small sphere far away.
    ///
    /// Source: Haines, Günther, Akenine-Möller, *Precision Improvements for Ray/Sphere Intersection* (2019).
    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let o = self.inverse * (ray.origin.as_dvec3() - self.center);
        let d = self.inverse * ray.direction.as_dvec3();
        let d2 = d.length_squared();
        let middle = -o.dot(d) / d2;
        let inside = 1.0 - (o + d * middle).length_squared();
        if inside.is_nan() || inside < 0.0 {
            return None;
        }
        let half = (inside / d2).sqrt();
        let t = [middle - half, middle + half].into_iter().map(|t| t as f32).find(|&t| t > 0.0 && t < ray.t_max)?;
        Some(ShapeHit { t, uv: Vec2::ZERO })
    }

    fn point(&self, _: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * hit.t as f64;
        self.at((self.inverse * (p - self.center)).normalize())
    }

    fn tangents(&self, _: u32, point: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        let tangents = tangents(self.inverse * (point.p.as_dvec3() - self.center))?;
        Some(tangents.map(|d| (self.linear * d).as_vec3()))
    }

    /// The normal is q/|q| with q = A (p − c), A = M⁻ᵀ M⁻¹ for the matrix M of the ellipsoid.
    fn normal_change(&self, _: u32, _: Vec2, point: &SurfacePoint, along: Vec3, _: f32) -> Option<Vec3> {
        let stretched = |v: DVec3| self.inverse.transpose() * (self.inverse * v);
        let q = stretched(point.p.as_dvec3() - self.center);
        Some(unit_change(q, stretched(along.as_dvec3())).as_vec3())
    }

    /// Samples the unit sphere uniformly. The density on an ellipsoid is higher where the sphere is stretched less.
    fn sample_area(&self, _: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        let n = warp::uniform_sphere(u).as_dvec3().normalize();
        (self.at(n), self.pdf_at(n))
    }

    fn area_pdf(&self, _: u32, point: &SurfacePoint) -> AreaPdf {
        self.pdf_at((self.inverse * (point.p.as_dvec3() - self.center)).normalize())
    }

    fn area_coordinates(&self, _: u32, point: &SurfacePoint) -> Option<Vec2> {
        let n = (self.inverse * (point.p.as_dvec3() - self.center)).normalize();
        Some(warp::uniform_sphere_inverse(n.as_vec3()))
    }

    /// From outside a sphere, samples uniformly in the cone of directions that it covers, so that no sample is wasted.
    fn sample_from(&self, i: u32, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        let Some(cone) = self.cone(from) else {
            let (point, pdf) = self.sample_area(i, u);
            return Some((point, area_to_solid_angle(&point, pdf, from)?));
        };
        let world = cone.normal(u);
        Some((self.without_uv((self.inverse * world).normalize()), cone.pdf()))
    }

    fn texture_coordinates(&self, _: u32, point: &SurfacePoint) -> Vec2 {
        // By the normal: the position may be rounded to the centre of a small sphere far away.
        uv((self.linear.transpose() * point.ng.as_dvec3()).normalize())
    }

    fn pdf_from(&self, i: u32, from: Vec3, point: &SurfacePoint) -> SolidAnglePdf {
        match self.cone(from) {
            Some(cone) => cone.pdf(),
            None => area_to_solid_angle(point, self.area_pdf(i, point), from).unwrap_or(SolidAnglePdf::ZERO),
        }
    }
}
