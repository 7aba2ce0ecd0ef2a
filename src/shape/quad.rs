//! Rectangles, which a transform may map to parallelograms.

use glam::{DVec3, Vec2, Vec3};

use super::{Facet, Geometry, Shape, ShapeHit, SurfacePoint, VertexColor, area_to_solid_angle, near, offset_bound};
use crate::error::{Error, Fault, Result};
use crate::math::{Aabb, AreaPdf, Ray, SolidAnglePdf, SphericalRectangle, Transform};

/// Rectangle |x| ≤ w/2, |y| ≤ h/2 in the plane z = 0 with the normal +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// Width w and height h (m).
    pub size: [f64; 2],
}

impl Quad {
    fn corners(&self, to_world: &Transform) -> [DVec3; 4] {
        let [w, h] = self.size.map(|s| 0.5 * s);
        [(-w, -h), (w, -h), (w, h), (-w, h)].map(|(x, y)| to_world.point(DVec3::new(x, y, 0.0)))
    }
}

impl Geometry for Quad {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let c = self.corners(to_world);
        (c.into_iter().reduce(DVec3::min).unwrap_or_default(), c.into_iter().reduce(DVec3::max).unwrap_or_default())
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(Parallelogram::new("quad", self.corners(to_world), to_world.flips_handedness())?))
    }
}

/// Parallelogram with the corners a, b, c, d in turn; u runs along ab and v along ad.
pub(super) struct Parallelogram {
    corners: [Vec3; 4],
    ng: Vec3,
    area: f32,
    offset: f32,
    /// Whether the edges are perpendicular to each other.
    is_rectangle: bool,
}

/// Greatest cosine between the edges of a rectangle, whose corners are rounded.
const PERPENDICULAR: f64 = 1e-6;

impl Parallelogram {
    /// A parallelogram whose corners are counter-clockwise seen from outside, or clockwise if `is_mirrored`.
    ///
    /// - `what`: name of the shape in error messages
    ///
    /// # Errors
    /// `Invalid` if the area is 0 after rounding.
    pub(super) fn new(what: &str, corners: [DVec3; 4], is_mirrored: bool) -> Result<Parallelogram> {
        let corners = corners.map(|c| c.as_vec3());
        // The area of the rounded corners, which rays hit, may be 0 for a small quad in a large scene.
        let [a, b, _, d] = corners.map(|c| c.as_dvec3());
        let cross = (b - a).cross(d - a);
        let flat = || Error::invalid(Fault::new(format!("a {what} is too small to be hit in a scene this large")));
        let normal = cross.try_normalize().ok_or_else(flat)?;
        let ng = if is_mirrored { -normal } else { normal }.as_vec3();
        let area = cross.length() as f32;
        let is_rectangle = (b - a).dot(d - a).abs() <= PERPENDICULAR * (b - a).length() * (d - a).length();
        Ok(Parallelogram { corners, ng, area, is_rectangle, offset: offset_bound(ng, Aabb::around(corners).magnitude()) })
    }

    /// The rectangle as seen from a near point; `None` if it is to be sampled by area, as parallelograms are.
    fn seen(&self, from: Vec3) -> Option<SphericalRectangle> {
        if self.is_rectangle { near::rectangle(self.corners, from) } else { None }
    }

    fn at(&self, uv: Vec2) -> SurfacePoint {
        let [a, b, _, d] = self.corners;
        SurfacePoint {
            p: a + (b - a) * uv.x + (d - a) * uv.y,
            offset: self.offset,
            ng: self.ng,
            ns: self.ng,
            uv,
            color: VertexColor::WHITE,
        }
    }
}

impl Shape for Parallelogram {
    fn count(&self) -> u32 {
        1
    }

    fn bounds(&self, _: u32) -> Aabb {
        Aabb::around(self.corners)
    }

    fn area(&self, _: u32) -> f32 {
        self.area
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Parallelogram(self.corners)
    }

    fn point(&self, _: u32, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.at(hit.uv)
    }

    fn tangents(&self, _: u32, _: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        Some([self.corners[1] - self.corners[0], self.corners[3] - self.corners[0]])
    }

    fn sample_area(&self, _: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.at(u), AreaPdf::new(1.0 / self.area))
    }

    fn area_coordinates(&self, _: u32, point: &SurfacePoint) -> Option<Vec2> {
        Some(point.uv)
    }

    fn is_rectangle(&self, _: u32) -> bool {
        self.is_rectangle
    }

    /// A near rectangle is sampled uniformly by the solid angle under which it is seen.
    fn sample_from(&self, i: u32, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        if let Some(seen) = self.seen(from) {
            let [a, b, _, d] = self.corners;
            return Some((self.at(near::in_direction([a, b, d], from, seen.sample(u))), SolidAnglePdf::new(seen.pdf())));
        }
        let (point, pdf) = self.sample_area(i, u);
        Some((point, area_to_solid_angle(&point, pdf, from)?))
    }

    fn pdf_from(&self, i: u32, from: Vec3, point: &SurfacePoint) -> SolidAnglePdf {
        if let Some(seen) = self.seen(from) {
            return SolidAnglePdf::new(seen.pdf());
        }
        area_to_solid_angle(point, self.area_pdf(i, point), from).unwrap_or(SolidAnglePdf::ZERO)
    }
}
