//! Surfaces of shapes that instances show. They are found in the space of the group, and placed in the world.

use std::ops::Range;

use glam::{DVec3, Vec2Swizzles as _, Vec3};

use super::{PreparedMaterial, World, length_inside};
use crate::bsdf::HitContext;
use crate::math::{Ray, Transform};
use crate::primitive::{Hit, InstanceId, Nesting};
use crate::scene::Surface;
use crate::shape::{Shape, ShapeHit, SurfacePoint};
use crate::texture::{Footprint, TextureContext};

/// Shapes of a group where an instance shows them.
pub struct PlacedGroup {
    /// Indices of the shapes. Those that show elsewhere, as copies, have the place [`ShapePlace::Nowhere`](super::ShapePlace::Nowhere).
    pub shapes: Range<u32>,
    /// Transform from the coordinates in which the shapes are stored to the user's, when the shutter opens.
    pub to_world: Transform,
}

impl World {
    /// Groups that instances show, in the order of their [`InstanceId`]s, of which the first is 1.
    ///
    /// In each space the instances that were added come first, and then one for each set of objects that move together; those within an instance
    /// follow it. Moving copies of shapes with emission come last.
    pub fn placed_groups(&self) -> impl Iterator<Item = PlacedGroup> {
        let to_user = Transform::translate(self.origin).unwrap_or(Transform::IDENTITY);
        (1..=self.hierarchy.instance_count()).filter_map(InstanceId::new).map(move |id| {
            let nesting = self.hierarchy.instance(id, 0.0);
            PlacedGroup { shapes: nesting.shapes(), to_world: nesting.to_outer().then(&to_user) }
        })
    }

    /// Surface point of a hit of an instance.
    #[inline(never)]
    pub(super) fn point_of_instance(&self, id: InstanceId, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (nesting, shape) = (self.hierarchy.instance(id, ray.time), &*self.shapes[hit.shape as usize]);
        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t);
        let mut point = nesting.place(&point_in_group(shape, &nesting, p, ray, hit));
        if swaps_uv(shape, &nesting) {
            point.uv = point.uv.yx();
        }
        if !shape.has_shading_normals() {
            return point;
        }
        let ns = shape.instance_shading_normal(hit.primitive, hit.uv, &nesting.to_outer(), point.ng, ray.time);
        SurfacePoint { ns: ns.unwrap_or(point.ng), ..point }.facing(ray)
    }

    /// Surface at a point of an instance, see [`World::surface_at`]. It emits light if it moves: other instances of emitting shapes are copies
    /// in the world.
    #[inline(never)]
    pub(super) fn surface_of_instance(
        &self,
        id: InstanceId,
        point: SurfacePoint,
        footprint: Option<Footprint>,
        ray: &Ray,
        view: &Ray,
        hit: &Hit,
    ) -> Surface<'_> {
        let nesting = self.hierarchy.instance(id, ray.time);
        let material = nesting.material().unwrap_or_else(|| self.part_appearance(hit).material);
        let prepared = &self.materials[material.0 as usize];
        let bsdf = prepared.uniform.unwrap_or_else(|| {
            prepared.surface.material.bsdf_at(&HitContext {
                texture: TextureContext { footprint, ..TextureContext::exact(&point) },
                inside: length_inside(ray, hit, &point),
                wavelength: None,
            })
        });
        let (appearance, part) = (&self.appearances[hit.shape as usize], self.part_appearance(hit));
        let emission = part.emitter.as_ref().map(|e| (e.at(&TextureContext::exact(&point)), appearance.first_light + hit.primitive));
        let mut surface = prepared.surface(point, bsdf, emission);
        let has_offset = self.appearances[hit.shape as usize].has_shadow_terminator_offset;
        if has_offset || prepared.needs_tangents {
            self.set_frame_of_instance(&mut surface, prepared, (id, &nesting), view, hit);
        }
        surface
    }

    /// Sets the shadow terminator offset and the tangent frame of an instance's surface, as `with_shading_frame` does for others.
    fn set_frame_of_instance(
        &self,
        surface: &mut Surface,
        prepared: &PreparedMaterial,
        (id, nesting): (InstanceId, &Nesting),
        view: &Ray,
        hit: &Hit,
    ) {
        let shape = &*self.shapes[hit.shape as usize];
        if self.appearances[hit.shape as usize].has_shadow_terminator_offset {
            let offset = shape.instance_shadow_terminator_offset(hit.primitive, hit.uv, &nesting.to_outer(), &surface.point, view.time);
            surface.set_shadow_origin(offset, view);
        }
        if prepared.needs_tangents {
            let tangents = self.tangents_of_instance(id, &surface.point, view, hit);
            prepared.set_shading_frame(surface, tangents, view);
        }
    }

    /// Derivatives of the position by the texture coordinates at a hit of an instance (m).
    #[inline(never)]
    pub(super) fn tangents_of_instance(&self, id: InstanceId, point: &SurfacePoint, view: &Ray, hit: &Hit) -> Option<[Vec3; 2]> {
        let (nesting, shape) = (self.hierarchy.instance(id, view.time), &*self.shapes[hit.shape as usize]);
        let within = self.point_in_group_of(&nesting, point, view, hit);
        let mut tangents = shape.tangents(hit.primitive, &within, view.time).map(|tangents| tangents.map(|t| nesting.vector(t)));
        if swaps_uv(shape, &nesting) {
            tangents.iter_mut().for_each(|tangents| tangents.reverse());
        }
        tangents
    }

    /// The point of a hit in the space of the group.
    pub(super) fn point_in_group_of(&self, nesting: &Nesting, point: &SurfacePoint, view: &Ray, hit: &Hit) -> SurfacePoint {
        point_in_group(&*self.shapes[hit.shape as usize], nesting, point.p.as_dvec3(), view, hit)
    }

    /// A point of a shape where a hit finds it when the shutter opens: of an instance in the world, of other shapes as it is.
    pub fn placed(&self, hit: &Hit, point: SurfacePoint) -> SurfacePoint {
        hit.instance.map_or(point, |id| self.hierarchy.instance(id, 0.0).place(&point))
    }
}

/// Whether the texture coordinates u and v of a copy at this place would be swapped.
fn swaps_uv(shape: &dyn Shape, nesting: &Nesting) -> bool {
    shape.mirroring_swaps_uv() && nesting.flips_handedness()
}

/// Surface point of a hit in the space of the group.
///
/// - `p`: position of the hit in the world
/// - `ray`: ray in the direction from which the surface is seen
fn point_in_group(shape: &dyn Shape, nesting: &Nesting, p: DVec3, ray: &Ray, hit: &Hit) -> SurfacePoint {
    let (origin, direction) = (nesting.point_to_local(p), nesting.direction_to_local(ray.direction));
    let ray = Ray { origin, from: origin, direction, ..*ray };
    shape.point(hit.primitive, &ray, &ShapeHit { t: 0.0, uv: hit.uv })
}
