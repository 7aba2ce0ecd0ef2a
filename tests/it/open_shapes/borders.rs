//! Where two surfaces meet at a border, no ray passes between them.

use glam::{DMat3, DMat4, DVec3};
use pt::accel;
use pt::math::{Ray, Transform};
use pt::primitive::Primitive;
use pt::shape::{BilinearPatch, Cone, Cylinder, Disk, Geometry, PartialDisk, PartialSphere, Shape};
use pt::torture::meshes::shapes;
use rayon::prelude::*;

use crate::random::Random;

/// Whole-numbered sides of a triangle. Rays along (a, b) have f32 directions that meet a border at the angle atan(b/a) in f64 rounding.
const DIRECTIONS: [[i32; 2]; 6] = [[1, 0], [3, 4], [-5, 12], [-8, -15], [0, 1], [20, -21]];

fn degrees([a, b]: [i32; 2]) -> f64 {
    f64::from(b).atan2(f64::from(a)).to_degrees().rem_euclid(360.0)
}

/// A whole body in several parts.
type Body = Vec<(Box<dyn Geometry>, Transform)>;

fn turned(degrees: f64) -> Transform {
    Transform::rotate(DVec3::Z, degrees).expect("an axis")
}

fn raised(z: f64) -> Transform {
    Transform::translate(DVec3::Z * z).expect("finite")
}

fn over() -> Transform {
    Transform::rotate(DVec3::X, 180.0).expect("an axis")
}

/// A capsule with a pointed end: part of a cylinder from z = −1 to 1, half a sphere below it, and a cone of height 2 on it; all of them in
/// two parts that meet at the angles 0 and `cut`. A ray from inside that leaves is a leak.
fn capsule(cut: f64) -> Body {
    let mut body: Body = vec![];
    for (from, phi_max) in [(0.0, cut), (cut, 360.0 - cut)] {
        body.push((Box::new(Cylinder { radius: 1.0, z: [-1.0, 1.0], phi_max }), turned(from)));
        body.push((Box::new(Cone { radius: 1.0, height: 2.0, phi_max }), turned(from).then(&raised(1.0))));
        for z in [[-1.0, -0.625], [-0.625, 0.0]] {
            body.push((Box::new(PartialSphere { radius: 1.0, z, phi_max }), turned(from).then(&raised(-1.0))));
        }
    }
    body
}

/// A can: a cylinder with a disk at one end, and at the other a ring with a disk in its hole.
fn can() -> Body {
    let tube = Cylinder { radius: 1.0, z: [-1.0, 1.0], phi_max: 360.0 };
    let mut body: Body = vec![(Box::new(tube), Transform::IDENTITY), (Box::new(Disk { radius: 1.0 }), over().then(&raised(-1.0)))];
    for (from, phi_max) in [(0.0, degrees([-5, 12])), (degrees([-5, 12]), 360.0 - degrees([-5, 12]))] {
        body.push((Box::new(PartialDisk { radius: 1.0, inner_radius: 0.5, phi_max }), turned(from).then(&raised(1.0))));
    }
    body.push((Box::new(Disk { radius: 0.5 }), raised(1.0)));
    body
}

/// A box with twisted faces, each of which is a bilinear patch with its corners in another order.
///
/// - `corners`: those with x, y and z of −1 or 1, counted in binary
fn box_of(corners: [DVec3; 8]) -> Body {
    let faces = [[0, 1, 2, 3], [4, 6, 5, 7], [0, 4, 1, 5], [3, 7, 2, 6], [6, 4, 2, 0], [1, 5, 3, 7]];
    let patch = |face: [usize; 4]| Box::new(BilinearPatch { corners: face.map(|k| corners[k]) }) as Box<dyn Geometry>;
    faces.map(|face| (patch(face), Transform::IDENTITY)).into()
}

/// A corner of the box [−1, 1]³, by number.
fn corner(k: usize) -> DVec3 {
    DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64) * 2.0 - 1.0
}

fn hierarchy(body: &Body, place: &Transform) -> Box<dyn Primitive> {
    let bake = |(geometry, own): &(Box<dyn Geometry>, Transform)| geometry.bake(&own.then(place)).expect("an area");
    accel::build(shapes(body.iter().map(bake).collect::<Vec<Box<dyn Shape>>>()))
}

fn leaks(hierarchy: &dyn Primitive, ray: &Ray) -> bool {
    hierarchy.intersect(ray).is_none() || !hierarchy.occluded(ray)
}

/// Sizes and places: in f32 without rounding, so that rays along borders stay on them.
const PLACES: [(f64, f64); 5] = [(1.0, 0.0), (9.5367431640625e-7, 0.0), (1048576.0, 0.0), (16.0, 1024.0), (4096.0, 1048576.0)];

/// Rays from a point of the axis exactly along the borders: in the planes at which parts are cut, and towards rims.
#[test]
fn no_ray_along_a_border_passes_between() {
    for cut in DIRECTIONS {
        let angle = if cut == [1, 0] { 180.0 } else { degrees(cut) };
        let mut random = Random::new(1);
        for (size, shift) in PLACES {
            let place =
                Transform::scale(DVec3::splat(size)).expect("not zero").then(&Transform::translate(DVec3::splat(shift)).expect("finite"));
            for (body, ends) in [(capsule(angle), [-2.0, 3.0]), (can(), [-1.0, 1.0])] {
                let hierarchy = hierarchy(&body, &place);
                for k in 0..20_000 {
                    // A height of few binary digits, so that the sum with the shift is exact.
                    let z = ends[0] + (ends[1] - ends[0]) * (random.range(1.0, 63.0).floor() / 64.0);
                    let direction = match k % 3 {
                        0 => DVec3::new(cut[0].into(), cut[1].into(), random.range(-64.0, 64.0).floor() / 8.0),
                        1 => DVec3::new(random.range(-64.0, 64.0).floor(), 0.0, random.range(-64.0, 64.0).floor() / 8.0),
                        // To a rim, at a whole-numbered direction, as near as f32 goes.
                        _ => {
                            let [a, b] = random.pick(&DIRECTIONS);
                            let (across, rim) = (DVec3::new(a.into(), b.into(), 0.0), random.pick(&[-1.0, 1.0, -1.625]));
                            across + DVec3::Z * ((rim - z) * across.length())
                        }
                    };
                    if direction == DVec3::ZERO {
                        continue;
                    }
                    let origin = place.point(DVec3::Z * z);
                    let ray = Ray::new(origin.as_vec3(), direction.as_vec3());
                    assert_eq!(ray.origin.as_dvec3(), origin, "a place without rounding");
                    assert!(!leaks(&*hierarchy, &ray), "cut {angle}, size {size}, {ray:?}");
                }
            }
        }
    }
}

/// Rays exactly at points of the edges of a twisted box, whose corners are of few binary digits.
#[test]
fn no_ray_at_an_edge_of_patches_passes_between() {
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let coarse = |p: DVec3| (p * 16.0).round() / 16.0;
        let corners: [DVec3; 8] = std::array::from_fn(|k| corner(k) + coarse(random.in_cube() * 0.3));
        for (size, shift) in PLACES {
            let place =
                Transform::scale(DVec3::splat(size)).expect("not zero").then(&Transform::translate(DVec3::splat(shift)).expect("finite"));
            let hierarchy = hierarchy(&box_of(corners), &place);
            for (from, bit, k) in
                (0..8usize).flat_map(|from| [1, 2, 4].map(|bit| (from, bit))).flat_map(|(a, b)| (0..=8u32).map(move |k| (a, b, k)))
            {
                let target = corners[from].lerp(corners[from ^ bit], f64::from(k) / 8.0);
                let inside = coarse(random.in_cube() * 0.4);
                let ray = Ray::new(place.point(inside).as_vec3(), (target - inside).as_vec3());
                assert!(ray.origin.as_dvec3() == place.point(inside) && ray.direction.as_dvec3() == target - inside, "no rounding");
                assert!(!leaks(&*hierarchy, &ray), "seed {seed}, size {size}: {ray:?} to {target}");
            }
        }
    }
}

/// Rays at random points of borders, as exactly as f32 allows, from random points inside of bodies that are stretched, sheared and turned.
#[test]
fn no_ray_at_a_border_passes_between() {
    let lost: usize = (0..64u64).into_par_iter().map(lost_at_borders).sum();
    assert_eq!(lost, 0, "of 2.56·10⁶ rays");
}

fn lost_at_borders(seed: u64) -> usize {
    let mut random = Random::new(seed);
    let cut = random.range(20.0, 340.0);
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.4, 1.0, 0.0), DVec3::new(0.2, -0.3, 1.3));
    let shear = Transform::from_matrix(DMat4::from_mat3(shear)).expect("not singular").then(&random.rotation());
    let size = random.decade(-4.0, 4.0);
    let shift = random.direction() * size * random.pick(&[0.0, 1.0, 1e3]);
    let place = shear.then(&Transform::scale(DVec3::splat(size)).expect("not zero"));
    let place = place.then(&Transform::translate(shift).expect("finite"));
    let corners: [DVec3; 8] = std::array::from_fn(|k| corner(k) + random.in_cube() * 0.3);
    let bodies = [capsule(cut), can(), box_of(corners)].map(|body| hierarchy(&body, &place));
    let mut lost = 0;
    for _ in 0..40_000 {
        let kind = random.below(3);
        let around = |phi: f64, rho: f64, z: f64| {
            let (sin, cos) = phi.to_radians().sin_cos();
            DVec3::new(rho * cos, rho * sin, z)
        };
        let any = random.range(0.0, 360.0);
        let (inside, target) = match kind {
            0 => {
                let seam = random.pick(&[0.0, cut]);
                let targets = [
                    around(seam, 1.0, random.range(-1.0, 1.0)),
                    around(any, 1.0, 1.0),
                    around(any, 1.0, -1.0),
                    around(any, (1.0f64 - 0.625 * 0.625).sqrt(), -1.625),
                    around(seam, 1.0, 1.0),
                    DVec3::new(0.0, 0.0, random.pick(&[3.0, -2.0])),
                ];
                (DVec3::new(0.4, 0.4, 0.8) * random.in_cube(), targets[random.below(6)])
            }
            1 => (random.in_cube() * 0.5, around(any, random.pick(&[1.0, 1.0, 0.5]), random.pick(&[-1.0, 1.0]))),
            _ => {
                let from = random.below(8);
                (random.in_cube() * 0.4, corners[from].lerp(corners[from ^ random.pick(&[1, 2, 4])], random.unit()))
            }
        };
        let (origin, target) = (place.point(inside).as_vec3(), place.point(target));
        let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
        lost += usize::from(leaks(&*bodies[kind], &ray));
    }
    lost
}
