//! Triangle meshes.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::{Detail, Facet, Geometry, MeshData, Shape, ShapeHit, SurfacePoint, VertexColor, bent, offset_bound, triangle};
use crate::error::{Error, Fault, Result};
use crate::math::{Aabb, AreaPdf, Ray, Transform, warp};

/// A mesh in its own space.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    pub data: Arc<MeshData>,
    /// Whether light leaves from the smooth surface that the normals tell of, not from the facets: [`Shape::lift`].
    pub smooth_shadows: bool,
}

impl TriangleMesh {
    /// As light meets its facets.
    pub fn new(data: MeshData) -> TriangleMesh {
        TriangleMesh { data: Arc::new(data), smooth_shadows: false }
    }
}

impl Geometry for TriangleMesh {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let corners = self.data.positions.iter().map(|p| to_world.point(p.as_dvec3()));
        corners.fold(empty, |(min, max), p| (min.min(p), max.max(p)))
    }

    /// In the median of the vertices, which a few far away do not move; n triangles over the extent e are about e/√n large.
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
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|&t| outward(t, flip, &positions, &normals)).collect();
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

/// The median coordinate of some points along an axis; 0 of none. The points are put into another order.
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

/// The triangle wound so that its geometric normal points to the outside.
///
/// A mirroring transform turns every triangle inside out. Where the vertex normals say otherwise
/// than the winding, they win: they are what was modelled with care.
fn outward([a, b, c]: [u32; 3], mirrored: bool, positions: &[Vec3], normals: &[Vec3]) -> [u32; 3] {
    let wound = if mirrored { [a, c, b] } else { [a, b, c] };
    let modelled: Vec3 = if normals.is_empty() { Vec3::ZERO } else { wound.iter().map(|&v| normals[v as usize]).sum() };
    let against = triangle::normal(wound.map(|v| positions[v as usize])).is_some_and(|n| n.dot(modelled) < 0.0);
    if against { [wound[0], wound[2], wound[1]] } else { wound }
}

struct BakedMesh {
    positions: Vec<Vec3>,
    /// Empty, or one per position; zero where the surface is flat.
    normals: Vec<Vec3>,
    /// Empty, or one per position.
    uvs: Vec<Vec2>,
    /// Empty, or one per position.
    colors: Vec<Vec4>,
    triangles: Vec<[u32; 3]>,
    /// One past the last triangle of each part.
    part_ends: Vec<u32>,
    smooth_shadows: bool,
}

/// Of the cosine by which a facet faces the viewer, what its shading normal has of it at least.
const LEAST_FACING: f32 = 2.0 / 3.0;

impl BakedMesh {
    fn corners(&self, i: u32) -> [Vec3; 3] {
        self.triangles[i as usize].map(|v| self.positions[v as usize])
    }

    /// The surface at the weights `w` of the second and third corner.
    fn at(&self, i: u32, w: Vec2) -> SurfacePoint {
        let [a, b, c] = self.corners(i);
        let ng = triangle::normal([a, b, c]).unwrap_or(Vec3::Z);
        let p = a * (1.0 - w.x - w.y) + b * w.x + c * w.y;
        let uv = if self.uvs.is_empty() { w } else { self.blend(&self.uvs, i, w) };
        let offset = offset_bound(ng, a.abs().max(b.abs()).max(c.abs()));
        let color = if self.colors.is_empty() { VertexColor::WHITE } else { VertexColor::new(self.blend(&self.colors, i, w)) };
        SurfacePoint { p, offset, ng, ns: self.shading_normal(i, w, ng), uv, color }
    }

    fn blend<T>(&self, values: &[T], i: u32, w: Vec2) -> T
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = self.triangles[i as usize].map(|v| values[v as usize]);
        a * (1.0 - w.x - w.y) + b * w.x + c * w.y
    }

    /// Interpolated; `ng` where the mesh has none here, or where interpolation leaves the side of `ng`.
    fn shading_normal(&self, i: u32, w: Vec2, ng: Vec3) -> Vec3 {
        if self.normals.is_empty() || self.triangles[i as usize].iter().any(|&v| self.normals[v as usize] == Vec3::ZERO) {
            return ng;
        }
        self.blend(&self.normals, i, w).try_normalize().filter(|n| n.dot(ng) > 0.0).unwrap_or(ng)
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

    /// At the outline of a coarse mesh facets are seen whose interpolated normal faces away already: nothing could be reflected there,
    /// or to nowhere but below the facet, and a black fringe would show. The normal is bent towards the viewer until it faces him two
    /// thirds as much as the facet does: his mirror image about it is then above the facet as long as the two normals are within 41°
    /// of each other. What comes of it is a function of the ray and the point alone, whoever looks for the light.
    ///
    /// Tests: outlines_have_no_fringe.
    fn point(&self, i: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let point = self.at(i, hit.uv);
        if self.normals.is_empty() {
            return point;
        }
        let facing = -point.ng.dot(ray.direction);
        let seen = -ray.direction * 1f32.copysign(facing);
        SurfacePoint { ns: bent(point.ns, seen, LEAST_FACING * facing.abs()), ..point }
    }

    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.at(i, warp::triangle(u)), AreaPdf::new(1.0 / self.area(i)))
    }

    /// p = p₀ + u ∂p/∂u + v ∂p/∂v at the corners, solved for both.
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

    fn part(&self, i: u32, _: Vec2) -> u32 {
        self.part_ends.partition_point(|&end| end <= i) as u32
    }

    fn has_shading_normals(&self) -> bool {
        !self.normals.is_empty()
    }

    fn lift(&self, i: u32, w: Vec2, point: &SurfacePoint) -> f32 {
        let normals = self.triangles[i as usize].map(|v| self.normals[v as usize]);
        if normals.contains(&Vec3::ZERO) { 0.0 } else { smooth_lift(self.corners(i), normals, w, point) }
    }

    fn has_lift(&self) -> bool {
        self.smooth_shadows
    }
}

/// The height along `ng` at which a ray, starting into any direction above its shading normal's horizon, clears the facets.
///
/// h = Σ wₖ max(0, nₖ·(vₖ − p)) / max(½, ng · Σ wₖ nₖ)                (m)
///
/// - `corners` vₖ, `normals` nₖ: with weights (1 − w₁ − w₂, w₁, w₂) at the point p; Σ wₖ nₖ is the shading normal, unscaled
/// - 0 where the surface is flat or concave: facets do not hide there what the smooth surface would see
/// - at most twice the mean distance to the corners: normals more than 60° from `ng` tell of no surface over this facet
///
/// nₖ·(x − vₖ) = 0 is the tangent plane at a corner. The plane through p + h ng across the shading normal
/// is their mean, Σ wₖ nₖ·(x − vₖ) = 0: a mesh that lies behind each of its tangent planes, as a convex one does,
/// lies behind this one too, coarse as it may be. On a sphere that is twice the height of the sphere itself.
///
/// Source: Hanika, *Hacking the Shadow Terminator* (Ray Tracing Gems II, 2021), whose point is moved by
/// Σ wₖ max(0, nₖ·(vₖ − p)) nₖ: all but the same for fine meshes; of coarse ones some rays still meet their own facets.
/// Tests: lifted_rays_clear_a_convex_mesh, smooth_cylinder.
fn smooth_lift(corners: [Vec3; 3], normals: [Vec3; 3], w: Vec2, point: &SurfacePoint) -> f32 {
    let weights = [1.0 - w.x - w.y, w.x, w.y];
    let (mut depth, mut slant) = (0.0, 0.0);
    for ((v, n), w) in corners.into_iter().zip(normals).zip(weights) {
        depth += w * n.dot(v - point.p).max(0.0);
        slant += w * n.dot(point.ng);
    }
    // Where interpolation leaves the side of ng, the shading normal is ng, and the facet is flat.
    if slant > 0.0 { depth / slant.max(0.5) } else { 0.0 }
}
