//! Bilinear patches: the surfaces that two families of straight lines span between four corners.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::{
    Facet, Geometry, HIT_ROUNDING, Shape, ShapeHit, SurfacePoint, VertexColor, border_width, gauss_nodes, offset_bound, unit_change,
};
use crate::error::{Error, Fault, Result};
use crate::math::float::{ONE_MINUS_EPSILON, acos_f64};
use crate::math::{Aabb, AreaPdf, Ray, Transform};

/// Points p(u, v) = (1 − u)(1 − v) p₀₀ + u (1 − v) p₁₀ + (1 − u) v p₀₁ + u v p₁₁ with 0 ≤ u, v ≤ 1. The normal is that of ∂p/∂u × ∂p/∂v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BilinearPatch {
    /// Corners p₀₀, p₁₀, p₀₁ and p₁₁ (m).
    pub corners: [DVec3; 4],
}

impl BilinearPatch {
    fn place(&self, to_world: &Transform) -> Placed {
        Placed::new(self.corners.map(|corner| to_world.point(corner)), to_world.flips_handedness())
    }

    /// Normals ∂p/∂u × ∂p/∂v at the corners p₀₀, p₁₀, p₀₁ and p₁₁ (m²). Elsewhere the normal is their bilinear interpolation.
    pub fn corner_normals(&self) -> [DVec3; 4] {
        let [a, b, c, d] = self.corners;
        [(b - a).cross(c - a), (b - a).cross(d - b), (d - c).cross(c - a), (d - c).cross(d - b)]
    }
}

impl Geometry for BilinearPatch {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let placed = self.place(to_world);
        (placed.low, placed.high)
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        let placed = self.place(to_world);
        if placed.area > 0.0 {
            Ok(Box::new(placed))
        } else {
            Err(Error::invalid(Fault::new("the corners of a bilinear patch lie on one line, or are too close together to be hit")))
        }
    }
}

/// Interpolates bilinearly between values at (0, 0), (1, 0), (0, 1) and (1, 1).
fn bilinear<T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>([a, b, c, d]: [T; 4], at: DVec2) -> T {
    (a * (1.0 - at.x) + b * at.x) * (1.0 - at.y) + (c * (1.0 - at.x) + d * at.x) * at.y
}

/// Samples [0, 1] in proportion to a line from `a` to `b`.
fn sample_line(u: f64, a: f64, b: f64) -> f64 {
    let sum = a + (a * a + (b * b - a * a) * u).sqrt();
    if sum > 0.0 { u * (a + b) / sum } else { u }
}

/// Inverse of [`sample_line`].
fn share_of_line(x: f64, a: f64, b: f64) -> f64 {
    if a + b > 0.0 { x * (a * (2.0 - x) + b * x) / (a + b) } else { x }
}

/// Patch in the world, in f64 because curved shapes are few.
struct Placed {
    corners: [DVec3; 4],
    low: DVec3,
    high: DVec3,
    /// Lengths of the normals at the corners (m²).
    stretch: [f64; 4],
    /// Sign of the normal: −1 in a mirrored patch, whose normal stays on its side.
    side: f64,
    area: f64,
}

impl Placed {
    fn new(corners: [DVec3; 4], is_mirrored: bool) -> Placed {
        let low = corners.into_iter().reduce(DVec3::min).unwrap_or_default();
        let high = corners.into_iter().reduce(DVec3::max).unwrap_or_default();
        let normals = BilinearPatch { corners }.corner_normals();
        let side = if is_mirrored { -1.0 } else { 1.0 };
        Placed { corners, low, high, stretch: normals.map(DVec3::length), side, area: area(normals) }
    }

    /// Derivatives ∂p/∂u and ∂p/∂v.
    fn derivatives(&self, at: DVec2) -> [DVec3; 2] {
        let [a, b, c, d] = self.corners;
        [(b - a) * (1.0 - at.y) + (d - c) * at.y, (c - a) * (1.0 - at.x) + (d - b) * at.x]
    }

    fn normal(&self, at: DVec2) -> DVec3 {
        let [along_u, along_v] = self.derivatives(at);
        along_u.cross(along_v) * self.side
    }

    fn at(&self, uv: Vec2) -> SurfacePoint {
        let at = uv.as_dvec2();
        // Where two corners coincide there is no normal: that of the middle stands for it.
        let normal = self.normal(at).try_normalize().or_else(|| self.normal(DVec2::splat(0.5)).try_normalize());
        let ng = normal.unwrap_or(DVec3::Z).as_vec3();
        let offset = offset_bound(ng, self.low.abs().max(self.high.abs()).as_vec3());
        SurfacePoint { p: bilinear(self.corners, at).as_vec3(), offset, ng, ns: ng, uv, color: VertexColor::WHITE }
    }

    /// Density by area of a point: that of its coordinates, in proportion to [`Placed::stretch`], divided by |∂p/∂u × ∂p/∂v|.
    fn pdf_at(&self, at: DVec2) -> AreaPdf {
        let (weight, stretch) = (bilinear(self.stretch, at), self.normal(at).length());
        let ratio = if stretch > 0.0 { weight / stretch } else { 1.0 };
        AreaPdf::new((4.0 * ratio / self.stretch.into_iter().sum::<f64>()) as f32)
    }

    /// The stretch where u is 0 and 1.
    fn ends_along_u(&self, v: f64) -> [f64; 2] {
        let [a, b, c, d] = self.stretch;
        [a + (c - a) * v, b + (d - b) * v]
    }

    /// The stretch where v is 0 and 1, summed over u.
    fn ends_along_v(&self) -> [f64; 2] {
        let [a, b, c, d] = self.stretch;
        [a + b, c + d]
    }

    /// Whether coordinates lie in the patch, or outside of it by no more than the rounding of a hit.
    ///
    /// - `rounding`: rounding error of positions (m)
    fn covers(&self, at: DVec2, d: DVec3, rounding: f64) -> bool {
        let [along_u, along_v] = self.derivatives(at.clamp(DVec2::ZERO, DVec2::ONE));
        let normal = along_u.cross(along_v);
        let cos = normal.dot(d) / (normal.length() * d.length());
        let error = border_width(rounding, cos);
        let within = |x: f64, length: f64| x * length >= -error && (x - 1.0) * length <= error;
        within(at.x, along_u.length()) && within(at.y, along_v.length())
    }
}

/// Area ∫ |∂p/∂u × ∂p/∂v| du dv, by the Gaussian rule of two points on each side of a cell.
fn area(normals: [DVec3; 4]) -> f64 {
    const STEPS: u32 = 8;
    let row = |v: f64| gauss_nodes(STEPS).map(|u| bilinear(normals, DVec2::new(u, v)).length()).sum::<f64>();
    gauss_nodes(STEPS).map(row).sum::<f64>() / f64::from(4 * STEPS * STEPS)
}

impl Shape for Placed {
    fn count(&self) -> u32 {
        1
    }

    fn bounds(&self, _: u32) -> Aabb {
        Aabb { min: self.low.as_vec3(), max: self.high.as_vec3() }
    }

    fn area(&self, _: u32) -> f32 {
        self.area as f32
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    /// Normals are means of those at the corners with weights of at least 0, and so lie in every cone around these of less than a right
    /// angle.
    fn normal_cone(&self, _: u32) -> Option<(DVec3, f64)> {
        let normals = BilinearPatch { corners: self.corners }.corner_normals().map(|normal| normal * self.side);
        let units = normals.map(DVec3::try_normalize);
        let axis = units.into_iter().flatten().sum::<DVec3>().try_normalize()?;
        let least = units.into_iter().flatten().map(|unit| unit.dot(axis)).fold(1.0, f64::min);
        (least > 0.0).then(|| (axis, acos_f64(least)))
    }

    /// Finds the lines of constant u that the ray meets, and where on them.
    ///
    /// The line a(u) + v b(u), seen from a point of the ray, meets the ray in the direction d where (a × d)·b = 0. This is a quadratic
    /// equation for u. With it, a + v b = t d gives t = (a × b)·(d × b)/|d × b|² and v = (a × d)·(d × b)/|d × b|².
    ///
    /// Distances count from the point of the ray that is nearest to the middle of the patch, so that far rays keep their digits.
    ///
    /// Source: Reshetov, *Cool Patches: A Geometric Approach to Ray/Bilinear Patch Intersections* (Ray Tracing Gems, 2019).
    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let (origin, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let start = (0.5 * (self.low + self.high) - origin).dot(d) / d.length_squared();
        let [p00, p10, p01, p11] = self.corners.map(|corner| corner - (origin + d * start));
        let (first, last) = (p00.cross(d).dot(p01 - p00), p10.cross(d).dot(p11 - p10));
        let square = (p10 - p00).cross(p01 - p11).dot(d);
        let slope = last - first - square;
        let sum = -0.5 * (slope + (slope * slope - 4.0 * first * square).sqrt().copysign(slope));
        let size = (self.high - self.low).length();
        let rounding =
            HIT_ROUNDING * (size + (0.5 * (self.low + self.high) - origin).length() + self.low.abs().max(self.high.abs()).length());
        let hit = |u: f64| {
            let (a, b) = (p00 + (p10 - p00) * u, (p01 - p00) * (1.0 - u) + (p11 - p10) * u);
            let across = d.cross(b);
            let (t, v) = (a.cross(b).dot(across) / across.length_squared(), a.cross(d).dot(across) / across.length_squared());
            let (t, at) = ((start + t) as f32, DVec2::new(u, v));
            (t > 0.0 && t < ray.t_max && self.covers(at, d, rounding))
                .then(|| ShapeHit { t, uv: at.clamp(DVec2::ZERO, DVec2::ONE).as_vec2() })
        };
        let hits = [sum / square, first / sum].map(hit);
        hits.into_iter().flatten().reduce(|a, b| if b.t < a.t { b } else { a })
    }

    fn point(&self, _: u32, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.at(hit.uv)
    }

    fn tangents(&self, _: u32, point: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        Some(self.derivatives(point.uv.as_dvec2()).map(|tangent| tangent.as_vec3()))
    }

    /// With the second derivative c = ∂²p/∂u∂v, the normal n = ∂p/∂u × ∂p/∂v changes by ∂p/∂u × c du + c × ∂p/∂v dv.
    fn normal_change(&self, _: u32, uv: Vec2, _: &SurfacePoint, along: Vec3, _: f32) -> Option<Vec3> {
        let ([along_u, along_v], along) = (self.derivatives(uv.as_dvec2()), along.as_dvec3());
        let normal = along_u.cross(along_v);
        let [p00, p10, p01, p11] = self.corners;
        let twist = p11 - p10 - (p01 - p00);
        let [du, dv] = [along.cross(along_v), along_u.cross(along)].map(|part| part.dot(normal) / normal.length_squared());
        let change = along_u.cross(twist) * du + twist.cross(along_v) * dv;
        (normal.length_squared() > 0.0).then(|| unit_change(normal * self.side, change * self.side).as_vec3())
    }

    /// Samples coordinates in proportion to the bilinear interpolation of the stretch at the corners: uniformly by area on a flat patch, and
    /// nearly so on others.
    ///
    /// Source: Pharr, Jakob, Humphreys, *Physically Based Rendering* (2023), 6.6.
    fn sample_area(&self, _: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        let [low, high] = self.ends_along_v();
        let v = sample_line(u.y.into(), low, high);
        let [left, right] = self.ends_along_u(v);
        let uv = DVec2::new(sample_line(u.x.into(), left, right), v).as_vec2();
        (self.at(uv), self.pdf_at(uv.as_dvec2()))
    }

    fn area_pdf(&self, _: u32, point: &SurfacePoint) -> AreaPdf {
        self.pdf_at(point.uv.as_dvec2())
    }

    fn area_coordinates(&self, _: u32, point: &SurfacePoint) -> Option<Vec2> {
        let at = point.uv.as_dvec2();
        let ([low, high], [left, right]) = (self.ends_along_v(), self.ends_along_u(at.y));
        let u = Vec2::new(share_of_line(at.x, left, right) as f32, share_of_line(at.y, low, high) as f32);
        Some(u.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON)))
    }
}
