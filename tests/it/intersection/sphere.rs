//! Spheres and ellipsoids, near and far, tiny and huge.

use glam::DVec3;
use pt::math::{Ray, Transform};
use pt::shape::{Geometry, Sphere};
use rayon::prelude::*;

use crate::random::Random;

/// The value of |M⁻¹(p − c)|² − 1 along the ray: the first zero after t = 0 is what must be found.
struct Implicit {
    inverse: Transform,
    ray: Ray,
}

impl Implicit {
    fn at(&self, t: f64) -> f64 {
        self.inverse.point(self.ray.origin.as_dvec3() + self.ray.direction.as_dvec3() * t).length_squared() - 1.0
    }

    /// Twice |p·p'|: how fast the value changes with t.
    fn slope(&self, t: f64) -> f64 {
        let q = self.inverse.point(self.ray.origin.as_dvec3() + self.ray.direction.as_dvec3() * t);
        2.0 * q.dot(self.inverse.vector(self.ray.direction.as_dvec3())).abs()
    }

    /// Point of the line that is nearest to the centre in the sphere's own space, by bisection of the derivative's sign.
    fn nearest(&self, mut low: f64, mut high: f64) -> f64 {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let q = self.inverse.point(self.ray.origin.as_dvec3() + self.ray.direction.as_dvec3() * middle);
            let falls = q.dot(self.inverse.vector(self.ray.direction.as_dvec3())) < 0.0;
            (low, high) = if falls { (middle, high) } else { (low, middle) };
        }
        0.5 * (low + high)
    }
}

/// Hits are zeros of the implicit function to the rounding of t, the first ones; a miss has none.
#[test]
fn ellipsoids_match_the_implicit_function() {
    let hits: usize = (0..2000u64).into_par_iter().map(|seed| check(seed, &mut Random::new(seed))).sum();
    assert!(hits > 50_000, "{hits} of 2·10⁵ rays hit");
}

fn check(seed: u64, random: &mut Random) -> usize {
    let size = random.decade(-6.0, 6.0);
    let stretch = if random.below(2) == 0 { DVec3::ONE } else { random.in_cube() * 0.9 + 1.0 };
    let center = random.direction() * size * random.pick(&[0.0, 1.0, 1e3]);
    let place = Transform::scale(stretch * size).expect("not zero").then(&random.rotation());
    let place = place.then(&Transform::translate(center).expect("finite"));
    let sphere = Sphere { radius: 1.0 }.bake(&place).expect("a sphere");
    let mut hits = 0;
    for _ in 0..100 {
        let origin = (center + random.direction() * size * random.decade(-2.0, 3.0)).as_vec3();
        let target = center + random.in_cube() * (1.5 * size);
        let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
        let f = Implicit { inverse: place.inverse(), ray };
        let reach = (target - origin.as_dvec3()).length() + 4.0 * size;
        let nearest = f.nearest(0.0, reach);
        // f64 coordinates of size |o| + |c| enter a quotient by the smallest axis and a square.
        let relative = (origin.length() as f64 + center.length()) / (0.1 * size);
        let slack = 64.0 * f64::EPSILON * (1.0 + relative * relative);
        match sphere.intersect(0, &ray) {
            Some(hit) => {
                let t = hit.t as f64;
                let rounding = t * 2f64.powi(-24);
                let curvature = f.inverse.vector(ray.direction.as_dvec3()).length_squared() * rounding * rounding;
                assert!(f.at(t).abs() <= f.slope(t) * rounding + curvature + slack, "seed {seed}: off by {} at {hit:?}", f.at(t));
                // From outside it is the first: the function falls there.
                if f.at(0.0) > slack {
                    assert!(t <= nearest * (1.0 + 1e-6) + rounding, "seed {seed}: {t} lies behind {nearest}");
                }
                hits += 1;
            }
            None => {
                assert!(f.at(0.0) > -slack, "seed {seed}: missed from inside");
                assert!(nearest <= 0.0 || f.at(nearest) >= -slack, "seed {seed}: missed by {}", f.at(nearest));
            }
        }
    }
    hits
}
