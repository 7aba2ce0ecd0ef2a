//! Triangle meshes.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};

use super::mesh_data::outward;
use super::{
    Detail, Facet, Geometry, MeshData, Shape, ShapeHit, SurfacePoint, VertexColor, area_to_solid_angle, near, offset_bound, triangle,
    unit_change,
};
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
}

impl Geometry for TriangleMesh {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let corners = self.data.positions.iter().map(|p| to_world.point(p.as_dvec3()));
        corners.fold(empty, |(min, max), p| (min.min(p), max.max(p)))
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
        let positions: Vec<Vec3> = mesh.positions.iter().map(|p| to_world.point(p.as_dvec3()).as_vec3()).collect();
        let place = |n: &Vec3| if *n == Vec3::ZERO { Vec3::ZERO } else { to_world.normal(n.as_dvec3()).as_vec3() };
        let normals: Vec<Vec3> = mesh.normals.iter().map(place).collect();
        let flip = to_world.flips_handedness();
        let deciding = if self.keeps_winding { &[][..] } else { &normals };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|&t| outward(t, flip, &positions, deciding)).collect();
        if triangles.iter().all(|t| triangle::normal(t.map(|v| positions[v as usize])).is_none()) {
            return Err(Error::invalid(Fault::new("no usable triangles: all of them are degenerate once placed")));
        }
        let part_ends = mesh.parts.iter().map(|part| part.triangles.end).collect();
        let smooth_shadows = self.smooth_shadows && !normals.is_empty();
        Ok(Box::new(BakedMesh {
            positions,
            normals,
            uvs: mesh.uvs.clone(),
            colors: mesh.colors.clone(),
            triangles,
            part_ends,
            smooth_shadows,
        }))
    }
}

/// Change of the interpolated normal of a triangle when the point moves by `along` (m).
///
/// - `normals`: unit normals of the corners
/// - `w`: barycentric weights of the second and third corner
fn interpolated_change(corners: [DVec3; 3], normals: [Vec3; 3], w: Vec2, along: Vec3) -> Vec3 {
    let DVec2 { x: to_b, y: to_c } = weights_along(corners, along.as_dvec3());
    let [na, nb, nc] = normals.map(|normal| normal.as_dvec3());
    let w = w.as_dvec2();
    unit_change(na * (1.0 - w.x - w.y) + nb * w.x + nc * w.y, (nb - na) * to_b + (nc - na) * to_c).as_vec3()
}

/// By how much the barycentric weights of the second and third corner of a triangle grow when the point moves by `along` (m).
fn weights_along([a, b, c]: [DVec3; 3], along: DVec3) -> DVec2 {
    let (ab, ac) = (b - a, c - a);
    let n = ab.cross(ac);
    DVec2::new(along.cross(ac).dot(n), ab.cross(along).dot(n)) / n.length_squared()
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
    /// Empty, or one per position.
    uvs: Vec<Vec2>,
    /// Empty, or one per position.
    colors: Vec<Vec4>,
    triangles: Vec<[u32; 3]>,
    /// Index after the last triangle of each part.
    part_ends: Vec<u32>,
    smooth_shadows: bool,
}

impl BakedMesh {
    fn corners(&self, i: u32) -> [Vec3; 3] {
        self.triangles[i as usize].map(|v| self.positions[v as usize])
    }

    /// Surface point at the barycentric weights `w` of the second and third corner.
    fn at(&self, i: u32, w: Vec2) -> SurfacePoint {
        let [a, b, c] = self.corners(i);
        let ng = triangle::normal([a, b, c]).unwrap_or(Vec3::Z);
        let p = a * (1.0 - w.x - w.y) + b * w.x + c * w.y;
        let uv = if self.uvs.is_empty() { w } else { self.interpolate(&self.uvs, i, w) };
        let offset = offset_bound(ng, a.abs().max(b.abs()).max(c.abs()));
        let color = if self.colors.is_empty() { VertexColor::WHITE } else { VertexColor::new(self.interpolate(&self.colors, i, w)) };
        SurfacePoint { p, offset, ng, ns: self.shading_normal(i, w, ng), uv, color }
    }

    /// Interpolates vertex values.
    fn interpolate<T>(&self, values: &[T], i: u32, w: Vec2) -> T
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = self.triangles[i as usize].map(|v| values[v as usize]);
        a * (1.0 - w.x - w.y) + b * w.x + c * w.y
    }

    /// Interpolated normal; `ng` if the triangle has no vertex normals or the interpolated normal is on the other side of `ng`.
    fn shading_normal(&self, i: u32, w: Vec2, ng: Vec3) -> Vec3 {
        if self.normals.is_empty() || self.triangles[i as usize].iter().any(|&v| self.normals[v as usize] == Vec3::ZERO) {
            return ng;
        }
        self.interpolate(&self.normals, i, w).try_normalize().filter(|n| n.dot(ng) > 0.0).unwrap_or(ng)
    }

    /// Normals of a triangle's corners under a transform; `None` if the triangle is flat.
    fn placed_normals(&self, i: u32, to_world: &Transform) -> Option<[Vec3; 3]> {
        let normals = self.triangles[i as usize].map(|v| self.normals.get(v as usize).copied().unwrap_or(Vec3::ZERO));
        (!normals.contains(&Vec3::ZERO)).then(|| normals.map(|n| to_world.normal(n.as_dvec3()).as_vec3()))
    }
}

impl Shape for BakedMesh {
    fn count(&self) -> u32 {
        self.triangles.len() as u32
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
        let point = self.at(i, hit.uv);
        if self.normals.is_empty() { point } else { point.facing(ray) }
    }

    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.at(i, warp::triangle(u)), AreaPdf::new(1.0 / self.area(i)))
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
            return Some((self.at(i, weights), SolidAnglePdf::new(seen.pdf())));
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

    /// Solves p = p₀ + u ∂p/∂u + v ∂p/∂v at the corners for both derivatives.
    fn tangents(&self, i: u32, _: &SurfacePoint) -> Option<[Vec3; 2]> {
        let [a, b, c] = self.corners(i).map(|p| p.as_dvec3());
        let (ab, ac) = (b - a, c - a);
        if self.uvs.is_empty() {
            return Some([ab.as_vec3(), ac.as_vec3()]);
        }
        let [p, q, r] = self.triangles[i as usize].map(|v| self.uvs[v as usize].as_dvec2());
        let (pq, pr) = (q - p, r - p);
        let area = pq.perp_dot(pr);
        (area != 0.0).then(|| [(ab * pr.y - ac * pq.y) / area, (ac * pq.x - ab * pr.x) / area].map(|x| x.as_vec3()))
    }

    fn normal_change(&self, i: u32, w: Vec2, point: &SurfacePoint, along: Vec3) -> Option<Vec3> {
        if point.ns == point.ng {
            return Some(Vec3::ZERO);
        }
        let normals = self.triangles[i as usize].map(|v| self.normals[v as usize]);
        Some(interpolated_change(self.corners(i).map(|p| p.as_dvec3()), normals, w, along))
    }

    fn instance_normal_change(&self, i: u32, w: Vec2, to_world: &Transform, along: Vec3) -> Option<Vec3> {
        let corners = self.corners(i).map(|p| to_world.point(p.as_dvec3()));
        Some(self.placed_normals(i, to_world).map_or(Vec3::ZERO, |normals| interpolated_change(corners, normals, w, along)))
    }

    fn part(&self, i: u32, _: Vec2) -> u32 {
        self.part_ends.partition_point(|&end| end <= i) as u32
    }

    fn has_shading_normals(&self) -> bool {
        !self.normals.is_empty()
    }

    fn shadow_terminator_offset(&self, i: u32, w: Vec2, point: &SurfacePoint) -> f32 {
        let normals = self.triangles[i as usize].map(|v| self.normals[v as usize]);
        if normals.contains(&Vec3::ZERO) { 0.0 } else { terminator_offset(self.corners(i), normals, w, point) }
    }

    fn mirroring_swaps_uv(&self) -> bool {
        self.uvs.is_empty()
    }

    fn instance_shading_normal(&self, i: u32, w: Vec2, to_world: &Transform, ng: Vec3) -> Option<Vec3> {
        let [a, b, c] = self.placed_normals(i, to_world)?;
        (a * (1.0 - w.x - w.y) + b * w.x + c * w.y).try_normalize().filter(|n| n.dot(ng) > 0.0)
    }

    fn instance_shadow_terminator_offset(&self, i: u32, w: Vec2, to_world: &Transform, point: &SurfacePoint) -> f32 {
        let corners = self.corners(i).map(|p| to_world.point(p.as_dvec3()).as_vec3());
        self.placed_normals(i, to_world).map_or(0.0, |normals| terminator_offset(corners, normals, w, point))
    }

    fn has_shadow_terminator_offset(&self) -> bool {
        self.smooth_shadows
    }
}

/// Height along `ng` at which a ray into any direction above the horizon of the shading normal clears the facets.
///
/// h = Σ wₖ max(0, nₖ·(vₖ − p)) / max(½, ng · Σ wₖ nₖ)                (m)
///
/// - `corners` vₖ and `normals` nₖ have the weights (1 − w₁ − w₂, w₁, w₂) at the point p; Σ wₖ nₖ is the shading normal, not normalized
/// - the height is 0 where the surface is flat or concave, because facets there hide nothing that the smooth surface sees
/// - the height is at most twice the mean distance to the corners, because normals more than 60° from `ng` do not describe a surface
///   over this facet
///
/// nₖ·(x − vₖ) = 0 is the tangent plane at a corner. The plane through p + h ng perpendicular to the shading normal is their weighted
/// mean, Σ wₖ nₖ·(x − vₖ) = 0. A convex mesh lies behind each of its tangent planes and therefore also behind this plane, however coarse
/// it is. On a sphere the height is twice that of the sphere itself.
///
/// Source: Hanika, *Hacking the Shadow Terminator* (Ray Tracing Gems II, 2021), whose point is moved by
/// Σ wₖ max(0, nₖ·(vₖ − p)) nₖ. That is nearly the same for fine meshes, but on coarse ones some rays still hit their own facets.
/// Tests: offset_rays_leave_a_convex_mesh, row N22 of `pt torture`.
fn terminator_offset(corners: [Vec3; 3], normals: [Vec3; 3], w: Vec2, point: &SurfacePoint) -> f32 {
    let weights = [1.0 - w.x - w.y, w.x, w.y];
    let (mut depth, mut slant) = (0.0, 0.0);
    for ((v, n), w) in corners.into_iter().zip(normals).zip(weights) {
        depth += w * n.dot(v - point.p).max(0.0);
        slant += w * n.dot(point.ng);
    }
    // Where interpolation leaves the side of ng, the shading normal is ng, and the facet is flat.
    if slant > 0.0 { depth / slant.max(0.5) } else { 0.0 }
}
