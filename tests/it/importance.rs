//! Importance of cameras: what a point contributes to the film when a path from a light reaches it.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use pt::camera::{Camera, Orthographic, Perspective, Pose, Spherical};
use pt::math::Transform;

use crate::random::Random;

const ASPECT: f32 = 1.5;
/// Sphere around the camera on which points are connected with it (m).
const RADIUS: f64 = 3.0;

/// A camera of each kind, at a place and in an attitude of its own.
fn cameras() -> Vec<(&'static str, Camera)> {
    let view = Transform::look_at(DVec3::new(0.3, -0.2, 0.1), DVec3::new(1.0, 0.4, -2.0), DVec3::new(0.1, 1.0, 0.2)).expect("a view");
    let pose = Pose::new(&view);
    vec![
        ("pinhole", Camera::Perspective(Perspective::new(pose, 70.0, 0.0, 1.0))),
        ("pinhole with its own aspect", Camera::Perspective(Perspective::new(pose, 50.0, 0.0, 1.0).across(50.0, 90.0))),
        ("thin lens", Camera::Perspective(Perspective::new(pose, 60.0, 0.25, 1.7))),
        ("orthographic", Camera::Orthographic(Orthographic { pose, height: 1.2 })),
        ("spherical", Camera::Spherical(Spherical { pose })),
    ]
}

/// Where a ray from within leaves the sphere.
fn on_sphere(center: DVec3, origin: Vec3, direction: Vec3) -> DVec3 {
    let (o, w) = (origin.as_dvec3() - center, direction.as_dvec3());
    let b = o.dot(w);
    center + o + w * ((b * b + RADIUS * RADIUS - o.length_squared()).sqrt() - b)
}

fn is_on_film(film: Vec2) -> bool {
    film.cmpge(Vec2::ZERO).all() && film.cmplt(Vec2::ONE).all()
}

/// The connection of a point on a camera ray leads back along the ray to its place on the film.
#[test]
fn connections_are_the_rays_of_the_camera() {
    let mut random = Random::new(11);
    for (name, camera) in cameras() {
        for _ in 0..2000 {
            let (film, lens) = (random.uniform_square() * 0.98 + 0.01, random.uniform_square());
            let ray = camera.ray(film, ASPECT, lens, 0.0);
            let p = ray.origin + ray.direction * random.range(0.5, 4.0) as f32;
            let found = camera.connect(p, ASPECT, lens, 0.0).unwrap_or_else(|| panic!("{name}: {film} is on the film"));
            // The rounding of a point 4 m away, about 2⁻²², is seen under a larger angle from half a metre.
            assert!((found.film - film).length() < 2e-5, "{name}: {film} became {}", found.film);
            assert!((found.wi + ray.direction).length() < 2e-6, "{name}: {:?} for {:?}", found.wi, -ray.direction);
            assert!((found.end - ray.origin).length() < 4e-6, "{name}: ends at {:?} and not at {:?}", found.end, ray.origin);
        }
    }
}

/// ∫ We/p(ω) · cos θ dA over a sphere around the camera is the mean over the film of 1: every film point is seen once. With a factor
/// that varies over the sphere it is the mean of that factor along the camera's rays, so that the density is right in every direction.
#[test]
fn importance_integrates_to_one() {
    const N: u32 = 400;
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(N);
    let factors: [fn(DVec3) -> f64; 4] = [|_| 1.0, |n| 1.0 + n.x, |n| 1.0 + n.y * n.z, |n| (n.x + 0.3 * n.y).powi(2)];
    for (name, camera) in cameras() {
        let center = camera.eye();
        let (mut over_sphere, mut over_film) = ([0.0; 4], [0.0; 4]);
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            // Another point of the lens for each point, evenly distributed.
            let lens = Vec2::new(
                (f64::from(i * N + j) * 0.618_033_988_749_895).fract() as f32,
                (f64::from(i * N + j) * 0.754_877_666_246_693).fract() as f32,
            );
            let (z, phi) = (2.0 * middle(i) - 1.0, TAU * middle(j));
            let n = DVec3::new((1.0 - z * z).sqrt() * phi.cos(), z, (1.0 - z * z).sqrt() * phi.sin());
            let area = 4.0 * PI * RADIUS * RADIUS / f64::from(N * N);
            if let Some(found) = camera.connect((center + n * RADIUS).as_vec3(), ASPECT, lens, 0.0).filter(|found| is_on_film(found.film)) {
                let cos = n.dot(-found.wi.as_dvec3());
                let weight = f64::from(found.weight) * cos * area;
                (0..4).for_each(|k| over_sphere[k] += weight * factors[k](n));
            }
            let ray = camera.ray(Vec2::new(middle(i) as f32, middle(j) as f32), ASPECT, lens, 0.0);
            let seen = (on_sphere(center, ray.origin, ray.direction) - center) / RADIUS;
            (0..4).for_each(|k| over_film[k] += factors[k](seen) / f64::from(N * N));
        }
        assert!((over_sphere[0] - 1.0).abs() < 4e-3, "{name}: the importance integrates to {}", over_sphere[0]);
        for k in 1..4 {
            // The edge of the film cuts through cells of the grid: of 400² points some 10³ lie within a cell of it.
            assert!((over_sphere[k] - over_film[k]).abs() < 4e-3, "{name}, factor {k}: {} and {}", over_sphere[k], over_film[k]);
        }
    }
}

/// What is behind a camera does not contribute.
#[test]
fn nothing_behind_a_camera_is_connected() {
    for (name, camera) in cameras().into_iter().filter(|(name, _)| *name != "spherical") {
        let ahead = camera.ray(Vec2::splat(0.5), ASPECT, Vec2::splat(0.5), 0.0).direction;
        assert!(camera.connect(camera.eye().as_vec3() - ahead, ASPECT, Vec2::splat(0.5), 0.0).is_none(), "{name}");
    }
}
