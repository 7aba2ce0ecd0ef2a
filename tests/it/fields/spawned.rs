//! Rays that are spawned on a field's surface start beside it.

use glam::DVec3;
use pt::bsdf::{Bsdf, Diffuse};
use pt::math::{Ray, Spectrum, Transform};
use pt::scene::Surface;
use pt::shape::sdf::*;
use pt::shape::{Geometry, Sdf, Shape, SurfacePoint};
use rayon::prelude::*;

use super::zoo::{self, baked, dvec};
use crate::random::Random;

fn surface(point: SurfacePoint) -> Surface<'static> {
    Surface::new(point, Bsdf::Diffuse(Diffuse { albedo: Spectrum::ONE }), None)
}

/// A hit, and a ray that leaves from it in any direction.
fn leave(shape: &dyn Shape, random: &mut Random) -> Option<(SurfacePoint, Ray)> {
    let ray = zoo::ray(shape, random);
    let hit = shape.intersect(0, &ray)?;
    let point = shape.point(0, &ray, &hit);
    Some((point, surface(point).spawn(random.direction().as_vec3(), 0.0)))
}

/// A ray that leaves a convex solid never hits it again, and a ray that enters it does not hit it at its start.
#[test]
fn no_self_hits() {
    let convex = [("ball", zoo::ball as fn(&mut Random) -> Field), ("capsule", zoo::capsule), ("box", zoo::sharp_box)];
    for ((name, make), distance) in convex.into_iter().flat_map(|c| [0.0, 1e3, 1e6].map(|d| (c, d))) {
        let check = |seed: u64| {
            let mut random = Random::new(seed);
            let place = Transform::translate(random.direction() * distance).expect("finite");
            let shape = baked(make(&mut random), &place);
            let is_false = |_: &u64| {
                let Some((point, ray)) = leave(&*shape, &mut random) else { return false };
                let again = shape.intersect(0, &ray);
                match point.ng.dot(ray.direction) > 0.0 {
                    true => again.is_some(),
                    // A solid that is thinner than its error bound has no inside to start from.
                    false if 4.0 * point.offset > 0.1 => false,
                    false => again.is_some_and(|hit| shape.point(0, &ray, &hit).ng.dot(ray.direction) < -1e-3),
                }
            };
            (0..2000).filter(is_false).count()
        };
        let hits: usize = (0..100u64).into_par_iter().map(check).sum();
        assert_eq!(hits, 0, "of 200,000 rays from a {name} at {distance}");
    }
}

/// The ray starts on the side that it leaves to: the field has the sign of that side and is not 0.
#[test]
fn rays_start_on_the_side_that_they_leave_to() {
    for (name, make) in zoo::solids() {
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let field = make(&mut random);
            let shape = baked(field.clone(), &Transform::IDENTITY);
            for _ in 0..500 {
                let Some((point, ray)) = leave(&*shape, &mut random) else { continue };
                let side = f64::from(point.ng.dot(ray.direction)).signum();
                let d = side * field.at(dvec(ray.origin));
                // There is no room for the offset where another part of the surface is that near.
                let room = side * field.at(dvec(point.p + point.ng * (16.0 * point.offset) * side as f32));
                assert!(d > 0.0 || room < 8.0 * f64::from(point.offset), "{name}, seed {seed}: {d:e} at {ray:?}");
            }
        }
    }
}

/// A room carved out of a solid space, with a ball and a plank in it: paths never leave the room.
#[test]
fn paths_stay_in_a_room() {
    let half = DVec3::new(3.0, 2.0, 1.0);
    let air = Field::ChebyshevBox(ChebyshevBox { low: -half, high: half });
    let plank = Field::Cuboid(Cuboid { low: DVec3::new(-1.0, -1.0, -1.0), high: DVec3::new(1.0, -0.5, 0.3), rounding: 0.0 });
    let ball = Field::Ball(Ball { center: DVec3::new(1.5, 0.5, 0.0), radius: 0.7 });
    let room = Field::Union(Union::new(vec![Field::Complement(Complement { of: air.into() }), plank, ball]));
    let place = Random::new(1).rotation();
    let room = Sdf { within: [half * -1.5, half * 1.5], ..Sdf::new(room) }.bake(&place).expect("it is within");
    (0..200u64).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed);
        let mut ray = Ray::new(place.point(DVec3::new(-2.0, 0.0, 0.0)).as_vec3(), random.direction().as_vec3());
        for bounce in 0..500 {
            let hit = room.intersect(0, &ray).unwrap_or_else(|| panic!("path {seed} is out after {bounce} bounces: {ray:?}"));
            let point = room.point(0, &ray, &hit);
            let mut w = random.direction().as_vec3();
            if w.dot(point.ng) < 0.0 {
                w = -w;
            }
            ray = surface(point).spawn(w, 0.0);
        }
    });
}
