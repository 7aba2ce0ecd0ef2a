//! Rays in a scene and in a changed one: which hit the surface that they leave, which meet another surface, and which pass through closed
//! surfaces.

use std::collections::BTreeMap;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::Similarity;
use crate::describe::Names;
use crate::math::Ray;
use crate::primitive::{Hit, InstanceId};
use crate::scene::Scene as _;
use crate::shape::{SurfacePoint, offset_ray_origin};
use crate::torture::Random;
use crate::world::World;

/// Number of paths from the camera, and of straight lines through the scene.
const PATHS: u64 = 1 << 13;
/// Number of rays of a path.
const RAYS: usize = 4;
/// Number of surfaces after which a line is given up.
const MOST_HITS: usize = 256;
/// Difference of two distances that rounding does not make, relative to the shorter one.
const OTHER: f64 = 1e-3;
/// Difference of two distances that rounding can make, relative to the radius of the scene. Rays start a little off their surface, and
/// where they meet the next one at a small angle this moves the hit by many times as much.
const OTHER_PLACE: f64 = 1e-3;
/// Number of offsets within which a hit of the surface that a ray leaves is a mistake.
const NEAR: f32 = 10.0;
/// Share of lines that leave a shape as often as they enter it, above which it is taken as closed.
const CLOSED: f64 = 0.99;

/// What the rays of one scene meet.
pub struct Paths {
    /// For each ray of each path, the distance of its hit in lengths of the unchanged scene; infinite without a hit.
    distances: Vec<[f64; RAYS]>,
    /// Radius of the unchanged scene (m).
    radius: f64,
    /// Number of rays that hit the surface that they leave, by the name of its shape.
    self_hits: BTreeMap<String, u64>,
    /// By the name of a shape: the number of lines that cross it, and of those whose crossings do not alternate between in and out.
    crossings: BTreeMap<String, (u64, u64)>,
}

/// What differs between a changed scene and the scene as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Number of rays that hit the surface that they leave.
    pub self_hits: u64,
    /// Number of paths of which a ray meets another surface than in the scene as it is.
    pub others: u64,
    /// Number of lines that enter a closed shape and do not leave it, or the other way round, beyond those of the scene as it is.
    pub broken: u64,
    /// Name of the shape with most self-hits or broken lines.
    pub worst: Option<String>,
}

impl Paths {
    /// Follows the same rays in each changed scene.
    ///
    /// - `place`: transform from the scene as it is
    /// - `sphere`: centre and radius of a sphere around the scene as it is (m)
    /// - `aspect`: width of the picture over its height
    pub fn follow(world: &World, names: &Names, place: &Similarity, sphere: (DVec3, f64), aspect: f32) -> Paths {
        let paths: Vec<_> = (0..PATHS).into_par_iter().map(|k| path(world, place, aspect, &mut Random::new(k))).collect();
        let lines: Vec<_> = (0..PATHS).into_par_iter().map(|k| line(world, names, place, sphere, &mut Random::new(PATHS + k))).collect();
        let (mut self_hits, mut crossings) = (BTreeMap::new(), BTreeMap::new());
        for hit in paths.iter().flat_map(|(_, hits)| hits) {
            *self_hits.entry(name(names, hit)).or_insert(0) += 1;
        }
        for (shape, is_broken) in lines.into_iter().flatten() {
            let entry: &mut (u64, u64) = crossings.entry(shape).or_insert((0, 0));
            *entry = (entry.0 + 1, entry.1 + u64::from(is_broken));
        }
        Paths { radius: sphere.1, distances: paths.into_iter().map(|(distances, _)| distances).collect(), self_hits, crossings }
    }

    /// Number of paths.
    pub fn count(&self) -> u64 {
        self.distances.len() as u64
    }

    /// What differs from the scene as it is.
    pub fn difference(&self, unchanged: &Paths) -> Difference {
        let is_other = |(a, b): (&f64, &f64)| a != b && (a - b).abs() > OTHER * a.min(*b) + OTHER_PLACE * unchanged.radius;
        let others = self.distances.iter().zip(&unchanged.distances).filter(|(a, b)| a.iter().zip(*b).any(is_other)).count() as u64;
        let is_closed =
            |name: &str| unchanged.crossings.get(name).is_some_and(|(lines, broken)| *broken as f64 <= (1.0 - CLOSED) * *lines as f64);
        let broken = self.crossings.iter().filter(|(name, _)| is_closed(name)).map(|(name, (_, broken))| {
            let before = unchanged.crossings.get(name).map_or(0, |(_, broken)| *broken);
            (name, broken.saturating_sub(before))
        });
        let faults = || broken.clone().chain(self.self_hits.iter().map(|(name, count)| (name, *count)));
        Difference {
            self_hits: self.self_hits.values().sum(),
            others,
            broken: broken.clone().map(|(_, broken)| broken).sum(),
            worst: faults().filter(|(_, count)| *count > 0).max_by_key(|(_, count)| *count).map(|(name, _)| name.clone()),
        }
    }
}

fn name(names: &Names, hit: &Hit) -> String {
    names.shapes.get(hit.shape as usize).cloned().unwrap_or_default()
}

/// A path from the camera: the distances of its hits, and the hits of surfaces that its rays leave.
///
/// At a hit the path goes on in a random direction that does not depend on the surface, so that rounding does not grow along the path.
fn path(world: &World, place: &Similarity, aspect: f32, random: &mut Random) -> ([f64; RAYS], Vec<Hit>) {
    let [film, lens] = [(); 2].map(|()| Vec2::new(random.unit() as f32, random.unit() as f32).min(Vec2::splat(1.0 - f32::EPSILON)));
    let directions: [DVec3; RAYS] = std::array::from_fn(|_| random.direction());
    let (mut distances, mut self_hits) = ([f64::INFINITY; RAYS], vec![]);
    let mut ray = world.camera().ray(film, aspect, lens, 0.0);
    let mut left: Option<(Hit, f32)> = None;
    for (distance, direction) in distances.iter_mut().zip(directions) {
        let Some(hit) = world.intersect(&ray) else { break };
        let surface = world.surface(&ray, &hit);
        let length = ray.length(hit.t, surface.point.ng);
        *distance = f64::from(length) / place.scale;
        self_hits.extend(left.filter(|(left, offset)| is_self_hit(world, left, &hit, length, *offset)).map(|_| hit));
        let mut onward = (place.turn * direction).as_vec3();
        // Behind opaque surfaces, where pictures show nothing, faces may coincide: a thing and the ground under it.
        if !surface.transmits && onward.dot(surface.point.ng) * ray.direction.dot(surface.point.ng) > 0.0 {
            onward = -onward;
        }
        // Below zero where the ray leaves a curved surface to its inner side, which may be hit again.
        let side = if onward.dot(surface.point.ng) > 0.0 { surface.point.offset } else { -1.0 };
        left = Some((hit, side));
        ray = surface.spawn(onward, 0.0);
    }
    (distances, self_hits)
}

fn is_self_hit(world: &World, left: &Hit, hit: &Hit, length: f32, offset: f32) -> bool {
    let is_same = (left.instance, left.shape, left.primitive) == (hit.instance, hit.shape, hit.primitive);
    is_same && (world.shapes()[hit.shape as usize].is_flat(hit.primitive) || length < NEAR * offset)
}

/// A straight line through the scene: for each shape that it crosses, whether its crossings fail to alternate between in and out.
fn line(world: &World, names: &Names, place: &Similarity, (center, radius): (DVec3, f64), random: &mut Random) -> Vec<(String, bool)> {
    let from = center + 1.5 * radius * random.direction();
    let through = center + radius * random.unit().cbrt() * random.direction();
    let origin = (place.point(from) - world.origin()).as_vec3();
    let direction = (place.turn * (through - from)).normalize().as_vec3();
    let mut ray = Ray::new(origin, direction);
    let mut crossings = Crossings { direction, of_shapes: BTreeMap::new() };
    for _ in 0..MOST_HITS {
        let Some(hit) = world.intersect(&ray) else {
            return crossings.of_shapes.values().map(|(hit, inside, is_broken)| (name(names, hit), *is_broken || *inside != 0)).collect();
        };
        let point = world.surface(&ray, &hit).point;
        crossings.add(hit, &point);
        ray = Ray::new(offset_ray_origin(&point, direction), direction);
        // The new start may be beyond a face of another shape that coincides with this one, such as the ground under a thing.
        let back = Ray { t_max: 1.5 * point.offset / direction.dot(point.ng).abs(), ..Ray::new(ray.origin, -direction) };
        if let Some(skipped) = world.intersect(&back).filter(|other| (other.instance, other.shape) != (hit.instance, hit.shape)) {
            crossings.add(skipped, &world.surface(&back, &skipped).point);
        }
    }
    vec![]
}

/// What a line crosses.
struct Crossings {
    direction: Vec3,
    /// For each shape: a hit, the number of ways in less that of ways out, and whether that ever was another number than 0 and 1.
    of_shapes: BTreeMap<(Option<InstanceId>, u32), (Hit, i32, bool)>,
}

impl Crossings {
    fn add(&mut self, hit: Hit, point: &SurfacePoint) {
        let (_, inside, is_broken) = self.of_shapes.entry((hit.instance, hit.shape)).or_insert((hit, 0, false));
        *inside += if self.direction.dot(point.ng) < 0.0 { 1 } else { -1 };
        *is_broken |= !(0..=1).contains(inside);
    }
}
