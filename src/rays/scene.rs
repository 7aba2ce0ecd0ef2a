//! Rays in a scene, in double precision.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use rayon::prelude::*;

use super::tree::Tree;
use super::{Line, Ray, RayCaster};
use crate::error::Result;
use crate::math;
use crate::math::Transform;
use crate::math::transform::greatest_stretch;
use crate::scene::Scene as _;
use crate::shape::{FacetUv, Shape, ShapeHit};
use crate::world::{PlacedGroup, ShapePlace, World};

/// Where a ray meets a shape of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneHit {
    /// Distance, in lengths of the direction.
    pub t: f64,
    /// Index of the shape, as [`World::described_shape`] counts them.
    pub shape: u32,
    /// Index among [`World::placed_groups`] of the instance that shows the shape. `None` for shapes at rest of the scene itself, and for
    /// shapes at rest with emission or a medium, of which each instance has a copy.
    pub instance: Option<u32>,
    /// Index of the primitive within the shape, such as a triangle of a mesh.
    pub primitive: u32,
    /// Coordinates on the primitive: the weights of the second and third corner of a triangle.
    pub uv: DVec2,
    /// Unit geometric normal, to the outside.
    pub normal: DVec3,
    /// Whether the hit was decided by exact arithmetic: that of triangles, quads and boxes is.
    pub is_exact: bool,
}

/// Caster of rays in a scene, as it is when the shutter opens.
///
/// Flat shapes are in a [`RayCaster`], with all that it guarantees for the corners that the scene has. Curved shapes, disks, meshes that change
/// their form, and solids given by their distance are met as integrators meet them, in single precision, one by one. Materials do not count:
/// holes of a masked material are hit.
///
/// What an instance shows is met in the space of its group: the ray is transformed there in f64. No ray slips through a closed mesh of one
/// instance. Between two instances that touch one may pass, because the corners of a group are rounded to f32, to about 10⁻⁷ of its
/// size.
pub struct SceneCaster {
    world: Arc<World>,
    shapes: Arc<[Box<dyn Shape>]>,
    /// Shapes of the scene itself.
    own: ShapeSet,
    /// Shapes of each group that an instance shows.
    groups: Vec<ShapeSet>,
    instances: Vec<PlacedSet>,
    /// Bounding boxes of the instances.
    tree: Tree,
}

/// Shapes in a common space.
struct ShapeSet {
    flat: RayCaster,
    /// Shape, primitive and the mapping of the weights, for each triangle of `flat`.
    sources: Vec<(u32, u32, FacetUv)>,
    /// Shapes that have no flat form, with their number of primitives.
    curved: Vec<(u32, u32)>,
    /// Origin of the coordinates in which the curved shapes are stored (m).
    origin: DVec3,
}

/// Shapes where an instance shows them.
struct PlacedSet {
    /// Index of the instance.
    number: u32,
    /// Index among the groups.
    set: usize,
    to_world: Transform,
}

impl SceneCaster {
    /// Caster for the shapes of a scene.
    ///
    /// # Errors
    /// Those of [`RayCaster::new`].
    pub fn new(world: Arc<World>) -> Result<SceneCaster> {
        let shapes = world.shapes();
        let own = (0..shapes.len() as u32).filter(|shape| world.place(*shape) == ShapePlace::World && !world.is_interface(*shape));
        let own = ShapeSet::new(&shapes, own, world.origin())?;
        let (mut of_group, mut groups, mut instances) = (BTreeMap::new(), vec![], vec![]);
        for (number, PlacedGroup { shapes: range, to_world }) in (0..).zip(world.placed_groups()) {
            let mut shown = range.clone().filter(|shape| world.place(*shape) != ShapePlace::Nowhere).peekable();
            if shown.peek().is_none() {
                continue;
            }
            let set = match of_group.entry(range.start) {
                Entry::Occupied(set) => *set.get(),
                Entry::Vacant(place) => {
                    groups.push(ShapeSet::new(&shapes, shown, DVec3::ZERO)?);
                    *place.insert(groups.len() - 1)
                }
            };
            instances.push(PlacedSet { number, set, to_world });
        }
        let bounds: Vec<[DVec3; 2]> = groups.iter().map(|group| group.bounds(&shapes)).collect();
        let bounded = |instance: &PlacedSet| bounds[instance.set][0].cmple(bounds[instance.set][1]).all();
        instances.retain(bounded);
        let tree = Tree::new(instances.iter().map(|instance| outer_bounds(bounds[instance.set], &instance.to_world)));
        Ok(SceneCaster { world, shapes, own, groups, instances, tree })
    }

    /// All triangles of the scene as one mesh, as they are when the shutter opens: those of its own shapes in their order, then those that each
    /// instance shows. Boundaries of media without a surface are not among them. Returns it with the number of shapes that have no flat form,
    /// counted once for each instance; they are left out.
    ///
    /// # Errors
    /// Those of [`RayCaster::new`].
    pub fn triangles(&self) -> Result<(RayCaster, usize)> {
        let (mut corners, mut curved) = (self.own.flat.positions.clone(), self.own.curved.len());
        for PlacedSet { set, to_world, .. } in &self.instances {
            let (group, to_world) = (&self.groups[*set], to_world.matrix());
            let place = |p: DVec3| to_world.transform_point3(p);
            // Mirroring reverses the order of each triangle's corners as seen from outside; exchanging two corners restores it.
            let order = if to_world.matrix3.determinant() < 0.0 { [0, 2, 1] } else { [0, 1, 2] };
            corners.extend(group.flat.positions.as_chunks::<3>().0.iter().flat_map(|triangle| order.map(|k| place(triangle[k]))));
            curved += group.curved.len();
        }
        Ok((separate(corners)?, curved))
    }

    /// The first hit; of equal distances that of the shapes of the scene itself, or else of the first instance.
    pub fn closest(&self, ray: &Ray) -> Option<SceneHit> {
        let line = Line::new(ray)?;
        let mut best = self.own.closest(&self.shapes, ray);
        self.tree.visit(&line, best.map_or(ray.t_max, |hit| hit.t), |index| {
            // A hit at the same distance counts, if its instance comes first.
            let nearer = Ray { t_max: best.map_or(ray.t_max, |hit| hit.t.next_up()), ..*ray };
            if let Some(hit) = self.closest_of_instance(&self.instances[index as usize], &nearer)
                && best.is_none_or(|best| (hit.t, hit.instance) < (best.t, best.instance))
            {
                best = Some(hit);
            }
            Some(best.map_or(ray.t_max, |hit| hit.t))
        });
        best.map(|hit| SceneHit { shape: self.world.described_shape(hit.shape), ..hit })
    }

    /// The first hits of many rays, on all threads, in the order of the rays.
    pub fn closest_of(&self, rays: &[Ray]) -> Vec<Option<SceneHit>> {
        rays.par_iter().map(|ray| self.closest(ray)).collect()
    }

    /// The first hit with what an instance shows. The direction is transformed without normalizing it, so that t is the same in both spaces.
    fn closest_of_instance(&self, PlacedSet { number, set, to_world }: &PlacedSet, ray: &Ray) -> Option<SceneHit> {
        let to_group: DAffine3 = to_world.inverse_matrix();
        let origin = to_group.transform_point3(ray.origin);
        let within = Ray { origin, direction: to_group.transform_vector3(ray.direction), ..*ray };
        let hit = self.groups[*set].closest(&self.shapes, &within)?;
        Some(SceneHit { instance: Some(*number), normal: to_world.normal(hit.normal), ..hit })
    }
}

impl ShapeSet {
    fn new(shapes: &[Box<dyn Shape>], members: impl Iterator<Item = u32>, origin: DVec3) -> Result<ShapeSet> {
        let (mut corners, mut sources, mut curved) = (vec![], vec![], vec![]);
        for index in members {
            let (shape, first) = (&shapes[index as usize], corners.len());
            for i in 0..shape.count() {
                for (triangle, mapping) in shape.facet(i).triangles() {
                    corners.extend(triangle.map(|p| p.as_dvec3() + origin));
                    sources.push((index, i, mapping));
                }
            }
            if corners.len() == first {
                curved.push((index, shape.count()));
            }
        }
        Ok(ShapeSet { flat: separate(corners)?, sources, curved, origin })
    }

    /// Lower and upper corner of the bounding box.
    fn bounds(&self, shapes: &[Box<dyn Shape>]) -> [DVec3; 2] {
        let of_curved = self.curved.iter().flat_map(|&(shape, count)| {
            let boxes = (0..count).map(move |i| shapes[shape as usize].bounds(i));
            boxes.flat_map(|b| [b.min.as_dvec3() + self.origin, b.max.as_dvec3() + self.origin])
        });
        let corners = (0..self.flat.len() as u32).flat_map(|triangle| self.flat.corners(triangle)).chain(of_curved);
        corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
    }

    /// The first hit, with the shape as the world stores it.
    fn closest(&self, shapes: &[Box<dyn Shape>], ray: &Ray) -> Option<SceneHit> {
        let flat = self.flat.closest(ray).map(|hit| {
            let (shape, primitive, mapping) = self.sources[hit.triangle as usize];
            let uv = mapping.uv(hit.uv.as_vec2()).as_dvec2();
            let uv = if mapping == FacetUv::Triangle { hit.uv } else { uv };
            SceneHit { t: hit.t, shape, instance: None, primitive, uv, normal: self.flat.normal(hit.triangle), is_exact: true }
        });
        let end = flat.map_or(ray.t_max, |hit| hit.t);
        self.closest_curved(shapes, ray, end).or(flat)
    }

    /// The first hit with a shape that has no flat form, before `end`.
    fn closest_curved(&self, shapes: &[Box<dyn Shape>], ray: &Ray, end: f64) -> Option<SceneHit> {
        let length = ray.direction.length();
        if self.curved.is_empty() || !(length.is_normal() && ray.origin.is_finite()) {
            return None;
        }
        let origin = (ray.origin - self.origin).as_vec3();
        let mut own = math::Ray::new(origin, (ray.direction / length).as_vec3());
        own.t_max = (end * length) as f32;
        let mut best: Option<(u32, u32, ShapeHit)> = None;
        for &(shape, count) in &self.curved {
            for i in 0..count {
                if let Some(hit) = shapes[shape as usize].intersect(i, &own) {
                    own.t_max = hit.t;
                    best = Some((shape, i, hit));
                }
            }
        }
        best.map(|(shape, primitive, hit)| {
            let point = shapes[shape as usize].point(primitive, &own, &hit);
            let (t, uv, normal) = (f64::from(hit.t) / length, hit.uv.as_dvec2(), point.ng.as_dvec3());
            SceneHit { t, shape, instance: None, primitive, uv, normal, is_exact: false }
        })
    }
}

/// Caster for triangles that share no corners.
///
/// # Errors
/// Those of [`RayCaster::new`].
fn separate(corners: Vec<DVec3>) -> Result<RayCaster> {
    let count = u32::try_from(corners.len()).unwrap_or(u32::MAX);
    RayCaster::new(corners, (0..count / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Bounding box of a transformed box, larger than that by the roundings of points in it.
fn outer_bounds([low, high]: [DVec3; 2], to_world: &Transform) -> [DVec3; 2] {
    let matrix = to_world.matrix();
    let reach = greatest_stretch(matrix.matrix3) * low.abs().max(high.abs()).length() + matrix.translation.length();
    let [low, high] = to_world.bounds([low, high]);
    [low - 16.0 * f64::EPSILON * reach, high + 16.0 * f64::EPSILON * reach]
}
