//! The bodies with media that contain a point, and those that a path enters or leaves at a surface.

use std::collections::BTreeSet;

use glam::Vec3;

use super::World;
use crate::accel;
use crate::math::{Aabb, Ray};
use crate::medium::{Boundaries, Boundary, Inside, InterfaceCrossing, MOST_BODIES, Media};
use crate::primitive::{Hit, Primitive};
use crate::shape::{Shape, SurfacePoint, offset_ray_origin};

/// Bodies that may touch each other.
///
/// Rays start off the surface that they leave, and so beyond all surfaces in the same place. A path that crosses the surface of a body
/// therefore looks there for the surfaces of other bodies, each in a hierarchy of its own.
pub(super) struct Touching {
    /// Other bodies whose boxes touch that of each body.
    neighbours: Vec<Vec<u16>>,
    /// Surface of each body that is a neighbour.
    surfaces: Vec<Option<Box<dyn Primitive>>>,
}

/// Share of the coordinates by which boxes may lie apart and still count as touching: a few roundings.
const APART: f32 = 8.0 * f32::EPSILON;

/// Greatest number of neighbours of a body; surfaces of further ones are not found where they touch.
const MOST_NEIGHBOURS: usize = 64;

impl Touching {
    /// Bodies that may touch each other; `None` if none do.
    pub fn new(media: &Media, shapes: &std::sync::Arc<[Box<dyn Shape>]>) -> Option<Touching> {
        let bounds: Vec<(u16, Aabb)> = media.bodies().map(|(body, shape)| (body, padded(&*shapes[shape as usize]))).collect();
        let whole = bounds.iter().fold(Aabb::EMPTY, |all, (_, bounds)| all.union(*bounds));
        // Along the longest axis the fewest boxes overlap.
        let axis = (whole.max - whole.min).max_position();
        let mut sorted = bounds;
        sorted.sort_by(|(_, a), (_, b)| a.min[axis].total_cmp(&b.min[axis]));
        let mut neighbours = vec![vec![]; sorted.len()];
        for (i, (body, bounds)) in sorted.iter().enumerate() {
            for (other, others) in sorted[i + 1..].iter().take_while(|(_, others)| others.min[axis] <= bounds.max[axis]) {
                if bounds.min.cmple(others.max).all() && others.min.cmple(bounds.max).all() {
                    neighbours[usize::from(*body)].push(*other);
                    neighbours[usize::from(*other)].push(*body);
                }
            }
        }
        neighbours.iter_mut().for_each(|list: &mut Vec<u16>| list.truncate(MOST_NEIGHBOURS));
        let named: BTreeSet<u16> = neighbours.iter().flatten().copied().collect();
        if named.is_empty() {
            return None;
        }
        let surface = |(body, shape)| named.contains(&body).then(|| accel::build_with_instances(shapes.clone(), vec![shape], vec![]));
        Some(Touching { surfaces: media.bodies().map(surface).collect(), neighbours })
    }
}

/// Bounds of a shape, and a few roundings more.
fn padded(shape: &dyn Shape) -> Aabb {
    let bounds = (0..shape.count()).fold(Aabb::EMPTY, |all, i| all.union(shape.bounds(i)));
    let room = bounds.min.abs().max(bounds.max.abs()) * APART;
    Aabb { min: bounds.min - room, max: bounds.max + room }
}

/// Directions of the rays that look for the bodies around a point. They are parallel to no axis and no diagonal, since edges of objects
/// often are.
const DIRECTIONS: [[f32; 3]; 3] = [[0.817_3, 0.423_1, 0.390_7], [-0.571_9, 0.653_3, -0.496_1], [0.119_9, -0.744_7, 0.656_5]];

/// Greatest number of surfaces that such a ray passes.
const MOST_SURFACES: usize = 2 * MOST_BODIES;

impl World {
    /// Surfaces of bodies at the point of a hit: that which was hit, and those in the same place.
    pub(super) fn boundaries_at(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries {
        let mut found = Boundaries::new();
        let Some(media) = &self.media else { return found };
        // The probe goes from below the surface to above it. Half its length is twice the distance at which rays start off the surface, which
        // is 0 for planes through the origin, and the rounding of other surfaces that may be there.
        let size = self.shapes[hit.shape as usize].bounds(hit.primitive).magnitude().max_element();
        let near = 2.0 * point.offset + APART * size;
        let probe = Ray { t_max: 2.0 * near, ..Ray::new(point.p - point.ng * near, point.ng) };
        let first = match media.body(hit.shape).filter(|_| hit.instance.is_none()) {
            Some(body) => Some(Boundary { normal: point.ng, body }),
            None => self.interfaces.as_ref().and_then(|interfaces| {
                let hit = interfaces.intersect(&probe)?;
                Some(Boundary { normal: self.point(&probe, &hit).ng, body: media.body(hit.shape)? })
            }),
        };
        let Some(first) = first else { return found };
        found.push(first);
        let Some(touching) = &self.touching else { return found };
        for other in &touching.neighbours[usize::from(first.body)] {
            let Some(surface) = &touching.surfaces[usize::from(*other)] else { continue };
            if let Some(hit) = surface.intersect(&probe) {
                let _ = found.try_push(Boundary { normal: self.point(&probe, &hit).ng, body: *other });
            }
        }
        found
    }

    /// First interface on a ray.
    pub(super) fn interface_on(&self, ray: &Ray) -> Option<InterfaceCrossing> {
        let hit = self.interfaces.as_ref()?.intersect(ray)?;
        let point = self.point(ray, &hit);
        let origin = offset_ray_origin(&point, ray.direction);
        let t_max = ray.t_max - (origin - ray.origin).dot(ray.direction);
        let onward = Ray { origin, from: point.p, t_max, ..*ray };
        Some(InterfaceCrossing { length: ray.length(hit.t, point.ng), boundaries: self.boundaries_at(&hit, &point), onward })
    }

    /// Bodies with media around a point. Of three rays from it, at least two must cross the surface of a body first from inside to outside;
    /// so a ray through an edge does no harm.
    pub(super) fn bodies_containing(&self, p: Vec3) -> Inside {
        let found = DIRECTIONS.map(|direction| self.left_along(p, Vec3::from(direction).normalize()));
        let mut inside = Inside::default();
        for body in found.iter().flatten() {
            let votes = found.iter().filter(|bodies| bodies.contains(body)).count();
            inside.set(*body, votes >= 2);
        }
        inside
    }

    /// Bodies whose surface a ray meets first from within.
    fn left_along(&self, p: Vec3, direction: Vec3) -> Vec<u16> {
        let (mut met, mut left) = (BTreeSet::new(), vec![]);
        let mut ray = Ray::new(p, direction);
        for _ in 0..MOST_SURFACES {
            let solid = self.hierarchy.intersect(&ray);
            let until = Ray { t_max: solid.map_or(f32::INFINITY, |hit| hit.t), ..ray };
            let interface = self.interfaces.as_ref().and_then(|interfaces| interfaces.intersect(&until));
            let Some(hit) = interface.or(solid) else { break };
            let point = self.point(&ray, &hit);
            for Boundary { normal, body } in self.boundaries_at(&hit, &point) {
                let leaves = met.insert(body) && normal.dot(direction) > 0.0;
                left.extend(leaves.then_some(body));
            }
            ray = Ray::new(offset_ray_origin(&point, direction), direction);
        }
        left
    }
}
