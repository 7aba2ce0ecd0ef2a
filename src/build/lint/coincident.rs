//! Warnings about surfaces of different shapes that lie in the same place.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec2;

use super::rays::{Met, Numbers, meet, onward, points, scattered};
use super::{Linted, first_few};
use crate::accel;
use crate::bsdf::Passage;
use crate::math::Ray;
use crate::primitive::{Hit, Primitive};
use crate::scene::Scene as _;
use crate::shape::SurfacePoint;
use crate::world::{ShapePlace, World};

/// The number of test points on all shapes together, and the largest number on one shape.
const POINTS: u32 = 1 << 13;
const MOST_POINTS: u32 = 1 << 9;
/// The number of paths from the camera, and the number of surfaces on each.
const PATHS: u32 = 1 << 11;
const VERTICES: u32 = 4;
/// The number of points that rounding at edges may put on two surfaces.
const BY_ROUNDING: u32 = 2;
/// The least |cosine| between the normals of surfaces that lie in the same place. At an angle of more than 2.6° they only cross.
const PARALLEL: f32 = 0.999;
/// The distance within which two surfaces are in the same place: the offset at which rays start from each of the two, and two roundings
/// of the coordinates of each.
const OFFSETS: f32 = 2.0;
const ROUNDINGS: f32 = 4.0;
/// The largest number of primitives of a shape that is looked for behind another, so that scenes load quickly.
const MOST_PRIMITIVES: u32 = 50_000;

/// Warnings about shapes that paths from the camera meet where another shape is, as near as rounding: only one of the two is seen.
///
/// A thing that stands on the ground has its lower face there too, but no path meets either of the two faces. Two opaque faces that
/// scatter alike where they meet look the same. Instances are not tested.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    let pairs = pairs(linted.world);
    if pairs.is_empty() {
        return vec![];
    }
    let said = seen(linted.world, &pairs).into_iter().filter(|&(_, count)| count > BY_ROUNDING).map(|([a, b], _)| {
        format!(
            "{}: has surfaces in the same place as {}: only one of the two is seen there, by the order of the shapes or by rounding; move \
             them apart by a hundred-thousandth of the scene's size, or make them one mesh without the faces between",
            linted.name(a),
            linted.name(b)
        )
    });
    first_few(said.collect(), "more such pairs")
}

/// Pairs of shapes, the lower index first, with random points that are on both.
fn pairs(world: &World) -> BTreeSet<[u32; 2]> {
    let count = world.shapes().len() as u32;
    let each = POINTS.checked_div(count).map_or(0, |each| each.min(MOST_POINTS));
    let mut found = BTreeMap::<[u32; 2], u32>::new();
    for shape in (0..count).filter(|&shape| world.place(shape) == ShapePlace::World && !world.is_interface(shape)) {
        for from in points(world, shape, each) {
            for side in [1.0, -1.0] {
                let (away, near) = (from.point.ng * side, near(world, &from.hit, &from.point));
                let ray = Ray { t_max: 3.0 * near, ..Ray::new(from.point.p + away * (2.0 * near), -away) };
                let Some(Met { hit, surface, .. }) = meet(world, &ray) else { continue };
                if hit.shape != shape && hit.instance.is_none() && surface.point.ng.dot(away).abs() > PARALLEL {
                    *found.entry([shape.min(hit.shape), shape.max(hit.shape)]).or_insert(0) += 1;
                }
            }
        }
    }
    found.into_iter().filter(|&(_, count)| count > BY_ROUNDING).map(|(pair, _)| pair).collect()
}

/// How often paths from the camera meet a place where both shapes of a pair are, and look different.
fn seen(world: &World, pairs: &BTreeSet<[u32; 2]>) -> BTreeMap<[u32; 2], u32> {
    let mut alone = BTreeMap::<u32, Box<dyn Primitive>>::new();
    for shape in pairs.iter().flatten().copied() {
        if world.shapes()[shape as usize].count() <= MOST_PRIMITIVES {
            alone.entry(shape).or_insert_with(|| accel::build_with_instances(world.shapes(), vec![shape], vec![]));
        }
    }
    let mut seen = BTreeMap::new();
    for path in 0..PATHS {
        let mut numbers = Numbers::new(u32::MAX, path);
        let mut ray = world.camera().ray(numbers.pair(), 1.0, Vec2::splat(0.5), 0.0);
        for _ in 0..VERTICES {
            let Some(met) = meet(world, &ray) else { break };
            for pair in pairs.iter().filter(|pair| pair.contains(&met.hit.shape) && met.hit.instance.is_none()) {
                let other = if pair[0] == met.hit.shape { pair[1] } else { pair[0] };
                if alone.get(&other).is_some_and(|other| is_also_here(world, &met, &ray, &**other)) {
                    *seen.entry(*pair).or_insert(0) += 1;
                }
            }
            ray = next(&met, &ray, &mut numbers);
        }
    }
    seen
}

/// Whether another shape is where a ray meets a surface, and looks different.
fn is_also_here(world: &World, met: &Met, ray: &Ray, other: &dyn Primitive) -> bool {
    let Some(hit) = other.intersect(ray) else { return false };
    let (point, surface) = (&met.surface.point, world.surface(ray, &hit));
    let apart = (hit.t - met.hit.t) * ray.direction.dot(point.ng).abs();
    let is_near = apart.abs() <= near(world, &met.hit, point) + f32::EPSILON * hit.t;
    let is_here = is_near && surface.point.ng.dot(point.ng).abs() > PARALLEL;
    let is_opaque = met.passage == Passage::Blocked && world.material(&hit).passage() == Passage::Blocked;
    let is_equal = is_opaque && met.surface.bsdf == surface.bsdf && met.surface.emission.is_none() && surface.emission.is_none();
    is_here && !is_equal
}

/// The distance within which another surface is in the same place as that of a hit (m).
///
/// Rays start at a distance from a surface that covers the rounding of the surface's own coordinates. That distance is 0 for a plane through
/// the origin of the coordinates, while the other surface may be rounded.
fn near(world: &World, hit: &Hit, point: &SurfacePoint) -> f32 {
    let size = world.shapes()[hit.shape as usize].bounds(hit.primitive).magnitude().max_element();
    OFFSETS * point.offset + ROUNDINGS * f32::EPSILON * size
}

/// The path's next ray: on the side from which it came, or on a random one if light passes through the surface.
fn next(met: &Met, ray: &Ray, numbers: &mut Numbers) -> Ray {
    let passes = met.passage != Passage::Blocked && numbers.pair().x < 0.5;
    match (met.passage, passes) {
        (Passage::Sheet, true) => onward(&met.surface.point, ray.direction),
        _ => scattered(&met.surface.point, if met.is_outside != passes { 1.0 } else { -1.0 }, numbers),
    }
}
