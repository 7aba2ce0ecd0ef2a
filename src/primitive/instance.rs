//! Instances: primitives that are stored once and shown at many places.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3};

use super::{Hit, InstanceId, MAX_NESTING, Primitive};
use crate::bsdf::MaterialId;
use crate::math::float::ROUNDING;
use crate::math::transform::greatest_stretch;
use crate::math::{Aabb, AnimatedTransform, Ray, Transform};
use crate::shape::SurfacePoint;

/// Primitives that instances show, in a space of their own.
pub struct Group {
    primitives: Box<dyn Primitive>,
    /// Indices of its own shapes, see [`Group::new`].
    shapes: Range<u32>,
    /// Sphere around the bounding box (m).
    center: DVec3,
    radius: f64,
    /// Greatest |coordinate| in the sphere (m).
    reach: f32,
}

impl Group {
    /// A group of primitives. Their coordinates are most precise if they lie around the origin.
    ///
    /// - `shapes`: indices of the group's own shapes, including those that are not among the primitives because they are copied
    pub fn new(primitives: Box<dyn Primitive>, shapes: Range<u32>) -> Group {
        let bounds = primitives.bounds();
        let (center, radius) = match bounds.is_empty() {
            true => (DVec3::ZERO, 0.0),
            false => {
                (0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3()), 0.5 * (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length())
            }
        };
        Group { center, radius, reach: (center.abs().max_element() + radius) as f32, primitives, shapes }
    }

    /// Number of instances within the group.
    pub fn instance_count(&self) -> u32 {
        self.primitives.instance_count()
    }

    /// Bound of the rounding errors in the group's space, of corners and of rays that enter it (m). Triangles that a ray passes at most that
    /// far outside are hit too.
    pub fn tolerance(&self) -> f32 {
        TOLERANCE * ROUNDING * self.reach
    }
}

/// Roundings of a ray in the space of a group, and of the corners that it meets, in multiples of [`ROUNDING`] times the reach r.
///
/// The origin lies within √3 r, and its rounding has at most that length. That of the unit direction has a length of 1, and acts over at
/// most 3 r. Each corner has an error of √3 r at most, as has the one that touches it in another instance, each in its own direction:
/// 3 √3 r + 3 r < 9 r.
const TOLERANCE: f32 = 9.0;

/// Group at a place, which may move.
pub struct Instance {
    group: Arc<Group>,
    /// Transform from the group's space to the space around it.
    to_outer: AnimatedTransform,
    /// Material of all its surfaces; `None` for those of the group's shapes.
    pub material: Option<MaterialId>,
    /// Number of the instance. Those within the group follow.
    first: u32,
}

/// Ray in the space of a group.
struct GroupRay {
    ray: Ray,
    /// Distance to which the ray is known (m).
    tolerance: f32,
    /// Length in the group's space of the ray's unit of length.
    scale: f64,
    /// Distance by which the origin was moved towards the group, in its space (m).
    start: f64,
}

impl GroupRay {
    /// Distance along the outer ray of a hit at the distance `t`.
    fn outer(&self, t: f32) -> f32 {
        ((f64::from(t) + self.start) / self.scale) as f32
    }
}

impl Instance {
    /// An instance of a group.
    ///
    /// - `first`: number of the instance, which the numbers of the instances within it follow
    pub fn new(group: Arc<Group>, to_outer: impl Into<AnimatedTransform>, material: Option<MaterialId>, first: u32) -> Instance {
        Instance { group, to_outer: to_outer.into(), material, first }
    }

    /// Number of the instance.
    pub fn first(&self) -> u32 {
        self.first
    }

    /// Number of the last instance within this one, or its own.
    pub fn last(&self) -> u32 {
        self.first + self.group.instance_count()
    }

    /// Bounding box in the outer space, over all times.
    pub fn bounds(&self) -> Aabb {
        let inner = self.group.primitives.bounds();
        let [min, max] = self.to_outer.bounds([inner.min.as_dvec3(), inner.max.as_dvec3()]);
        Aabb { min: min.as_vec3(), max: max.as_vec3() }
    }

    /// Nearest hit, see [`Primitive::intersect_with_tolerance`].
    pub fn intersect(&self, ray: &Ray, tolerance: f32) -> Option<Hit> {
        let inner = self.ray(ray, tolerance)?;
        // The next float, so that a hit is not lost whose distance rounds down in the outer space.
        let t_max = inner.ray.t_max.next_up();
        let hit = self.group.primitives.intersect_with_tolerance(&Ray { t_max, ..inner.ray }, inner.tolerance)?;
        let t = inner.outer(hit.t);
        let instance = InstanceId::new(self.first + hit.instance.map_or(0, InstanceId::get));
        (t > 0.0 && t < ray.t_max).then_some(Hit { t, instance, ..hit })
    }

    /// Whether there is a hit, see [`Primitive::occluded_with_tolerance`]. A hit at the end of the ray, within rounding, may count or not.
    pub fn occluded(&self, ray: &Ray, tolerance: f32) -> bool {
        self.ray(ray, tolerance).is_some_and(|inner| self.group.primitives.occluded_with_tolerance(&inner.ray, inner.tolerance))
    }

    /// The ray in the group's space; `None` if it does not come near the group.
    ///
    /// The origin is moved forward to the sphere around the group, so that its rounding is relative to the size of the group and not to
    /// the distance from it.
    fn ray(&self, ray: &Ray, tolerance: f32) -> Option<GroupRay> {
        let Group { center, radius, .. } = *self.group;
        let to_outer = self.to_outer.at(ray.time);
        let to_inner = to_outer.inverse_matrix();
        let origin = to_inner.transform_point3(ray.origin.as_dvec3());
        let direction = to_inner.transform_vector3(ray.direction.as_dvec3());
        let scale = direction.length();
        let direction = direction / scale;
        let to_center = center - origin;
        let along = to_center.dot(direction);
        let tolerance = self.tolerance(tolerance, &to_outer);
        // The last part is the rounding of this computation.
        let radius = radius + f64::from(tolerance) + 8.0 * f64::EPSILON * to_center.length();
        // The comparisons are false also for NaN.
        let is_near = along > -radius && (to_center - direction * along).length_squared() <= radius * radius;
        let start = (along - radius).max(0.0);
        let t_max = (f64::from(ray.t_max) * scale - start) as f32;
        if !(is_near && t_max > 0.0) {
            return None;
        }
        let origin = (origin + direction * start).as_vec3();
        let ray = Ray { origin, from: origin, direction: direction.as_vec3(), t_max, time: ray.time };
        Some(GroupRay { ray, tolerance, scale, start })
    }

    /// Tolerance of rays in the group's space.
    ///
    /// - `outer`: tolerance of the ray in the outer space (m)
    fn tolerance(&self, outer: f32, to_outer: &Transform) -> f32 {
        let own = self.group.tolerance();
        if outer > 0.0 { own + outer * greatest_stretch(to_outer.inverse_matrix().matrix3) as f32 } else { own }
    }
}

/// Instances within each other at a time, the outermost first.
#[derive(Default)]
pub struct Nesting<'a> {
    instances: ArrayVec<&'a Instance, MAX_NESTING>,
    time: f32,
}

impl<'a> Nesting<'a> {
    /// An instance, and the ones within it that `id` names.
    pub(crate) fn new(instance: &'a Instance, id: InstanceId, time: f32) -> Nesting<'a> {
        let inner = InstanceId::new(id.get() - instance.first)
            .map_or_else(Nesting::default, |inner| instance.group.primitives.instance(inner, time));
        // Scenes with deeper nesting are refused.
        Nesting { instances: std::iter::once(instance).chain(inner.instances).take(MAX_NESTING).collect(), time }
    }

    /// Indices of the innermost group's own shapes, see [`Group::new`]; empty without instances.
    pub fn shapes(&self) -> Range<u32> {
        self.instances.last().map_or(0..0, |instance| instance.group.shapes.clone())
    }

    /// Material of all surfaces: that of the outermost instance which has one.
    pub fn material(&self) -> Option<MaterialId> {
        self.instances.iter().find_map(|instance| instance.material)
    }

    /// Transform of each instance to the space around it, the outermost first.
    fn transforms(&self) -> impl DoubleEndedIterator<Item = Cow<'a, Transform>> {
        self.instances.iter().map(|instance| instance.to_outer.at(self.time))
    }

    /// Transform from the innermost group's space to the outermost space.
    pub fn to_outer(&self) -> Transform {
        self.transforms().rev().fold(Transform::IDENTITY, |inner, transform| inner.then(&transform))
    }

    /// Whether the transform to the outermost space mirrors.
    pub fn flips_handedness(&self) -> bool {
        self.transforms().fold(false, |flips, transform| flips ^ transform.flips_handedness())
    }

    /// A surface point of the innermost group in the outermost space. Its shading normal is the geometric one.
    ///
    /// Its offset is more than twice the distance outside of triangles at which rays hit them, so that a ray which starts there does not
    /// hit the surface that it leaves.
    pub fn place(&self, point: &SurfacePoint) -> SurfacePoint {
        let tolerance =
            self.instances.iter().zip(self.transforms()).fold(0.0, |outer, (instance, transform)| instance.tolerance(outer, &transform));
        let point = SurfacePoint { offset: point.offset + 2.0 * tolerance, ..*point };
        self.transforms().rev().fold(point, |point, transform| point.placed(&transform))
    }

    /// A vector of the innermost group in the outermost space.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.transforms().rev().fold(v.as_dvec3(), |v, transform| transform.vector(v)).as_vec3()
    }

    /// A vector of the outermost space in the space of the innermost group.
    pub fn vector_to_local(&self, v: Vec3) -> Vec3 {
        self.transforms().fold(v.as_dvec3(), |v, transform| transform.inverse_matrix().transform_vector3(v)).as_vec3()
    }

    /// A point of the outermost space in the space of the innermost group.
    pub fn point_to_local(&self, p: DVec3) -> Vec3 {
        self.transforms().fold(p, |p, transform| transform.inverse_matrix().transform_point3(p)).as_vec3()
    }

    /// A direction of the outermost space as a unit vector in the space of the innermost group.
    pub fn direction_to_local(&self, w: Vec3) -> Vec3 {
        let within = self.transforms().fold(w.as_dvec3(), |w, transform| transform.inverse_matrix().transform_vector3(w));
        within.normalize().as_vec3()
    }
}
