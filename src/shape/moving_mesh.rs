//! Triangle meshes whose vertices move while the shutter is open.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::mesh_triangle::{Attributes, MeshTriangle};
use super::triangle_mesh::{bounds, placed_normals, placed_positions};
use super::{Detail, Facet, Geometry, MeshData, Shape, ShapeHit, SurfacePoint, TriangleMesh, triangle};
use crate::error::{Error, Fault, Result};
use crate::math::{Aabb, AreaPdf, Ray, Transform};

/// Triangle mesh in object space whose vertices go from place to place.
///
/// Between two poses each vertex moves evenly along a straight line, and its normal with it. Before the first and after the last the mesh
/// stays as it is there.
#[derive(Clone, Debug)]
pub struct MovingMesh {
    /// The mesh. Its own places and normals only decide which sides of its triangles are their fronts.
    pub mesh: TriangleMesh,
    /// Poses, at least one, with times that increase.
    pub poses: Vec<Pose>,
}

/// Vertices of a mesh at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Time, in seconds or as a fraction of the shutter interval, as the owner says.
    pub time: f64,
    /// Positions of the vertices (m).
    pub positions: Vec<Vec3>,
    /// Empty, or one normal for each vertex; a zero vector marks a flat surface.
    pub normals: Vec<Vec3>,
}

impl MovingMesh {
    /// A mesh with poses at fractions of the shutter interval. Which sides of its triangles are their fronts is decided by the mesh itself, so
    /// that it is the same at all times.
    ///
    /// # Errors
    /// Returns the mesh itself if it does not move: in its only pose, or unchanged if there is no pose.
    pub fn new(mesh: TriangleMesh, mut poses: Vec<Pose>) -> std::result::Result<MovingMesh, TriangleMesh> {
        let Some(last) = poses.pop() else { return Err(mesh) };
        let mut data = Arc::unwrap_or_clone(mesh.data);
        if !mesh.keeps_winding {
            data.triangles = data.triangles.iter().map(|&triangle| data.outward(triangle)).collect();
        }
        let oriented = |data| TriangleMesh { data: Arc::new(data), keeps_winding: true, ..mesh };
        if poses.is_empty() {
            return Err(oriented(MeshData { positions: last.positions, normals: last.normals, ..data }));
        }
        poses.push(last);
        Ok(MovingMesh { mesh: oriented(data), poses })
    }
}

/// The pose at a time.
///
/// - `poses`: at least one, with times that increase
pub fn pose_at(poses: &[Pose], time: f64) -> Pose {
    let place = Place::new(poses, time);
    let all = |of: fn(&Pose) -> &[Vec3]| {
        let (before, after) = (of(&poses[place.before]), of(&poses[place.after]));
        before.iter().zip(after).map(|(a, b)| place.between(*a, *b)).collect()
    };
    Pose { time, positions: all(|pose| &pose.positions), normals: all(|pose| &pose.normals) }
}

/// Place of a time among poses.
#[derive(Clone, Copy)]
struct Place {
    before: usize,
    after: usize,
    /// Share of the way from the pose before to the one after.
    share: f32,
}

impl Place {
    fn new(poses: &[Pose], time: f64) -> Place {
        let after = poses.partition_point(|pose| pose.time <= time);
        if after == 0 || after == poses.len() {
            let only = after.saturating_sub(1);
            return Place { before: only, after: only, share: 0.0 };
        }
        let [start, end] = [poses[after - 1].time, poses[after].time];
        Place { before: after - 1, after, share: ((time - start) / (end - start)) as f32 }
    }

    /// Value between those of the two poses. Rounding never puts it outside of the box around both.
    #[inline]
    fn between(self, a: Vec3, b: Vec3) -> Vec3 {
        (a * (1.0 - self.share) + b * self.share).clamp(a.min(b), a.max(b))
    }
}

impl Geometry for MovingMesh {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let boxes = self.poses.iter().map(|pose| bounds(&pose.positions, to_world));
        boxes.fold(empty, |(low, high), (min, max)| (low.min(min), high.max(max)))
    }

    fn detail(&self, to_world: &Transform) -> Detail {
        self.mesh.detail(to_world)
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        let mesh = &*self.mesh.data;
        let own = [placed_positions(&mesh.positions, to_world), placed_normals(&mesh.normals, to_world)];
        let attributes = self.mesh.attributes(to_world, &own[0], &own[1]);
        let placed = |pose: &Pose| Pose {
            time: pose.time,
            positions: placed_positions(&pose.positions, to_world),
            normals: placed_normals(&pose.normals, to_world),
        };
        let poses: Vec<Pose> = self.poses.iter().map(placed).collect();
        let is_flat = |pose: &Pose| {
            let has_area = |t: &[u32; 3]| triangle::normal(t.map(|v| pose.positions[v as usize])).is_some();
            !attributes.triangles.iter().any(has_area)
        };
        if poses.iter().all(is_flat) {
            return Err(Error::invalid(Fault::new("no usable triangles: all of them are degenerate once placed")));
        }
        let has_normals = !mesh.normals.is_empty();
        Ok(Box::new(BakedMovingMesh { poses, attributes, has_normals, smooth_shadows: self.mesh.smooth_shadows && has_normals }))
    }
}

/// Moving mesh in world space. Its times are fractions of the shutter interval, as those of rays.
struct BakedMovingMesh {
    poses: Vec<Pose>,
    attributes: Attributes,
    has_normals: bool,
    smooth_shadows: bool,
}

impl BakedMovingMesh {
    /// Corners of a triangle at a time. Triangles that share a vertex have the same corner there, to the bit.
    #[inline]
    fn corners(&self, i: u32, time: f32) -> [Vec3; 3] {
        let place = Place::new(&self.poses, time.into());
        let [before, after] = [place.before, place.after].map(|k| &self.poses[k].positions);
        self.attributes.triangles[i as usize].map(|v| place.between(before[v as usize], after[v as usize]))
    }

    /// A triangle at a time.
    fn triangle(&self, i: u32, time: f32) -> MeshTriangle {
        let place = Place::new(&self.poses, time.into());
        let [before, after] = [&self.poses[place.before], &self.poses[place.after]];
        let normal = self.has_normals.then_some(|v: u32| match [before.normals[v as usize], after.normals[v as usize]] {
            normals if normals.contains(&Vec3::ZERO) => Vec3::ZERO,
            [a, b] => place.between(a, b),
        });
        self.attributes.triangle(i, |v| place.between(before.positions[v as usize], after.positions[v as usize]), normal)
    }
}

impl Shape for BakedMovingMesh {
    fn count(&self) -> u32 {
        self.attributes.triangles.len() as u32
    }

    /// The box around all places of the triangle: between two poses its corners stay within the box around both.
    fn bounds(&self, i: u32) -> Aabb {
        let vertices = self.attributes.triangles[i as usize];
        self.poses.iter().fold(Aabb::EMPTY, |all, pose| all.union(Aabb::around(vertices.map(|v| pose.positions[v as usize]))))
    }

    fn area(&self, _: u32) -> f32 {
        0.0
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    fn is_flat(&self, _: u32) -> bool {
        !self.has_normals
    }

    fn intersect(&self, i: u32, ray: &Ray) -> Option<ShapeHit> {
        triangle::intersect(ray, ray.t_max, self.corners(i, ray.time))
    }

    fn point(&self, i: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let point = self.triangle(i, ray.time).at(hit.uv);
        if self.has_normals { point.facing(ray) } else { point }
    }

    fn tangents(&self, i: u32, _: &SurfacePoint, time: f32) -> Option<[Vec3; 2]> {
        self.triangle(i, time).tangents()
    }

    fn normal_change(&self, i: u32, w: Vec2, point: &SurfacePoint, along: Vec3, time: f32) -> Option<Vec3> {
        Some(self.triangle(i, time).normal_change(w, point, along))
    }

    fn instance_normal_change(&self, i: u32, w: Vec2, to_world: &Transform, along: Vec3, time: f32) -> Option<Vec3> {
        Some(self.triangle(i, time).instance_normal_change(w, to_world, along))
    }

    /// A point cannot be sampled without a time.
    fn sample_area(&self, i: u32, _: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.triangle(i, 0.0).at(Vec2::splat(1.0 / 3.0)), AreaPdf::new(0.0))
    }

    fn area_pdf(&self, _: u32, _: &SurfacePoint) -> AreaPdf {
        AreaPdf::new(0.0)
    }

    fn is_sampled(&self) -> bool {
        false
    }

    fn is_moving(&self) -> bool {
        true
    }

    fn part(&self, i: u32, _: Vec2) -> u32 {
        self.attributes.part(i)
    }

    fn has_shading_normals(&self) -> bool {
        self.has_normals
    }

    fn shadow_terminator_offset(&self, i: u32, w: Vec2, point: &SurfacePoint, time: f32) -> f32 {
        self.triangle(i, time).terminator_offset(w, point)
    }

    fn mirroring_swaps_uv(&self) -> bool {
        self.attributes.uvs.is_empty()
    }

    fn instance_shading_normal(&self, i: u32, w: Vec2, to_world: &Transform, ng: Vec3, time: f32) -> Option<Vec3> {
        self.triangle(i, time).instance_shading_normal(w, to_world, ng)
    }

    fn instance_shadow_terminator_offset(&self, i: u32, w: Vec2, to_world: &Transform, point: &SurfacePoint, time: f32) -> f32 {
        self.triangle(i, time).instance_terminator_offset(w, to_world, point)
    }

    fn has_shadow_terminator_offset(&self) -> bool {
        self.smooth_shadows
    }
}
