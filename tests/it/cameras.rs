//! Cameras: the ray of each point of the film, compared with geometric formulas in double precision.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use proptest::prelude::*;
use pt::bsdf::Material;
use pt::camera::{Blades, Camera, CameraRay, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Spherical};
use pt::effects::Effects;
use pt::math::{Ray, Rgb, Transform, float::ONE_MINUS_EPSILON};
use pt::scene::Scene;
use pt::shape::{Disk, Quad, Sphere};
use pt::world::World;

use crate::random::{Random, cases};

/// Components of a unit direction err by a few roundings of 2⁻²⁴.
const FEW_ROUNDINGS: f64 = 16.0 / 16_777_216.0;

fn identity() -> Pose {
    Pose::new(&Transform::IDENTITY)
}

fn pinhole(pose: Pose, fov: f64) -> Camera {
    Camera::Perspective(Perspective::new(pose, fov, 0.0, 1.0))
}

fn ray(camera: &Camera, film: [f32; 2], aspect: f32) -> Ray {
    camera.ray(film.into(), aspect, Vec2::splat(0.5), 0.0)
}

fn direction(camera: &Camera, film: [f32; 2], aspect: f32) -> DVec3 {
    ray(camera, film, aspect).direction.as_dvec3()
}

fn degrees_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

fn shares() -> impl Strategy<Value = [f32; 2]> {
    [0f32..1.0, 0f32..1.0]
}

/// Position, target and up vector of a camera, far from degenerate.
fn views() -> impl Strategy<Value = [DVec3; 3]> {
    let any = || [-10.0..10.0, -10.0..10.0, -10.0..10.0].prop_map(DVec3::from_array);
    let sound =
        |[from, to, up]: &[DVec3; 3]| (*from - *to).length() > 0.1 && (*from - *to).normalize().cross(*up).length() > 0.1 * up.length();
    [any(), any(), any()].prop_filter("degenerate", sound)
}

proptest! {
    #![proptest_config(cases(5_000))]

    /// ω = (x a tan(θ/2), y tan(θ/2), −1)/|…| in the frame of right, up, back.
    #[test]
    fn perspective_is_its_formula(film in shares(), aspect in 0.25f32..4.0, fov in 1.0f64..150.0, [from, to, up] in views()) {
        let pose = Pose::new(&Transform::look_at(from, to, up).expect("not degenerate"));
        let forward = (to - from).normalize();
        let right = forward.cross(up).normalize();
        let tan = (fov / 2.0).to_radians().tan();
        let (x, y) = (2.0 * f64::from(film[0]) - 1.0, 1.0 - 2.0 * f64::from(film[1]));
        let expected = (forward + right * x * f64::from(aspect) * tan + right.cross(forward) * y * tan).normalize();
        let found = direction(&pinhole(pose, fov), film, aspect);
        prop_assert!((found - expected).length() < FEW_ROUNDINGS, "{} is not {}", found, expected);
    }

    /// With a horizontal angle of its own a camera has ω = (x tan(θx/2), y tan(θy/2), −1)/|…|, for any shape of the film.
    #[test]
    fn an_independent_horizontal_angle_is_its_formula(
        film in shares(), aspect in 0.25f32..4.0, fov in 1.0f64..150.0, across in 1.0f64..150.0,
    ) {
        let camera = Camera::Perspective(Perspective::new(identity(), fov, 0.0, 1.0).across(fov, across));
        let [tan_x, tan_y] = [across, fov].map(|angle| (angle / 2.0).to_radians().tan());
        let (x, y) = (2.0 * f64::from(film[0]) - 1.0, 1.0 - 2.0 * f64::from(film[1]));
        let expected = DVec3::new(x * tan_x, y * tan_y, -1.0).normalize();
        let found = direction(&camera, film, aspect);
        prop_assert!((found - expected).length() < FEW_ROUNDINGS, "{} is not {}", found, expected);
        let pixel = f64::from(camera.pixel_aspect(aspect));
        prop_assert!((pixel * f64::from(aspect) / (tan_x / tan_y) - 1.0).abs() < FEW_ROUNDINGS, "{}", pixel);
    }

    /// A mirroring transform swaps left and right and nothing else.
    #[test]
    fn a_mirrored_camera_mirrors_the_picture([x, y] in shares(), [from, to, up] in views()) {
        let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).expect("invertible");
        let view = Transform::look_at(from, to, up).expect("not degenerate");
        let [plain, mirrored] = [view, mirror.then(&view)].map(|to_world| pinhole(Pose::new(&to_world), 50.0));
        let [found, expected] = [direction(&mirrored, [x, y], 1.5), direction(&plain, [1.0 - x, y], 1.5)];
        prop_assert!((found - expected).length() < FEW_ROUNDINGS, "{} is not {}", found, expected);
    }

    /// The rays are parallel, and their origins lie on the film, which is `height` metres high.
    #[test]
    fn orthographic_is_its_formula(film in shares(), aspect in 0.25f32..4.0, height in 0.1f32..100.0, [from, to, up] in views()) {
        let pose = Pose::new(&Transform::look_at(from, to, up).expect("not degenerate"));
        let forward = (to - from).normalize();
        let right = forward.cross(up).normalize();
        let (x, y) = (f64::from(film[0]) - 0.5, 0.5 - f64::from(film[1]));
        let expected = from + (right * x * f64::from(aspect) + right.cross(forward) * y) * f64::from(height);
        let found = ray(&Camera::Orthographic(Orthographic { pose, height }), film, aspect);
        let size = 10.0 + f64::from(height) * f64::from(aspect.max(1.0));
        prop_assert!((found.origin.as_dvec3() - expected).length() < FEW_ROUNDINGS * size, "{} is not {}", found.origin, expected);
        prop_assert!((found.direction.as_dvec3() - forward).length() < FEW_ROUNDINGS);
    }

    /// The film's coordinates of a direction are its longitude and its latitude: every direction is on the film.
    #[test]
    fn the_panorama_holds_every_direction(z in -1.0f64..1.0, phi in 0.0..TAU) {
        let w = DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z);
        let film = [0.5 + w.x.atan2(-w.z) / TAU, w.y.acos() / PI].map(|share| share as f32);
        let found = direction(&Camera::Spherical(Spherical { pose: identity() }), film, 2.0);
        // A coordinate of the film is rounded once, and corresponds to an angle of up to 2π.
        prop_assert!((found - w).length() < TAU * FEW_ROUNDINGS, "{} is not {}", found, w);
    }

    #[test]
    fn rays_are_unit_and_endless(film in shares(), lens in shares(), fov in 0.01f64..179.0, [from, to, up] in views()) {
        let pose = Pose::new(&Transform::look_at(from, to, up).expect("not degenerate"));
        let cameras = [
            pinhole(pose.clone(), fov),
            Camera::Perspective(Perspective::new(pose.clone(), fov, 0.25, 2.0)),
            Camera::Perspective(Perspective::new(pose.clone(), fov, 0.25, 2.0).with_blades(Blades::new(7, 200.0)).tilted([60.0, -60.0])),
            Camera::Orthographic(Orthographic { pose: pose.clone(), height: 3.0 }),
            Camera::Spherical(Spherical { pose: pose.clone() }),
            Camera::Fisheye(Fisheye::new(pose.clone(), 2.0 * fov, FisheyeMapping::Equidistant)),
            Camera::Fisheye(Fisheye::new(pose.clone(), 360.0, FisheyeMapping::Equisolid)),
            Camera::Fisheye(Fisheye::new(pose.clone(), 2.0 * fov, FisheyeMapping::Stereographic)),
            Camera::Fisheye(Fisheye::new(pose, fov, FisheyeMapping::Orthographic)),
        ];
        for camera in cameras {
            let CameraRay { ray, weight } = camera.sample(film.into(), 1.5, lens.into(), 0.0);
            // Normalising rounds each component at most three times, so the length has the same relative error.
            prop_assert!((ray.direction.as_dvec3().length() - 1.0).abs() < 4.0 / 16_777_216.0, "{camera:?}: {ray:?}");
            // Where a camera sees nothing, its ray ends where it starts.
            let t_max = if weight == 0.0 { 0.0 } else { f32::INFINITY };
            prop_assert!(ray.t_max == t_max && ray.time == 0.0);
        }
    }

    /// All lens points of one film point meet in the plane of focus, where the pinhole's ray goes through it.
    #[test]
    fn the_plane_of_focus_is_sharp(film in shares(), lens in shares(), fov in 5.0f64..120.0, radius in 0.001f32..0.5, focus in 0.5f32..20.0) {
        let camera = Camera::Perspective(Perspective::new(identity(), fov, radius, focus));
        let ray = camera.ray(film.into(), 1.5, lens.into(), 0.0);
        let through = at_depth(&ray, f64::from(focus));
        let expected = at_depth(&self::ray(&pinhole(identity(), fov), film, 1.5), f64::from(focus));
        // For slanted rays the rounding error of the direction grows with the square of the slant.
        let slant = 1.0 + expected.length() / f64::from(focus) + f64::from(radius / focus);
        prop_assert!((through - expected).length() < FEW_ROUNDINGS * f64::from(focus) * slant * slant, "{} is not {}", through, expected);
        prop_assert!(ray.origin.z == 0.0 && ray.origin.length() <= radius * (1.0 + f32::EPSILON));
    }
}

/// Point where a ray of a camera at the origin crosses z = −depth.
fn at_depth(ray: &Ray, depth: f64) -> DVec3 {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    o + d * ((-depth - o.z) / d.z)
}

#[test]
fn fov_is_the_full_vertical_angle() {
    for (fov, aspect) in [(1.0, 1.0), (40.0, 1.0), (90.0, 2.0), (150.0, 0.5)] {
        let camera = pinhole(identity(), fov);
        let [top, bottom, left, right] = [[0.5, 0.0], [0.5, 1.0], [0.0, 0.5], [1.0, 0.5]].map(|film| direction(&camera, film, aspect));
        let across = 2.0 * (f64::from(aspect) * (fov / 2.0).to_radians().tan()).atan().to_degrees();
        let tolerance = 4.0 * FEW_ROUNDINGS.to_degrees();
        assert!((degrees_between(top, bottom) - fov).abs() < tolerance);
        assert!((degrees_between(left, right) - across).abs() < tolerance);
        assert!(top.y > 0.0 && bottom.y < 0.0 && left.x < 0.0 && right.x > 0.0, "y is up, x is right");
        assert_eq!(direction(&camera, [0.5, 0.5], aspect), DVec3::NEG_Z);
    }
}

/// A scaled pose turns and moves the camera, and does not scale the picture.
#[test]
fn scale_of_the_pose_is_ignored() {
    let scaled = Pose::new(&Transform::scale(DVec3::splat(4.0)).expect("not zero"));
    for pair in [identity(), scaled].map(|pose| Camera::Orthographic(Orthographic { pose, height: 3.0 })).windows(2) {
        assert_eq!(ray(&pair[0], [0.125, 0.75], 2.0), ray(&pair[1], [0.125, 0.75], 2.0));
    }
}

#[test]
fn the_panorama_is_oriented() {
    let camera = Camera::Spherical(Spherical { pose: identity() });
    let known = [
        ([0.5, 0.5], DVec3::NEG_Z),
        ([0.75, 0.5], DVec3::X),
        ([0.25, 0.5], DVec3::NEG_X),
        ([0.0, 0.5], DVec3::Z),
        ([1.0, 0.5], DVec3::Z),
        ([0.3, 0.0], DVec3::Y),
        ([0.3, 1.0], DVec3::NEG_Y),
    ];
    for (film, expected) in known {
        let found = direction(&camera, film, 2.0);
        assert!((found - expected).length() < FEW_ROUNDINGS, "{film:?}: {found} is not {expected}");
    }
}

/// tan(Ω/2) = a·(b×c)/(1 + a·b + b·c + c·a)
///
/// Source: Van Oosterom, Strackee, *The Solid Angle of a Plane Triangle* (1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The film, divided into triangles, covers the sphere once: all triangles have the same orientation, and their solid angles add up to 4π.
#[test]
fn the_panorama_holds_every_direction_once() {
    let camera = Camera::Spherical(Spherical { pose: identity() });
    let (columns, rows) = (64, 32);
    let corner = |i: u32, j: u32| direction(&camera, [i as f32 / columns as f32, j as f32 / rows as f32], 2.0);
    let mut sum = 0.0;
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
        // Clockwise from inside, where the camera is.
        for triangle in [[a, c, b], [a, d, c]] {
            let angle = solid_angle(triangle);
            // At the poles one of the two triangles has no area except for rounding.
            assert!(angle > -1e-6, "cell {i}, {j} is turned inside out: {angle}");
            sum += angle;
        }
    }
    // The triangles share their corners, so a gap can only be at the seam, which is π long and one rounding error wide.
    assert!((sum - 4.0 * PI).abs() < PI * FEW_ROUNDINGS, "{sum}");
}

/// f = 50 mm, N = 2, focused on 2 m: a point at 4 m blurs to .320512821 mm on the sensor.
///
/// c = A |d − s|/d · f/(s − f),    A = f/N
///
/// Here a lens of radius A/2 is focused on s; the sensor, v = f s/(s − f) behind the lens, is as high as its field of view: h = 2 v
/// tan(θ/2). Each point of the lens sees the point at 4 m at some height of the film. Between the upper and the lower edge of the lens
/// these heights differ by c/h.
#[test]
fn the_circle_of_confusion_is_that_of_a_thin_lens() {
    let (focal, number, focus, far, sensor): (f64, f64, f64, f64, f64) = (0.05, 2.0, 2.0, 4.0, 0.024);
    let image = focal * focus / (focus - focal);
    let fov = 2.0 * (sensor / 2.0 / image).atan().to_degrees();
    let camera = Camera::Perspective(Perspective::new(identity(), fov, (focal / number / 2.0) as f32, focus as f32));
    let height = |y: f32, lens: Vec2| at_depth(&camera.ray(Vec2::new(0.5, y), 1.5, lens, 0.0), far).y;
    // The height that is seen at 4 m is linear in the height on the film, so two rays determine where 0 is seen.
    let seen_at = |lens: Vec2| {
        let (top, bottom) = (height(0.25, lens), height(0.75, lens));
        0.25 + 0.5 * top / (top - bottom)
    };
    let shares = |i: u32| (i as f32 / 64.0).min(ONE_MINUS_EPSILON);
    let heights = (0..=64).flat_map(|i| (0..=64).map(move |j| Vec2::new(shares(i), shares(j)))).map(seen_at);
    let (least, most) = heights.fold((f64::MAX, f64::MIN), |(a, b), y| (a.min(y), b.max(y)));
    let confusion = (most - least) * sensor * 1e3;
    assert!((confusion / 0.320512821 - 1.0).abs() < 1e-4, "{confusion} mm");
}

/// The lens is uniform: the mean of r² is R²/2 and the mean of the points 0.
#[test]
fn the_whole_lens_is_used() {
    let camera = Camera::Perspective(Perspective::new(identity(), 40.0, 0.5, 2.0));
    assert_eq!(camera.effects(), Effects::THIN_LENS);
    assert_eq!(pinhole(identity(), 40.0).effects(), Effects::NONE);
    let (mut random, n) = (Random::new(7), 100_000);
    let (mut square, mut sum) = (0.0, DVec3::ZERO);
    for _ in 0..n {
        let lens = Vec2::new(random.unit() as f32, random.unit() as f32);
        let p = camera.ray(Vec2::new(0.2, 0.7), 1.5, lens, 0.0).origin.as_dvec3();
        square += p.length_squared();
        sum += p;
    }
    // Five standard errors; the deviation of r² is R²/√12, that of a coordinate R/2.
    let error = 5.0 / f64::from(n).sqrt();
    assert!((square / f64::from(n) / 0.25 - 0.5).abs() < error / 12f64.sqrt());
    assert!(sum.abs().max_element() / f64::from(n) < error * 0.25);
}

/// A scene moved by `by`. All numbers are exact in double precision.
fn moved(kind: usize, by: DVec3) -> World {
    let pose = Pose::new(&Transform::look_at(DVec3::new(0.5, 1.25, 4.0) + by, DVec3::new(0.0, 0.25, -0.5) + by, DVec3::Y).expect("sound"));
    let camera = match kind {
        0 => Camera::Perspective(Perspective::new(pose, 45.0, 0.125, 4.0)),
        1 => Camera::Orthographic(Orthographic { pose, height: 3.0 }),
        2 => Camera::Spherical(Spherical { pose }),
        3 => Camera::Perspective(Perspective::new(pose, 45.0, 0.125, 4.0).with_blades(Blades::new(6, 10.0)).tilted([20.0, 10.0])),
        _ => Camera::Fisheye(Fisheye::new(pose, 190.0, FisheyeMapping::Equisolid)),
    };
    let mut builder = World::builder(camera);
    let white = builder.material(Material::diffuse(Rgb::WHITE));
    let at = |x, y, z| Transform::translate(DVec3::new(x, y, z) + by).expect("finite");
    builder.shape(Sphere { radius: 0.5 }, at(-0.5, 0.25, 0.0), white, None);
    builder.shape(Disk { radius: 0.75 }, at(0.75, 0.5, -0.25), white, None);
    builder.shape(Quad { size: [8.0, 4.0] }, at(0.0, 0.0, -1.0), white, None);
    builder.build().expect("a sound scene")
}

/// If camera and scene are moved together, all hits are the same to the bit, because both are recentred in double precision.
#[test]
fn a_moved_world_gives_the_same_picture() {
    for kind in 0..5 {
        let worlds = [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2)].map(|by| moved(kind, by));
        let mut hits = 0;
        let mut random = Random::new(11);
        for i in 0..32 * 32 {
            let film = (Vec2::new((i % 32) as f32, (i / 32) as f32) + 0.5) / 32.0;
            let lens = random.square();
            let [here, there] = worlds.each_ref().map(|world| world.intersect(&world.camera().ray(film, 1.0, lens, 0.0)));
            assert_eq!(here, there, "film point {film} of camera {kind}");
            hits += usize::from(here.is_some());
        }
        assert!(hits > 40, "the scene is in view: {hits} hits of camera {kind}");
    }
}

/// Recentring moves the origin of the camera and changes nothing else.
#[test]
fn recentring_moves_the_eye() {
    let camera = Camera::Orthographic(Orthographic { pose: identity(), height: 2.0 });
    let (before, after) = (ray(&camera, [0.25, 0.5], 1.0), ray(&camera.recentred(DVec3::new(8.0, -4.0, 2.0)), [0.25, 0.5], 1.0));
    assert_eq!(before.origin - after.origin, Vec3::new(8.0, -4.0, 2.0));
    assert_eq!(before.direction, after.direction);
}
