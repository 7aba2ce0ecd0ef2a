//! The hierarchy finds the same hits as a test of every primitive, to the last bit. (Tests in `accel/build.rs` bound the time to build it.)

use glam::{DVec3, Vec3};
use pt::accel::{self, List};
use pt::math::lanes::Width;
use pt::math::{Ray, Transform};
use pt::primitive::{Hit, Primitive};
use pt::shape::{Disk, Geometry, Quad, Shape, Sphere};
use rayon::prelude::*;

use crate::random::Random;
use pt::torture::meshes::{baked, mesh, shapes};

/// Triangles with corners on a small grid (shared edges, coincident, degenerate ones) or anywhere, and duplicates.
fn soup(random: &mut Random, scale: f64) -> Box<dyn Shape> {
    let count = 1 + random.below(60);
    let on_grid = random.below(2) == 0;
    let corner = |random: &mut Random| {
        let p = if on_grid { (random.in_cube() * 2.5).round() } else { random.in_cube() * 2.5 };
        (p * scale).as_vec3()
    };
    // This triangle has an area.
    let mut positions = vec![Vec3::ZERO, Vec3::X * scale as f32, Vec3::Y * scale as f32];
    positions.extend((0..count).map(|_| corner(random)));
    let n = positions.len();
    let mut triangles = vec![[0, 1, 2]];
    triangles.extend((0..count).map(|_| [0; 3].map(|_| random.below(n) as u32)));
    triangles.extend_from_within(..random.below(triangles.len()));
    baked(mesh(positions, triangles))
}

fn placement(random: &mut Random, scale: f64) -> Transform {
    let stretch = DVec3::ONE * scale * if random.below(2) == 0 { DVec3::ONE } else { random.in_cube() + 1.5 };
    let turn = if random.below(2) == 0 { random.rotation() } else { Transform::rotate(DVec3::Y, 90.0).expect("an axis") };
    let to = Transform::translate((random.in_cube() * 2.5).round() * scale).expect("finite");
    Transform::scale(stretch).expect("no factor is zero").then(&turn).then(&to)
}

fn any_shape(random: &mut Random, scale: f64) -> Box<dyn Shape> {
    let at = placement(random, scale);
    match random.below(5) {
        0 => Quad { size: [2.0, 1.0] }.bake(&at),
        1 => Disk { radius: 1.0 }.bake(&at),
        2 => Sphere { radius: 0.7 }.bake(&at),
        _ => return soup(random, scale),
    }
    .expect("an area")
}

/// A ray: in a random direction, along an axis with components 0, −0 and 10⁻⁴⁰, or towards a corner of a bounding box.
fn ray(random: &mut Random, shapes: &[Box<dyn Shape>], scale: f64) -> Ray {
    let shape = &shapes[random.below(shapes.len())];
    let bounds = shape.bounds(random.below(shape.count() as usize) as u32);
    let sides = [bounds.min, bounds.max];
    let mut corner = || Vec3::new(random.pick(&sides).x, random.pick(&sides).y, random.pick(&sides).z);
    let (corner, other) = (corner(), corner());
    let anywhere = (random.in_cube() * 4.0 * scale).as_vec3();
    let origin = match random.below(5) {
        0 => corner,
        1 => corner.with_x(anywhere.x),
        2 => (random.in_cube() * 2.5).round().as_vec3() * scale as f32,
        3 => anywhere * 1000.0,
        _ => anywhere,
    };
    let nothing = [0.0, -0.0, 1e-40, -1e-40];
    let direction = match random.below(4) {
        0 => {
            let mut d = [0.0; 3].map(|_| random.pick(&nothing));
            d[random.below(3)] = random.pick(&[1.0, -1.0]);
            Vec3::from(d)
        }
        1 => (other - origin).try_normalize().unwrap_or(Vec3::X),
        2 => (anywhere - origin).try_normalize().unwrap_or(Vec3::Z),
        _ => random.direction().as_vec3(),
    };
    Ray::new(origin, direction)
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32, [u32; 3])> {
    hit.map(|h| (h.shape, h.primitive, [h.uv.x.to_bits(), h.uv.y.to_bits(), h.t.to_bits()]))
}

fn compare(hierarchy: &dyn Primitive, list: &dyn Primitive, ray: &Ray, seed: u64) -> Option<Hit> {
    let (found, wanted) = (hierarchy.intersect(ray), list.intersect(ray));
    assert_eq!(bits(found), bits(wanted), "seed {seed}, {ray:?}: {found:?} but {wanted:?}");
    assert_eq!(hierarchy.occluded(ray), wanted.is_some(), "seed {seed}, {ray:?}");
    wanted
}

/// The hierarchy finds the hits of the list: the same t, uv and primitive (the lowest of several that are equally near), for any `t_max`.
#[test]
fn the_hierarchy_finds_what_a_linear_search_finds() {
    (0..4000u64).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed);
        let scale = random.pick(&[1.0, 1.0, 1e-6, 1e6, 1e15]);
        let shapes = shapes((0..1 + random.below(8)).map(|_| any_shape(&mut random, scale)).collect());
        let (hierarchy, list) = (accel::build(shapes.clone()), List::new(shapes.clone()));
        for _ in 0..200 {
            let ray = ray(&mut random, &shapes, scale);
            let Some(hit) = compare(&*hierarchy, &list, &ray, seed) else { continue };
            // `t_max` at the hit itself and one float to either side.
            for t_max in [hit.t.next_down(), hit.t, hit.t.next_up(), hit.t * 0.5] {
                compare(&*hierarchy, &list, &Ray { t_max, ..ray }, seed);
            }
        }
    });
}

/// Rays that are traced side by side hit what they hit alone, in every width, for any `t_max`.
#[test]
fn packets_find_what_single_rays_find() {
    (0..2000u64).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed);
        let scale = random.pick(&[1.0, 1.0, 1e-6, 1e6, 1e15]);
        let shapes = shapes((0..1 + random.below(8)).map(|_| any_shape(&mut random, scale)).collect());
        let hierarchy = accel::build(shapes.clone());
        // Some groups have rays from one point into nearby directions, which visit the same nodes.
        let mut rays: Vec<Ray> = (0..100).map(|_| ray(&mut random, &shapes, scale)).collect();
        for first in (0..96).step_by(32) {
            for k in 0..16 {
                let direction = (rays[first].direction + random.direction().as_vec3() * 1e-2).normalize();
                rays[first + k] = Ray { direction, ..rays[first] };
            }
        }
        for ray in rays.clone() {
            let Some(hit) = hierarchy.intersect(&ray) else { continue };
            let t_max = random.pick(&[hit.t.next_down(), hit.t, hit.t.next_up(), hit.t * 0.5]);
            rays.push(Ray { t_max, ..ray });
        }
        for width in Width::available() {
            let hits = accel::intersect_all(&*hierarchy, &rays, width);
            let occluded = accel::occluded_all(&*hierarchy, &rays, width);
            assert_eq!((hits.len(), occluded.len()), (rays.len(), rays.len()));
            for (ray, (found, is_occluded)) in rays.iter().zip(hits.into_iter().zip(occluded)) {
                let wanted = hierarchy.intersect(ray);
                assert_eq!(bits(found), bits(wanted), "seed {seed}, {width:?}, {ray:?}: {found:?} but {wanted:?}");
                assert_eq!(is_occluded, wanted.is_some(), "seed {seed}, {width:?}, {ray:?}");
            }
        }
    });
}

/// Rays with numbers that are not finite, or without a direction, hit nothing and cause no panic.
#[test]
fn invalid_rays_hit_nothing() {
    let mut random = Random::new(1);
    let shapes = shapes((0..8).map(|_| any_shape(&mut random, 1.0)).collect());
    let (hierarchy, list) = (accel::build(shapes.clone()), List::new(shapes));
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for v in bad.into_iter().flat_map(|x| [Vec3::splat(x), Vec3::new(x, 0.5, 0.5), Vec3::new(0.5, 0.5, x)]) {
        for ray in [Ray::new(v, Vec3::Z), Ray::new(v, v), Ray::new(Vec3::ZERO, v), Ray { t_max: f32::NAN, ..Ray::new(Vec3::ZERO, Vec3::Z) }]
        {
            for primitive in [&*hierarchy as &dyn Primitive, &list] {
                assert_eq!(primitive.intersect(&ray), None, "{ray:?}");
                assert!(!primitive.occluded(&ray), "{ray:?}");
            }
        }
    }
    assert_eq!(accel::build(pt::torture::meshes::shapes(vec![])).intersect(&Ray::new(Vec3::ZERO, Vec3::Z)), None);
}

/// Where triangles coincide, the hit is on the one with the lowest index, in whatever order the hierarchy stores them.
#[test]
fn of_coincident_triangles_the_lowest_index_is_hit() {
    let shapes = coincident(1000);
    let hierarchy = accel::build(shapes);
    let hit = hierarchy.intersect(&Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z)).expect("in the middle");
    assert_eq!((hit.shape, hit.primitive), (0, 0));
}

fn coincident(count: usize) -> std::sync::Arc<[Box<dyn Shape>]> {
    shapes(vec![baked(mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]; count]))])
}

/// The corners of a family's k-th triangle.
type Corners = fn(usize) -> [Vec3; 3];

/// Boxes in a row, at few positions, or nested. The test of nested boxes takes quadratic time, so there are few of them.
#[test]
fn hierarchies_of_difficult_boxes_are_correct() {
    fn corner(x: f32) -> [Vec3; 3] {
        [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 0.0, 0.0), Vec3::new(x, 1.0, 0.0)]
    }
    let nested: Corners = |k| [Vec3::ZERO, Vec3::X * (1.0 + k as f32), Vec3::Y * (1.0 + k as f32)];
    let in_line: Corners = |k| [Vec3::X * k as f32, Vec3::X * (k as f32 + 1.0), Vec3::new(k as f32, 1e-3, 0.0)];
    let twisted: Corners = |k| corner(f32::EPSILON * (k % 64) as f32);
    let far_apart: Corners = |k| corner(if k % 2 == 0 { 0.0 } else { 1e9 });
    let families = [(1000, nested), (1000, in_line), (50_000, in_line), (50_000, twisted), (50_000, far_apart)];
    for (n, (count, triangle)) in families.into_iter().enumerate() {
        let positions = (0..count).flat_map(triangle).collect();
        let triangles = (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let shapes = shapes(vec![baked(mesh(positions, triangles))]);
        let hierarchy = accel::build(shapes.clone());
        let list = List::new(shapes.clone());
        let mut random = Random::new(n as u64);
        for _ in 0..50 {
            let ray = ray(&mut random, &shapes, 1.0);
            compare(&*hierarchy, &list, &ray, n as u64);
        }
    }
}
