//! Disks, which a transform may stretch to ellipses.

use glam::{DVec3, Vec2, Vec3};

use super::{Facet, Geometry, Shape, ShapeHit, SurfacePoint, VertexColor, offset_bound};
use crate::error::Result;
use crate::math::{Aabb, AreaPdf, Ray, Transform, warp};

/// Disk x² + y² ≤ r² in the plane z = 0 with the normal +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Radius r (m).
    pub radius: f64,
}

impl Geometry for Disk {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let baked = self.place(to_world);
        (baked.center - baked.reach(), baked.center + baked.reach())
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(self.place(to_world)))
    }
}

impl Disk {
    fn place(&self, to_world: &Transform) -> Ellipse {
        let (x, y) = (to_world.vector(DVec3::X * self.radius), to_world.vector(DVec3::Y * self.radius));
        Ellipse { center: to_world.point(DVec3::ZERO), x, y, normal: to_world.normal(DVec3::Z) }
    }
}

/// Points center + a·x + b·y with a² + b² ≤ 1, in f64 because curved shapes are few.
struct Ellipse {
    center: DVec3,
    x: DVec3,
    y: DVec3,
    normal: DVec3,
}

impl Ellipse {
    /// Half the size of the bounding box, √(xᵢ² + yᵢ²) per axis.
    fn reach(&self) -> DVec3 {
        (self.x * self.x + self.y * self.y).map(f64::sqrt)
    }

    fn at(&self, ab: Vec2) -> SurfacePoint {
        let ng = self.normal.as_vec3();
        let p = (self.center + self.x * ab.x as f64 + self.y * ab.y as f64).as_vec3();
        let magnitude = (self.center.abs() + self.reach()).as_vec3();
        SurfacePoint { p, offset: offset_bound(ng, magnitude), ng, ns: ng, uv: ab * 0.5 + 0.5, color: VertexColor::WHITE }
    }
}

impl Shape for Ellipse {
    fn count(&self) -> u32 {
        1
    }

    fn bounds(&self, _: u32) -> Aabb {
        Aabb { min: (self.center - self.reach()).as_vec3(), max: (self.center + self.reach()).as_vec3() }
    }

    fn area(&self, _: u32) -> f32 {
        (std::f64::consts::PI * self.x.cross(self.y).length()) as f32
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    fn is_flat(&self, _: u32) -> bool {
        true
    }

    /// Intersects the plane. The hit is inside if a² + b² ≤ 1, where p − center = a·x + b·y.
    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let d = ray.direction.as_dvec3();
        let o = ray.origin.as_dvec3() - self.center;
        let t = -self.normal.dot(o) / self.normal.dot(d);
        if !(t as f32 > 0.0 && (t as f32) < ray.t_max) {
            return None;
        }
        let p = o + d * t;
        let n = self.x.cross(self.y);
        let (a, b) = (p.cross(self.y).dot(n) / n.length_squared(), self.x.cross(p).dot(n) / n.length_squared());
        (a * a + b * b <= 1.0).then(|| ShapeHit { t: t as f32, uv: Vec2::new(a as f32, b as f32) })
    }

    fn point(&self, _: u32, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.at(hit.uv)
    }

    /// Tangents of texture coordinates whose square [0, 1]² encloses the disk.
    fn tangents(&self, _: u32, _: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        Some([self.x, self.y].map(|radius| (2.0 * radius).as_vec3()))
    }

    /// Samples uniformly, because an affine map keeps uniform points uniform.
    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.at(warp::disk(u)), AreaPdf::new(1.0 / self.area(i)))
    }

    fn area_coordinates(&self, _: u32, point: &SurfacePoint) -> Option<Vec2> {
        Some(warp::disk_inverse(2.0 * point.uv - 1.0))
    }
}
