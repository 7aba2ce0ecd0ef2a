//! Triangle meshes.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::mesh_data::outward;
use super::mesh_triangle::{Attributes, MeshTriangle, weights_along};
use super::{Detail, Facet, Geometry, MeshData, Shape, ShapeHit, SurfacePoint, area_to_solid_angle, near, triangle};
use crate::error::{Error, Fault, Result};
use crate::math::{Aabb, AreaPdf, Ray, SolidAnglePdf, Transform, warp};

/// Triangle mesh in object space.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    /// Vertices and triangles.
    pub data: Arc<MeshData>,
    /// Whether rays start on the smooth surface that the normals describe instead of the facets, see
    /// [`Shape::shadow_terminator_offset`].
    pub smooth_shadows: bool,
    /// Whether the winding alone says which side of a triangle is the front. Otherwise vertex normals decide where the two disagree.
    pub keeps_winding: bool,
}

impl TriangleMesh {
    /// A mesh whose rays start on its facets.
    pub fn new(data: MeshData) -> TriangleMesh {
        TriangleMesh { data: Arc::new(data), smooth_shadows: false, keeps_winding: false }
    }

    /// The mesh in world space but for its places.
    ///
    /// - `positions` and `normals`: those of the vertices in world space
    pub(super) fn attributes(&self, to_world: &Transform, positions: &[Vec3], normals: &[Vec3]) -> Attributes {
        let (mesh, flip) = (&*self.data, to_world.flips_handedness());
        let deciding = if self.keeps_winding { &[][..] } else { normals };
        Attributes {
            uvs: mesh.uvs.clone(),
            colors: mesh.colors.clone(),
            triangles: mesh.triangles.iter().map(|&t| outward(t, flip, positions, deciding)).collect(),
            part_ends: mesh.parts.iter().map(|part| part.triangles.end).collect(),
        }
    }
}

impl Geometry for TriangleMesh {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        bounds(&self.data.positions, to_world)
    }

    /// Centre and density of the detail. The centre is the median of the vertices, which a few far vertices do not move. The size of
    /// one of n triangles with the extent e is estimated as e/√n.
    fn detail(&self, to_world: &Transform) -> Detail {
        let (min, max) = self.bounds(to_world);
        let mut places: Vec<DVec3> = self.data.positions.iter().map(|p| to_world.point(p.as_dvec3())).collect();
        let count = self.data.triangles.len() as f64;
        Detail {
            middle: DVec3::from_array([0, 1, 2].map(|axis| median(&mut places, axis))),
            density: count * count.sqrt() / (max - min).max_element(),
        }
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        let mesh = &*self.data;
        let (positions, normals) = (placed_positions(&mesh.positions, to_world), placed_normals(&mesh.normals, to_world));
        let attributes = self.attributes(to_world, &positions, &normals);
        if attributes.triangles.iter().all(|t| triangle::normal(t.map(|v| positions[v as usize])).is_none()) {
            return Err(Error::invalid(Fault::new("no usable triangles: all of them are degenerate once placed")));
        }
        let smooth_shadows = self.smooth_shadows && !normals.is_empty();
        Ok(Box::new(BakedMesh { positions, normals, attributes, smooth_shadows }))
    }
}

/// Bounding box of points in world space, in f64 (m).
pub(super) fn bounds(positions: &[Vec3], to_world: &Transform) -> (DVec3, DVec3) {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let corners = positions.iter().map(|p| to_world.point(p.as_dvec3()));
    corners.fold(empty, |(min, max), p| (min.min(p), max.max(p)))
}

/// Points in world space.
pub(super) fn placed_positions(positions: &[Vec3], to_world: &Transform) -> Vec<Vec3> {
    positions.iter().map(|p| to_world.point(p.as_dvec3()).as_vec3()).collect()
}

/// Normals in world space, where a zero vector, which marks a flat surface, stays one.
pub(super) fn placed_normals(normals: &[Vec3], to_world: &Transform) -> Vec<Vec3> {
    let place = |n: &Vec3| if *n == Vec3::ZERO { Vec3::ZERO } else { to_world.normal(n.as_dvec3()).as_vec3() };
    normals.iter().map(place).collect()
}

/// Median coordinate of some points along an axis; 0 if there are none. Changes the order of the points.
fn median(places: &mut [DVec3], axis: usize) -> f64 {
    let half = places.len() / 2;
    if half == places.len() {
        return 0.0;
    }
    let is_even = places.len().is_multiple_of(2);
    let (below, middle, _) = places.select_nth_unstable_by(half, |a, b| a[axis].total_cmp(&b[axis]));
    let below = below.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
    if is_even { 0.5 * below + 0.5 * middle[axis] } else { middle[axis] }
}

/// Triangle mesh in world space.
struct BakedMesh {
    positions: Vec<Vec3>,
    /// Empty, or one per position; a zero vector marks a flat surface.
    normals: Vec<Vec3>,
    attributes: Attributes,
    smooth_shadows: bool,
}

impl BakedMesh {
    fn corners(&self, i: u32) -> [Vec3; 3] {
        self.attributes.triangles[i as usize].map(|v| self.positions[v as usize])
    }

    #[inline(always)]
    fn triangle(&self, i: u32) -> MeshTriangle {
        let normal = (!self.normals.is_empty()).then_some(|v: u32| self.normals[v as usize]);
        self.attributes.triangle(i, |v| self.positions[v as usize], normal)
    }
}

impl Shape for BakedMesh {
    fn count(&self) -> u32 {
        self.attributes.triangles.len() as u32
    }

    fn bounds(&self, i: u32) -> Aabb {
        Aabb::around(self.corners(i))
    }

    fn area(&self, i: u32) -> f32 {
        triangle::area(self.corners(i))
    }

    fn facet(&self, i: u32) -> Facet {
        Facet::Triangle(self.corners(i))
    }

    /// Surface point whose shading normal is bent towards the viewer where it faces away, see [`SurfacePoint::facing`].
    fn point(&self, i: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let point = self.triangle(i).at(hit.uv);
        if self.normals.is_empty() { point } else { point.facing(ray) }
    }

    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.triangle(i).at(warp::triangle(u)), AreaPdf::new(1.0 / self.area(i)))
    }

    fn area_coordinates(&self, i: u32, point: &SurfacePoint) -> Option<Vec2> {
        let corners = self.corners(i).map(|corner| corner.as_dvec3());
        let weights = weights_along(corners, point.p.as_dvec3() - corners[0]).as_vec2();
        Some(warp::triangle_inverse(weights)).filter(|u| u.is_finite())
    }

    /// A near triangle is sampled uniformly by the solid angle under which it is seen.
    fn sample_from(&self, i: u32, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        let corners = self.corners(i);
        if let Some(seen) = near::triangle(corners, from) {
            let weights = near::in_direction(corners, from, seen.sample(u));
            let weights = weights / weights.element_sum().max(1.0);
            return Some((self.triangle(i).at(weights), SolidAnglePdf::new(seen.pdf())));
        }
        let (point, pdf) = self.sample_area(i, u);
        Some((point, area_to_solid_angle(&point, pdf, from)?))
    }

    fn pdf_from(&self, i: u32, from: Vec3, point: &SurfacePoint) -> SolidAnglePdf {
        if let Some(seen) = near::triangle(self.corners(i), from) {
            return SolidAnglePdf::new(seen.pdf());
        }
        area_to_solid_angle(point, self.area_pdf(i, point), from).unwrap_or(SolidAnglePdf::ZERO)
    }

    fn tangents(&self, i: u32, _: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        self.triangle(i).tangents()
    }

    fn normal_change(&self, i: u32, w: Vec2, point: &SurfacePoint, along: Vec3, _: f32) -> Option<Vec3> {
        Some(self.triangle(i).normal_change(w, point, along))
    }

    fn instance_normal_change(&self, i: u32, w: Vec2, to_world: &Transform, along: Vec3, _: f32) -> Option<Vec3> {
        Some(self.triangle(i).instance_normal_change(w, to_world, along))
    }

    fn part(&self, i: u32, _: Vec2) -> u32 {
        self.attributes.part(i)
    }

    fn has_shading_normals(&self) -> bool {
        !self.normals.is_empty()
    }

    fn shadow_terminator_offset(&self, i: u32, w: Vec2, point: &SurfacePoint, _: f32) -> f32 {
        self.triangle(i).terminator_offset(w, point)
    }

    fn mirroring_swaps_uv(&self) -> bool {
        self.attributes.uvs.is_empty()
    }

    fn instance_shading_normal(&self, i: u32, w: Vec2, to_world: &Transform, ng: Vec3, _: f32) -> Option<Vec3> {
        self.triangle(i).instance_shading_normal(w, to_world, ng)
    }

    fn instance_shadow_terminator_offset(&self, i: u32, w: Vec2, to_world: &Transform, point: &SurfacePoint, _: f32) -> f32 {
        self.triangle(i).instance_terminator_offset(w, to_world, point)
    }

    fn has_shadow_terminator_offset(&self) -> bool {
        self.smooth_shadows
    }
}
