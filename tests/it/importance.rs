//! Importance of cameras: what a point contributes to the film when a path from a light reaches it.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use pt::camera::{Blades, Camera, CameraRay, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Spherical};
use pt::math::{AreaPdf, Ray, SolidAnglePdf, Transform};

use crate::random::Random;

const ASPECT: f32 = 1.5;
/// Sphere around the camera on which points are connected with it (m).
const RADIUS: f64 = 3.0;

/// A camera of each kind, at a place and in an attitude of its own.
fn cameras() -> Vec<(&'static str, Camera)> {
    let view = Transform::look_at(DVec3::new(0.3, -0.2, 0.1), DVec3::new(1.0, 0.4, -2.0), DVec3::new(0.1, 1.0, 0.2)).expect("a view");
    let pose = Pose::new(&view);
    vec![
        ("pinhole", Camera::Perspective(Perspective::new(pose.clone(), 70.0, 0.0, 1.0))),
        ("pinhole with its own aspect", Camera::Perspective(Perspective::new(pose.clone(), 50.0, 0.0, 1.0).across(50.0, 90.0))),
        ("thin lens", Camera::Perspective(Perspective::new(pose.clone(), 60.0, 0.25, 1.7))),
        ("blades", Camera::Perspective(Perspective::new(pose.clone(), 60.0, 0.25, 1.7).with_blades(Blades::new(5, 20.0)))),
        ("shifted pinhole", Camera::Perspective(Perspective::new(pose.clone(), 50.0, 0.0, 1.0).shifted([0.3, -0.4]))),
        ("tilted lens", Camera::Perspective(Perspective::new(pose.clone(), 50.0, 0.25, 1.7).tilted([25.0, -35.0]).shifted([-0.1, 0.2]))),
        ("orthographic", Camera::Orthographic(Orthographic { pose: pose.clone(), height: 1.2 })),
        ("spherical", Camera::Spherical(Spherical { pose: pose.clone() })),
        ("fisheye", Camera::Fisheye(Fisheye::new(pose.clone(), 200.0, FisheyeMapping::Equidistant))),
        ("equisolid fisheye", Camera::Fisheye(Fisheye::new(pose.clone(), 220.0, FisheyeMapping::Equisolid))),
        ("stereographic fisheye", Camera::Fisheye(Fisheye::new(pose.clone(), 250.0, FisheyeMapping::Stereographic))),
        ("orthographic fisheye", Camera::Fisheye(Fisheye::new(pose, 170.0, FisheyeMapping::Orthographic))),
    ]
}

fn is_round(name: &str) -> bool {
    name.contains("fisheye")
}

/// Share of the film that receives light: for a round picture π/4 of a square as high as the film.
fn seen_share(name: &str) -> f64 {
    if is_round(name) { PI / 4.0 / f64::from(ASPECT) } else { 1.0 }
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
            let CameraRay { ray, weight } = camera.sample(film, ASPECT, lens, 0.0);
            if weight == 0.0 {
                assert!(is_round(name) && ray.t_max == 0.0, "{name}: {film}");
                continue;
            }
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
            let CameraRay { ray, weight } = camera.sample(Vec2::new(middle(i) as f32, middle(j) as f32), ASPECT, lens, 0.0);
            let seen = (on_sphere(center, ray.origin, ray.direction) - center) / RADIUS;
            (0..4).for_each(|k| over_film[k] += f64::from(weight) * factors[k](seen) / f64::from(N * N));
        }
        assert!((over_sphere[0] - seen_share(name)).abs() < 4e-3, "{name}: the importance integrates to {}", over_sphere[0]);
        for k in 1..4 {
            // The edge of the film cuts through cells of the grid: of 400² points some 10³ lie within a cell of it.
            assert!((over_sphere[k] - over_film[k]).abs() < 4e-3, "{name}, factor {k}: {} and {}", over_sphere[k], over_film[k]);
        }
    }
}

/// What is behind a camera does not contribute.
#[test]
fn nothing_behind_a_camera_is_connected() {
    for (name, camera) in cameras().into_iter().filter(|(name, _)| *name != "spherical" && !is_round(name)) {
        let ahead = camera.ray(Vec2::splat(0.5), ASPECT, Vec2::splat(0.5), 0.0).direction;
        assert!(camera.connect(camera.eye().as_vec3() - ahead, ASPECT, Vec2::splat(0.5), 0.0).is_none(), "{name}");
    }
}

/// A given ray has the film position and the densities of the camera ray that it is. Over all directions from the same start, the
/// density and its product with a function of the film integrate to the means over the film.
#[test]
fn given_rays_have_the_densities_of_camera_rays() {
    const N: u32 = 1000;
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(N);
    let mut random = Random::new(12);
    for (name, camera) in cameras() {
        for _ in 0..1000 {
            let (film, lens) = (random.uniform_square() * 0.98 + 0.01, random.uniform_square());
            let CameraRay { ray, weight } = camera.sample(film, ASPECT, lens, 0.0);
            if weight == 0.0 {
                continue;
            }
            let given = camera.importance(&ray, ASPECT).unwrap_or_else(|| panic!("{name}: {film} is on the film"));
            assert!((given.film - film).length() < 1e-5, "{name}: {film} became {}", given.film);
            let d = random.range(0.5, 4.0) as f32;
            let connection = camera.connect(ray.origin + ray.direction * d, ASPECT, lens, 0.0).expect("in front of the camera");
            // What a point contributes is We divided by the density of the direction to the camera. That density is d² / cos θ times
            // the density of the start on the lens, and for panoramas and fisheye lenses, which have no cosine, d².
            let expected = given.direction.smooth().map_or(given.we, |direction| direction.get() / (d * d));
            assert!((connection.weight / expected - 1.0).abs() < 1e-4, "{name}: {} and not {expected}", connection.weight);
        }
        let lens = Vec2::new(0.3, 0.8);
        let ray = camera.ray(Vec2::new(0.4, 0.7), ASPECT, lens, 0.0);
        let given = camera.importance(&ray, ASPECT).expect("on the film");
        let cos = if name == "spherical" || is_round(name) { 1.0 } else { axis(&camera).dot(ray.direction) };
        let (position, direction) = (given.position.smooth().map(AreaPdf::get), given.direction.smooth().map(SolidAnglePdf::get));
        let product = position.unwrap_or(1.0) * direction.unwrap_or(1.0);
        assert!((given.we * cos / product - 1.0).abs() < 1e-5, "{name}: We {} for the densities' product {product}", given.we);
        let area = match name {
            "thin lens" | "tilted lens" => Some(PI * 0.25 * 0.25),
            "blades" => Some(2.5 * (TAU / 5.0).sin() * 0.25 * 0.25),
            "orthographic" => Some(1.2 * 1.2 * f64::from(ASPECT)),
            _ => None,
        };
        assert_eq!(position.is_some(), area.is_some(), "{name}");
        let share = f64::from(position.unwrap_or(1.0)) * area.unwrap_or(1.0);
        assert!((share - 1.0).abs() < 1e-6, "{name}: the density of the start integrates to {share}");
        if direction.is_none() {
            continue;
        }
        let functions: [fn(Vec2) -> f64; 3] = [|_| 1.0, |film| f64::from(film.x), |film| f64::from(film.y * film.y)];
        // The mean of y² over a disk of the diameter 1 around ½ is ¼ + 1/16.
        let square = if is_round(name) { 0.3125 } else { 1.0 / 3.0 };
        let (mut over_sphere, expected) = ([0.0; 3], [1.0, 0.5, square].map(|mean| mean * seen_share(name)));
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let (z, phi) = (2.0 * middle(i) - 1.0, TAU * middle(j));
            let w = DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z).as_vec3();
            if let Some(found) = camera.importance(&Ray::new(ray.origin, w), ASPECT) {
                let density = f64::from(found.direction.smooth().map_or(0.0, SolidAnglePdf::get)) * 4.0 * PI / f64::from(N * N);
                (0..3).for_each(|k| over_sphere[k] += density * functions[k](found.film));
            }
        }
        for k in 0..3 {
            // The edge of the film cuts through cells of the grid, as above; the poles of a panorama are integrable singularities.
            assert!((over_sphere[k] - expected[k]).abs() < 5e-3, "{name}, function {k}: {} for {}", over_sphere[k], expected[k]);
        }
    }
}

/// Direction in which a camera looks.
fn axis(camera: &Camera) -> Vec3 {
    -camera.world_to_camera().row(2).truncate().as_vec3()
}
