//! One triangle of a mesh with what its corners have.

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};

use super::{SurfacePoint, VertexColor, offset_bound, triangle, unit_change};
use crate::math::Transform;

/// What the vertices of a mesh in world space have besides their places, its triangles and parts.
pub(super) struct Attributes {
    /// Empty, or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Empty, or one per vertex.
    pub colors: Vec<Vec4>,
    /// Vertices of the triangles, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Index after the last triangle of each part.
    pub part_ends: Vec<u32>,
}

impl Attributes {
    /// Index of the part that a triangle belongs to.
    pub fn part(&self, i: u32) -> u32 {
        self.part_ends.partition_point(|&end| end <= i) as u32
    }

    /// Triangle `i`.
    ///
    /// - `position` and `normal`: those of a vertex; a normal of zero marks a flat surface
    #[inline(always)]
    pub fn triangle(&self, i: u32, position: impl Fn(u32) -> Vec3, normal: Option<impl Fn(u32) -> Vec3>) -> MeshTriangle {
        let vertices = self.triangles[i as usize];
        MeshTriangle {
            corners: vertices.map(position),
            normals: normal.map(|normal| vertices.map(normal)).filter(|normals| !normals.contains(&Vec3::ZERO)),
            uvs: (!self.uvs.is_empty()).then(|| vertices.map(|v| self.uvs[v as usize])),
            colors: (!self.colors.is_empty()).then(|| vertices.map(|v| self.colors[v as usize])),
        }
    }
}

/// Triangle with what its corners have, in world space. Points on it are given by the barycentric weights `w` of the second and third
/// corner.
pub(super) struct MeshTriangle {
    /// Positions (m).
    pub corners: [Vec3; 3],
    /// Normals; `None` for a flat triangle.
    pub normals: Option<[Vec3; 3]>,
    /// Texture coordinates.
    pub uvs: Option<[Vec2; 3]>,
    /// Colours.
    pub colors: Option<[Vec4; 3]>,
}

impl MeshTriangle {
    /// Surface point.
    #[inline(always)]
    pub fn at(&self, w: Vec2) -> SurfacePoint {
        let [a, b, c] = self.corners;
        let ng = triangle::normal([a, b, c]).unwrap_or(Vec3::Z);
        let offset = offset_bound(ng, a.abs().max(b.abs()).max(c.abs()));
        SurfacePoint {
            p: interpolate(self.corners, w),
            offset,
            ng,
            ns: self.normals.and_then(|normals| shading_normal(normals, w, ng)).unwrap_or(ng),
            uv: self.uvs.map_or(w, |uvs| interpolate(uvs, w)),
            color: self.colors.map_or(VertexColor::WHITE, |colors| VertexColor::new(interpolate(colors, w))),
        }
    }

    /// Solves p = p₀ + u ∂p/∂u + v ∂p/∂v at the corners for both derivatives.
    pub fn tangents(&self) -> Option<[Vec3; 2]> {
        let [a, b, c] = self.corners.map(|p| p.as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let Some(uvs) = self.uvs else { return Some([ab.as_vec3(), ac.as_vec3()]) };
        let [p, q, r] = uvs.map(|uv| uv.as_dvec2());
        let (pq, pr) = (q - p, r - p);
        let area = pq.perp_dot(pr);
        (area != 0.0).then(|| [(ab * pr.y - ac * pq.y) / area, (ac * pq.x - ab * pr.x) / area].map(|x| x.as_vec3()))
    }

    /// Change of the shading normal of `point` when it moves by `along` (m).
    pub fn normal_change(&self, w: Vec2, point: &SurfacePoint, along: Vec3) -> Vec3 {
        match self.normals {
            Some(normals) if point.ns != point.ng => interpolated_change(self.corners.map(|p| p.as_dvec3()), normals, w, along),
            _ => Vec3::ZERO,
        }
    }

    /// Height of the smooth surface that the normals describe above `point` (m).
    pub fn terminator_offset(&self, w: Vec2, point: &SurfacePoint) -> f32 {
        self.normals.map_or(0.0, |normals| terminator_offset(self.corners, normals, w, point))
    }

    /// Shading normal of an instance; `None` if it is the geometric normal `ng`.
    pub fn instance_shading_normal(&self, w: Vec2, to_world: &Transform, ng: Vec3) -> Option<Vec3> {
        shading_normal(self.placed_normals(to_world)?, w, ng)
    }

    /// Change of the shading normal of an instance when the point moves by `along` in the world (m).
    pub fn instance_normal_change(&self, w: Vec2, to_world: &Transform, along: Vec3) -> Vec3 {
        let corners = self.corners.map(|p| to_world.point(p.as_dvec3()));
        self.placed_normals(to_world).map_or(Vec3::ZERO, |normals| interpolated_change(corners, normals, w, along))
    }

    /// Height of the smooth surface above an instance at `point` in the world (m).
    pub fn instance_terminator_offset(&self, w: Vec2, to_world: &Transform, point: &SurfacePoint) -> f32 {
        let corners = self.corners.map(|p| to_world.point(p.as_dvec3()).as_vec3());
        self.placed_normals(to_world).map_or(0.0, |normals| terminator_offset(corners, normals, w, point))
    }

    /// Normals of the corners under a transform; `None` if the triangle is flat.
    fn placed_normals(&self, to_world: &Transform) -> Option<[Vec3; 3]> {
        self.normals.map(|normals| normals.map(|n| to_world.normal(n.as_dvec3()).as_vec3()))
    }
}

/// Interpolates values of the corners.
#[inline(always)]
fn interpolate<T>([a, b, c]: [T; 3], w: Vec2) -> T
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    a * (1.0 - w.x - w.y) + b * w.x + c * w.y
}

/// Interpolated normal; `None` if it is on the other side of `ng`.
#[inline(always)]
fn shading_normal(normals: [Vec3; 3], w: Vec2, ng: Vec3) -> Option<Vec3> {
    interpolate(normals, w).try_normalize().filter(|n| n.dot(ng) > 0.0)
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
pub(super) fn weights_along([a, b, c]: [DVec3; 3], along: DVec3) -> DVec2 {
    let (ab, ac) = (b - a, c - a);
    let n = ab.cross(ac);
    DVec2::new(along.cross(ac).dot(n), ab.cross(along).dot(n)) / n.length_squared()
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
