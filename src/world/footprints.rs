//! Surfaces with the part of them that a camera ray stands for.

use glam::Vec3;

use super::World;
use crate::math::{Ray, RayDifferential, SurfaceDifferential};
use crate::primitive::Hit;
use crate::scene::Surface;
use crate::shape::{SurfacePoint, unit_change};
use crate::texture::Footprint;

impl World {
    /// See [`Scene::surface_with_footprint`](crate::scene::Scene::surface_with_footprint).
    #[inline(never)]
    pub(super) fn surface_with_footprint(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &RayDifferential,
    ) -> (Surface<'_>, Option<SurfaceDifferential>) {
        let (point, prepared) = (self.point(ray, hit), self.prepared_material(hit));
        let p = differential.on_plane(ray.direction, hit.t, point.ng);
        let is_found = p.iter().all(|side| side.is_finite());
        let looks_up = prepared.uniform.is_none() && is_found;
        let footprint = looks_up.then(|| Footprint::new(p, self.tangents(&point, ray, hit)));
        let surface = self.surface_at(point, footprint, ray, ray, hit);
        // The derivatives of normal and bump maps are not known.
        let goes_on = prepared.has_delta_lobes && prepared.surface.normal_modifier.is_none() && is_found;
        let at = |[a, b]: [Vec3; 2]| {
            let n = [self.normal_change(&point, ray, hit, a)?, self.normal_change(&point, ray, hit, b)?];
            Some(SurfaceDifferential { p, n, direction: differential.direction })
        };
        (surface, goes_on.then_some(p).and_then(at))
    }

    /// Change of the shading normal at a hit when the point moves by `along` (m).
    fn normal_change(&self, point: &SurfacePoint, ray: &Ray, hit: &Hit, along: Vec3) -> Option<Vec3> {
        let shape = &*self.shapes[hit.shape as usize];
        let Some(id) = hit.instance else { return shape.normal_change(hit.primitive, hit.uv, point, along, ray.time) };
        let nesting = self.hierarchy.instance(id, ray.time);
        let to_world = nesting.to_outer();
        if let Some(change) = shape.instance_normal_change(hit.primitive, hit.uv, &to_world, along, ray.time) {
            return Some(change);
        }
        let within = self.point_in_group_of(&nesting, point, ray, hit);
        let change = shape.normal_change(hit.primitive, hit.uv, &within, nesting.vector_to_local(along), ray.time)?;
        // Normals are placed by the inverse transpose.
        let to_outer = to_world.inverse_matrix().matrix3.transpose();
        let [normal, change] = [within.ns, change].map(|v| to_outer * v.as_dvec3());
        let turned = unit_change(normal, change).as_vec3();
        Some(if point.ns.as_dvec3().dot(normal) < 0.0 { -turned } else { turned })
    }
}
