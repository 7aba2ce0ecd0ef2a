//! Ray hits on distance fields: each is the first one, lies on the surface, and is where a formula says.

use glam::{DVec3, Vec3};
use pt::math::{Ray, Transform};
use pt::shape::sdf::*;
use pt::shape::{Geometry, Sdf};

use super::zoo::{self, baked, dvec};
use crate::random::Random;

/// A polynomial, the lowest power first.
#[derive(Clone, Debug)]
struct Polynomial(Vec<f64>);

impl Polynomial {
    fn at(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// All zeros in a range. Between two neighbouring zeros of the derivative there is one if the sign changes; it is found by bisection.
    fn zeros(&self, from: f64, to: f64) -> Vec<f64> {
        if self.0.len() < 2 {
            return vec![];
        }
        let slope = Polynomial(self.0.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect());
        let mut ends = vec![from];
        ends.extend(slope.zeros(from, to));
        ends.push(to);
        let cross = |pair: &[f64]| {
            let (mut a, mut b) = (pair[0], pair[1]);
            if (self.at(a) < 0.0) == (self.at(b) < 0.0) {
                return None;
            }
            for _ in 0..200 {
                let middle = 0.5 * (a + b);
                if (self.at(middle) < 0.0) == (self.at(a) < 0.0) { a = middle } else { b = middle }
            }
            Some(0.5 * (a + b))
        };
        ends.windows(2).filter_map(cross).collect()
    }
}

/// |o + t d − c|² − r²
fn ball(b: &Ball, o: DVec3, d: DVec3) -> Polynomial {
    let o = o - b.center;
    Polynomial(vec![o.length_squared() - b.radius * b.radius, 2.0 * o.dot(d), d.length_squared()])
}

/// (|p|² + R² − r²)² − 4 R² (x² + y²): the implicit torus without a square root.
fn torus(ring: &Ring, o: DVec3, d: DVec3) -> Polynomial {
    let o = o - ring.center;
    let flat = |a: DVec3, b: DVec3| a.x * b.x + a.y * b.y;
    let square = [o.length_squared() + ring.radius * ring.radius - ring.tube * ring.tube, 2.0 * o.dot(d), d.length_squared()];
    let mut c = vec![0.0; 5];
    for (i, a) in square.iter().enumerate() {
        for (j, b) in square.iter().enumerate() {
            c[i + j] += a * b;
        }
    }
    let four = 4.0 * ring.radius * ring.radius;
    c[0] -= four * flat(o, o);
    c[1] -= four * 2.0 * flat(o, d);
    c[2] -= four * flat(d, d);
    Polynomial(c)
}

/// The t at which a line crosses a box's planes, within their sides.
fn box_zeros(low: DVec3, high: DVec3, o: DVec3, d: DVec3) -> Vec<f64> {
    let (a, b) = ((low - o) / d, (high - o) / d);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    if near < far { vec![near, far] } else { vec![] }
}

/// Asserts that the ray hits the shape at the first of the `zeros` in front of its origin, or misses it if there is none.
///
/// t is computed in f64 from coordinates of 10 and rounded to f32, so the tolerance is slightly more than half a unit in the last place. A
/// ray may miss a solid that it enters and leaves within the distance `least`, because f32 does not resolve it.
fn check(name: &str, shape: &dyn pt::shape::Shape, ray: &Ray, mut zeros: Vec<f64>) -> bool {
    let least = f64::from(f32::EPSILON) * 64.0 * f64::from(shape.bounds(0).magnitude().max_element()).sqrt();
    zeros.sort_by(f64::total_cmp);
    zeros.retain(|t| *t > 0.0);
    let hit = shape.intersect(0, ray);
    match (hit, zeros.first()) {
        (None, None) => false,
        (Some(hit), Some(t)) => {
            let apart = (f64::from(hit.t) - t).abs();
            let grazing = zeros.len() > 1 && zeros[1] - zeros[0] < least.sqrt();
            assert!(grazing || apart <= t * 2f64.powi(-24) + 1e-9, "{name}: {} but {t}, {ray:?}", hit.t);
            true
        }
        // The ray grazes the solid: the chord is shorter than the precision of the ray.
        (None, Some(_)) => {
            assert!(zeros.len() > 1 && zeros[1] - zeros[0] < least.sqrt(), "{name}: missed {zeros:?}, {ray:?}");
            false
        }
        (Some(hit), None) => panic!("{name}: {hit:?} where nothing is, {ray:?}"),
    }
}

#[test]
fn hits_match_the_analytic_ones() {
    let mut hits = 0;
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let (Field::Ball(a), Field::Cuboid(b), c) = (zoo::ball(&mut random), zoo::sharp_box(&mut random), zoo::ring(&mut random, false))
        else {
            unreachable!()
        };
        let half_space = HalfSpace { point: random.in_cube() * 0.2, normal: random.direction() };
        let plane = Sdf { within: [DVec3::splat(-2.0), DVec3::splat(2.0)], ..Sdf::new(Field::HalfSpace(half_space.clone())) };
        let round = baked(Field::Ball(a.clone()), &Transform::IDENTITY);
        let square = baked(Field::Cuboid(b.clone()), &Transform::IDENTITY);
        let ring = baked(Field::Ring(c.clone()), &Transform::IDENTITY);
        let flat = plane.bake(&Transform::IDENTITY).expect("it is within");
        for _ in 0..300 {
            let of = |ray: &Ray| (dvec(ray.origin), dvec(ray.direction));
            let ray = zoo::ray(&*round, &mut random);
            let (o, d) = of(&ray);
            hits += usize::from(check("ball", &*round, &ray, ball(&a, o, d).zeros(-50.0, 50.0)));
            let ray = zoo::ray(&*square, &mut random);
            let (o, d) = of(&ray);
            hits += usize::from(check("box", &*square, &ray, box_zeros(b.low, b.high, o, d)));
            let ray = zoo::ray(&*ring, &mut random);
            let (o, d) = of(&ray);
            hits += usize::from(check("torus", &*ring, &ray, torus(&c, o, d).zeros(-50.0, 50.0)));
            let ray = zoo::ray(&*flat, &mut random);
            let (o, d) = of(&ray);
            let t = (half_space.point - o).dot(half_space.normal) / d.dot(half_space.normal);
            // A ray that lies in a side of the box may hit it or not.
            let side = (o + d * t).abs().max_element();
            if (side - 2.0).abs() > 1e-6 {
                hits += usize::from(check("plane", &*flat, &ray, if side < 2.0 { vec![t] } else { vec![] }));
            }
        }
    }
    assert!(hits > 100_000, "{hits} of 360,000");
}

/// Hits lie on the surface within the offset of spawned rays. Normals have unit length and point against a ray from outside.
#[test]
fn hits_lie_on_the_surface() {
    for (name, make) in zoo::solids() {
        let mut hits = 0;
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let field = make(&mut random);
            let shape = baked(field.clone(), &Transform::IDENTITY);
            for _ in 0..200 {
                let ray = zoo::ray(&*shape, &mut random);
                let Some(hit) = shape.intersect(0, &ray) else { continue };
                let point = shape.point(0, &ray, &hit);
                hits += 1;
                let d = field.at(dvec(point.p));
                assert!(d.abs() <= f64::from(point.offset), "{name}, seed {seed}: {d:e} beside it, offset {:e}", point.offset);
                assert!((point.ng.length() - 1.0).abs() < 4.0 * f32::EPSILON, "{name}: {}", point.ng);
                // The ray comes from the side of the normal. Where it grazes, the normal may be that of a point nearby and differ.
                let (from, cos) = (field.at(dvec(ray.origin)), point.ng.dot(ray.direction));
                assert!(from * f64::from(cos) < 1e-3, "{name}, seed {seed}: from {from} along {cos}");
                // There is no earlier hit, tested at a thousand steps.
                for k in 0..1000 {
                    let t = f64::from(hit.t) * f64::from(k) / 1000.0 * (1.0 - 1e-5);
                    let between = field.at(dvec(ray.origin) + dvec(ray.direction) * t);
                    assert!(between * from >= -1e-5, "{name}, seed {seed}: {between} at {t} before {}", hit.t);
                }
            }
        }
        assert!(hits > 2000, "{name}: {hits}");
    }
}

/// A scene of 2^k times the size has the same hits, to the bit.
#[test]
fn scale_is_exact() {
    for (name, make) in zoo::solids() {
        for seed in 0..10 {
            let mut random = Random::new(seed);
            let (field, turn) = (make(&mut random), random.rotation());
            let shape = baked(field.clone(), &turn);
            for k in [-20, 20] {
                let factor = 2f32.powi(k);
                let scaled = baked(field.clone(), &turn.then(&Transform::scale(DVec3::splat(factor.into())).expect("not zero")));
                for _ in 0..50 {
                    let ray = zoo::ray(&*shape, &mut random);
                    let large = Ray { origin: ray.origin * factor, ..ray };
                    let (hit, other) = (shape.intersect(0, &ray), scaled.intersect(0, &large));
                    assert_eq!(hit.map(|h| h.t * factor), other.map(|h| h.t), "{name}, seed {seed}, 2^{k}");
                    let (Some(hit), Some(other)) = (hit, other) else { continue };
                    let (a, b) = (shape.point(0, &ray, &hit), scaled.point(0, &large, &other));
                    assert_eq!((a.p * factor, a.offset * factor, a.ng), (b.p, b.offset, b.ng), "{name}, seed {seed}, 2^{k}");
                }
            }
        }
    }
}

/// Objects with one axis scaled by 10⁻³⁰ or 10³⁰, near and far: intersection always ends, and hits are within the bounds.
///
/// Without a limit on the steps the first such ray would never end. With the limit all of them take seconds.
#[test]
fn rays_end_at_every_scale() {
    let (done, end) = std::sync::mpsc::channel();
    let work = move || {
        for (name, make) in zoo::solids() {
            for (axis, factor) in (0..3).flat_map(|axis| [1e-30, 1e-20, 1e-8, 1e8, 1e20, 1e30].map(|factor| (axis, factor))) {
                let mut random = Random::new(7);
                let mut scale = DVec3::ONE;
                scale[axis] = factor;
                let shape = baked(make(&mut random), &Transform::scale(scale).expect("not zero"));
                let bounds = shape.bounds(0);
                for _ in 0..40 {
                    // Rays start near and far, and go towards the box and along its sides.
                    let target = bounds.min + (bounds.max - bounds.min) * random.in_cube().as_vec3();
                    let away = random.direction().as_vec3() * 10f32.powi(random.below(9) as i32 - 4) * bounds.magnitude().max_element();
                    let flat = if random.below(2) == 0 { Vec3::ONE } else { Vec3::ONE.with_z(1e-20) };
                    let Some(direction) = (-away * flat).try_normalize() else { continue };
                    let ray = Ray::new(target + away * flat, direction);
                    if let Some(hit) = shape.intersect(0, &ray) {
                        assert!(hit.t > 0.0 && hit.t.is_finite(), "{name}, {factor:e} along {axis}: {hit:?}, {ray:?}");
                    }
                }
            }
        }
        done.send(()).expect("the test waits");
    };
    let worker = std::thread::spawn(work);
    let late = end.recv_timeout(std::time::Duration::from_secs(300)) == Err(std::sync::mpsc::RecvTimeoutError::Timeout);
    assert!(!late, "a ray has no end");
    worker.join().expect("no panic");
}

/// A solid with a non-uniform scale: hits lie on the scaled surface, tested in object space.
#[test]
fn stretched_solids_are_hit() {
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let field = zoo::torus(&mut random);
        let place = Transform::scale(random.in_cube() * 0.9 + 1.0).expect("not zero").then(&random.rotation());
        let shape = baked(field.clone(), &place);
        for _ in 0..100 {
            let ray = zoo::ray(&*shape, &mut random);
            let Some(hit) = shape.intersect(0, &ray) else { continue };
            let point = shape.point(0, &ray, &hit);
            let back = field.at(place.inverse().point(dvec(point.p))).abs();
            // A length in object space is up to 1/0.1 of that in world space.
            assert!(back <= 10.0 * f64::from(point.offset), "seed {seed}: {back:e}, offset {:e}", point.offset);
        }
    }
}

/// Invalid rays, and rays along the axes in the sides of the box, cause no panic.
#[test]
fn invalid_rays_cause_no_panic() {
    let cube = baked(Field::Cuboid(Cuboid { low: DVec3::splat(-1.0), high: DVec3::ONE, rounding: 0.0 }), &Transform::IDENTITY);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for v in bad.into_iter().flat_map(|x| [glam::Vec3::splat(x), glam::Vec3::new(x, 0.5, 0.5)]) {
        assert_eq!(cube.intersect(0, &Ray::new(v, glam::Vec3::Z)), None);
        assert_eq!(cube.intersect(0, &Ray::new(glam::Vec3::ZERO, v)), None);
    }
    assert_eq!(cube.intersect(0, &Ray { t_max: f32::NAN, ..Ray::new(glam::Vec3::ZERO, glam::Vec3::Z) }), None);
    assert_eq!(cube.intersect(0, &Ray::new(glam::Vec3::ZERO, glam::Vec3::ZERO)), None);
    let hit = cube.intersect(0, &Ray::new(glam::Vec3::new(0.0, 0.0, 3.0), -glam::Vec3::Z)).expect("the top");
    assert_eq!(hit.t, 2.0);
}
