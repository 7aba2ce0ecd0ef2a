//! The triangle test against exact integer arithmetic.
//!
//! Coordinates are whole numbers below 2²⁴ (times a power of two that cancels), so that every
//! product fits `i128` and the oracle is exact: hit or miss, t, and the weights of the corners.

use glam::Vec3;
use pt::math::Ray;
use pt::shape::triangle;
use rayon::prelude::*;

use crate::random::Random;

type Int3 = [i128; 3];

fn sub(a: Int3, b: Int3) -> Int3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Int3, b: Int3) -> Int3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Int3, b: Int3) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn float(a: Int3) -> Vec3 {
    Vec3::from(a.map(|x| x as f32))
}

/// Result of exact arithmetic for a ray and a triangle.
struct Exact {
    /// The edge functions of the corners a, b, c.
    weights: Int3,
    /// t = numerator / denominator
    numerator: i128,
    denominator: i128,
    normal: Int3,
}

impl Exact {
    fn new(origin: Int3, direction: Int3, corners: [Int3; 3]) -> Exact {
        let [a, b, c] = corners.map(|v| sub(v, origin));
        let edge = |p, q| dot(direction, cross(p, q));
        let normal = cross(sub(b, a), sub(c, a));
        Exact { weights: [edge(b, c), edge(c, a), edge(a, b)], numerator: dot(normal, a), denominator: dot(normal, direction), normal }
    }

    fn hits(&self) -> bool {
        let inside = self.weights.iter().all(|w| *w >= 0) || self.weights.iter().all(|w| *w <= 0);
        inside && self.denominator != 0 && self.numerator.signum() * self.denominator.signum() > 0
    }

    fn t(&self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    fn weight(&self, corner: usize) -> f64 {
        self.weights[corner] as f64 / self.weights.iter().sum::<i128>() as f64
    }
}

fn integers(random: &mut Random, size: i128) -> Int3 {
    [0; 3].map(|_| random.below(2 * size as usize + 1) as i128 - size)
}

/// For small integers f64 is exact, so every decision is correct, also on edges, at corners and in the plane of the triangle.
#[test]
fn decisions_are_exact_on_a_grid() {
    let hits: u64 = (0..1000u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(seed);
            let mut hits = 0;
            for _ in 0..2000 {
                let size = random.pick(&[2, 4, 32, 1000]);
                let (origin, corners) = (integers(&mut random, size), [0; 3].map(|_| integers(&mut random, size)));
                let target = if random.below(2) == 0 { corners[random.below(3)] } else { integers(&mut random, size) };
                let direction = sub(target, origin);
                let exact = Exact::new(origin, direction, corners);
                let found = triangle::intersect(&Ray::new(float(origin), float(direction)), f32::INFINITY, corners.map(float));
                assert_eq!(found.is_some(), exact.hits(), "seed {seed}: {origin:?} {direction:?} {corners:?}");
                hits += u64::from(exact.hits());
            }
            hits
        })
        .sum();
    assert!(hits > 100_000, "{hits} of 2·10⁶ rays hit");
}

/// Full 24-bit coordinates: the error of t is at most 16 ulp of the scene's size if the ray is not nearly in the plane, and that of the
/// weights is one rounding.
///
/// A decision may differ only where an edge function is within its own rounding error in f64.
#[test]
fn distances_and_weights_match_integers() {
    const SIZE: i128 = 1 << 23;
    let hits: u64 = (0..1000u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(seed);
            (0..2000).map(|_| u64::from(matches_integers(&mut random, SIZE, seed))).sum::<u64>()
        })
        .sum();
    assert!(hits > 1_000_000, "{hits} of 2·10⁶ rays hit");
}

fn matches_integers(random: &mut Random, size: i128, seed: u64) -> bool {
    let (origin, corners) = (integers(random, size), [0; 3].map(|_| integers(random, size)));
    // Most rays go towards the triangle, to one of its points rounded to the grid.
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let at = |k: usize| (corners[0][k] as f64 * (1.0 - u - v) + corners[1][k] as f64 * u + corners[2][k] as f64 * v) as i128;
    // The coordinates are halved, so that their differences also fit 24 bits.
    let direction = sub([at(0), at(1), at(2)], origin).map(|x| x / 2);
    let exact = Exact::new(origin, direction, corners);
    let found = triangle::intersect(&Ray::new(float(origin), float(direction)), f32::INFINITY, corners.map(float));
    // The tolerance is for six products of three numbers below 2²⁵, each with a few rounding errors of 2⁻⁵³.
    let slack = (12.0 * 2f64.powi(75 - 53)) as i128;
    if exact.weights.iter().all(|w| w.abs() > slack) && exact.numerator.abs() > slack {
        assert_eq!(found.is_some(), exact.hits(), "seed {seed}: {origin:?} {direction:?} {corners:?}");
    }
    let Some(hit) = found else { return false };
    let norm = |v: Int3| v.iter().map(|x| (*x as f64).powi(2)).sum::<f64>().sqrt();
    let cosine = (exact.denominator as f64 / (norm(exact.normal) * norm(direction))).abs();
    if cosine > 1e-3 {
        let along = norm(direction) * (hit.t as f64 - exact.t()).abs();
        let scale = 2.0 * size as f64;
        assert!(along <= 16.0 * 2f64.powi(-24) * scale, "seed {seed}: t {} but {}", hit.t, exact.t());
        for (w, corner) in [(hit.uv.x, 1), (hit.uv.y, 2)] {
            assert!((w as f64 - exact.weight(corner)).abs() <= 2f64.powi(-24), "seed {seed}: weight {w} but {}", exact.weight(corner));
        }
    }
    let ng = triangle::normal(corners.map(float)).expect("an area");
    let unit = exact.normal.map(|x| x as f64 / norm(exact.normal));
    assert!(ng.to_array().iter().zip(unit).all(|(a, b)| (*a as f64 - b).abs() <= 2f64.powi(-23)), "seed {seed}: {ng} but {unit:?}");
    true
}

/// Thin triangles seen along their plane are not hit beyond their ends. They were once hit a hundred times their length away.
/// A hit lies in the triangle's box, grown by 16 ulp of the scene.
#[test]
fn thin_triangles_are_not_hit_beyond_their_ends() {
    (0..1000u64).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed);
        for _ in 0..1000 {
            let a = random.in_cube() * 300.0;
            let along = random.direction() * random.decade(-1.0, 2.0);
            let across = random.direction() * random.decade(-9.0, -2.0);
            let corners = [a, a + along, a + along * random.unit() + across].map(|p| p.as_vec3());
            let target = a + along * random.range(-0.5, 1.5);
            let origin = (target - along * random.range(1.0, 50.0) + random.direction() * random.decade(-9.0, 0.0)).as_vec3();
            let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
            let Some(hit) = triangle::intersect(&ray, ray.t_max, corners) else { continue };
            let p = origin.as_dvec3() + ray.direction.as_dvec3() * hit.t as f64;
            let bounds = pt::math::Aabb::around(corners);
            let scale = origin.abs().max(bounds.magnitude()).max_element() as f64;
            let slack = 16.0 * 2f64.powi(-24) * scale;
            let inside = p.cmpge(bounds.min.as_dvec3() - slack).all() && p.cmple(bounds.max.as_dvec3() + slack).all();
            assert!(inside, "seed {seed}: {ray:?} met {corners:?} at {p}");
        }
    });
}

/// Three corners with equal x and z form a line, which no ray hits, whatever cancels in the rounding.
#[test]
fn a_line_far_from_the_origin_is_missed() {
    let corners = [[-79.05, -56.24], [-87.09, -56.24], [-79.21, -56.24]].map(|[y, z]| Vec3::new(-1113.4546, y, z));
    for seed in 0..10_000 {
        let mut random = Random::new(seed);
        let origin = Vec3::new(-1081.5, 100.0, 87.8) + random.in_cube().as_vec3();
        let target = corners[0].lerp(corners[1], random.unit() as f32);
        assert_eq!(triangle::intersect(&Ray::new(origin, (target - origin).normalize()), f32::INFINITY, corners), None);
    }
}
