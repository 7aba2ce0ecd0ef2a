//! Rays in a scene, in double precision.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{Ray, RayCaster};
use crate::error::{Error, Fault, Result};
use crate::math;
use crate::scene::Scene as _;
use crate::shape::{FacetUv, Shape, ShapeHit};
use crate::world::{ShapePlace, World};
use std::sync::Arc;

/// Where a ray meets a shape of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneHit {
    /// Distance, in lengths of the direction.
    pub t: f64,
    /// Index of the shape, as [`World::described_shape`] counts them.
    pub shape: u32,
    /// Index of the primitive within the shape, such as a triangle of a mesh.
    pub primitive: u32,
    /// Coordinates on the primitive: the weights of the second and third corner of a triangle.
    pub uv: DVec2,
    /// Unit geometric normal, to the outside.
    pub normal: DVec3,
    /// Whether the hit was decided by exact arithmetic: that of triangles, quads and boxes is.
    pub is_exact: bool,
}

/// Caster of rays in a scene.
///
/// Flat shapes are in a [`RayCaster`], with all that it guarantees for the corners that the scene has. Curved shapes, disks and solids given by
/// their distance are met as integrators meet them, in single precision. Materials do not count: holes of a masked material are hit.
pub struct SceneCaster {
    world: Arc<World>,
    shapes: Arc<[Box<dyn Shape>]>,
    flat: RayCaster,
    /// Shape, primitive and the mapping of the weights, for each triangle of `flat`.
    origins: Vec<(u32, u32, FacetUv)>,
    /// Shapes that have no flat form, with their number of primitives.
    curved: Vec<(u32, u32)>,
}

impl SceneCaster {
    /// Caster for the shapes of a scene.
    ///
    /// # Errors
    /// `Invalid` for a scene with instances; those of [`RayCaster::new`].
    pub fn new(world: Arc<World>) -> Result<SceneCaster> {
        if world.instance_count() > 0 {
            let message = "rays cannot be cast in scenes with instances or moving shapes yet: list the shapes, or let the shutter close when it opens";
            return Err(Error::invalid(Fault::new(message)));
        }
        let (shapes, origin) = (world.shapes(), world.origin());
        let (mut corners, mut origins, mut curved) = (vec![], vec![], vec![]);
        for (index, shape) in (0..).zip(shapes.iter()) {
            if world.place(index) != ShapePlace::World || world.is_interface(index) {
                continue;
            }
            let first = corners.len();
            for i in 0..shape.count() {
                for (triangle, mapping) in shape.facet(i).triangles() {
                    corners.extend(triangle.map(|p| p.as_dvec3() + origin));
                    origins.push((index, i, mapping));
                }
            }
            if corners.len() == first {
                curved.push((index, shape.count()));
            }
        }
        let count = u32::try_from(corners.len()).unwrap_or(u32::MAX);
        let triangles = (0..count / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Ok(SceneCaster { flat: RayCaster::new(corners, triangles)?, world, shapes, origins, curved })
    }

    /// The first hit.
    pub fn closest(&self, ray: &Ray) -> Option<SceneHit> {
        let flat = self.flat.closest(ray).map(|hit| {
            let (shape, primitive, mapping) = self.origins[hit.triangle as usize];
            let uv = mapping.uv(hit.uv.as_vec2()).as_dvec2();
            let uv = if mapping == FacetUv::Triangle { hit.uv } else { uv };
            SceneHit { t: hit.t, shape, primitive, uv, normal: self.flat.normal(hit.triangle), is_exact: true }
        });
        let end = flat.map_or(ray.t_max, |hit| hit.t);
        self.closest_curved(ray, end).or(flat).map(|hit| SceneHit { shape: self.world.described_shape(hit.shape), ..hit })
    }

    /// The first hits of many rays, on all threads, in the order of the rays.
    pub fn closest_of(&self, rays: &[Ray]) -> Vec<Option<SceneHit>> {
        rays.par_iter().map(|ray| self.closest(ray)).collect()
    }

    /// The first hit with a shape that has no flat form, before `end`.
    fn closest_curved(&self, ray: &Ray, end: f64) -> Option<SceneHit> {
        let length = ray.direction.length();
        if self.curved.is_empty() || !(length.is_normal() && ray.origin.is_finite()) {
            return None;
        }
        let origin = (ray.origin - self.world.origin()).as_vec3();
        let mut own = math::Ray::new(origin, (ray.direction / length).as_vec3());
        own.t_max = (end * length) as f32;
        let mut best: Option<(u32, u32, ShapeHit)> = None;
        for &(shape, count) in &self.curved {
            for i in 0..count {
                if let Some(hit) = self.shapes[shape as usize].intersect(i, &own) {
                    own.t_max = hit.t;
                    best = Some((shape, i, hit));
                }
            }
        }
        best.map(|(shape, primitive, hit)| {
            let point = self.shapes[shape as usize].point(primitive, &own, &hit);
            let uv = hit.uv.as_dvec2();
            SceneHit { t: f64::from(hit.t) / length, shape, primitive, uv, normal: point.ng.as_dvec3(), is_exact: false }
        })
    }
}
