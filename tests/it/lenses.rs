//! Lenses: the keys of photographers, openings with blades, shifted films, tilted planes of focus and fisheye lenses, compared with
//! formulas in double precision.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3, Vec2};
use proptest::prelude::*;
use pt::camera::{Blades, Camera, CameraRay, Fisheye, FisheyeMapping, Perspective, Pose};
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::math::{Ray, Transform};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use serde_json::{Value, json};

use crate::light_tracer::{built, film};
use crate::random::{Random, cases};

/// Components of a unit direction err by a few roundings of 2⁻²⁴.
const FEW_ROUNDINGS: f64 = 16.0 / 16_777_216.0;

fn identity() -> Pose {
    Pose::new(&Transform::IDENTITY)
}

/// The camera that a scene file describes, at the origin.
fn described(camera: Value) -> Camera {
    built(&json!({ "pt": 1, "camera": camera }).to_string()).world.camera().clone()
}

fn ray(camera: &Camera, film: [f64; 2], aspect: f32, lens: Vec2) -> Ray {
    camera.ray(DVec2::from(film).as_vec2(), aspect, lens, 0.0)
}

/// Point where a ray of a camera at the origin crosses z = −depth.
fn at_depth(ray: &Ray, depth: f64) -> DVec3 {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    o + d * ((-depth - o.z) / d.z)
}

/// tan(θ/2) = h/2f from top to bottom, and w/2f across if the sensor has a width.
#[test]
fn the_view_is_that_of_the_sensor() {
    let known = [
        (json!({ "focal_length": 50 }), [12.0 / 50.0 * 1.5, 12.0 / 50.0]),
        (json!({ "focal_length": 35, "sensor": 15.6 }), [7.8 / 35.0 * 1.5, 7.8 / 35.0]),
        (json!({ "focal_length": 24, "sensor": [36, 24] }), [18.0 / 24.0, 12.0 / 24.0]),
        (json!({ "focal_length": 80, "sensor": [56, 56], "f_number": 2.8, "focus_distance": 3 }), [28.0 / 80.0, 28.0 / 80.0]),
    ];
    for (camera, [right, up]) in known {
        let corner = at_depth(&ray(&described(camera.clone()), [1.0, 0.0], 1.5, Vec2::splat(0.5)), 1.0);
        // The ray of the middle of the lens, whose numbers are ½.
        assert!((corner - DVec3::new(right, up, -1.0)).length() < FEW_ROUNDINGS, "{camera}: {corner}");
    }
}

/// The diameter of the lens is the focal length over the f-number, and the focal length of a field of view is h / (2 tan(θ/2)).
#[test]
fn the_f_number_gives_the_diameter_of_the_lens() {
    let by_fov = 0.5 * 24.0 / 20f64.to_radians().tan();
    for (camera, focal_length, number) in [
        (json!({ "focal_length": 50, "f_number": 2 }), 50.0, 2.0),
        (json!({ "focal_length": 8, "sensor": 5, "f_number": 0.7 }), 8.0, 0.7),
        (json!({ "fov": 40, "f_number": 4 }), by_fov, 4.0),
        (json!({ "f_number": 4, "sensor": 48 }), 2.0 * by_fov, 4.0),
    ] {
        let lens = described(camera.clone());
        // The concentric map takes the middle of an edge of the square to the edge of the disk.
        let edge = f64::from(ray(&lens, [0.5, 0.5], 1.5, Vec2::new(0.0, 0.5)).origin.length());
        let expected = 0.5e-3 * focal_length / number;
        assert!((edge / expected - 1.0).abs() < FEW_ROUNDINGS, "{camera}: {edge} m and not {expected} m");
    }
}

/// f = 50 mm, N = 2, focused on 2 m: a point at 4 m blurs to .320512821 mm on the sensor, which is v = f s/(s − f) behind the lens.
///
/// c = A |d − s|/d · f/(s − f),    A = f/N
///
/// The scene states v as the focal length, with the f-number v/A, because focusing does not change a view that is stated by a focal
/// length. The blur is the part of the film on which rays from all over the lens meet a point at 4 m, times the height of the sensor.
#[test]
fn the_circle_of_confusion_is_that_of_a_thin_lens() {
    let (focal, focus, far, diameter): (f64, f64, f64, f64) = (50.0, 2e3, 4e3, 25.0);
    let image = focal * focus / (focus - focal);
    let camera = described(json!({ "focal_length": image, "f_number": image / diameter, "focus_distance": focus * 1e-3 }));
    let height = |y: f64, lens: Vec2| at_depth(&ray(&camera, [0.5, y], 1.5, lens), far * 1e-3).y;
    // The height that is seen at 4 m is linear in the height on the film, so two rays determine where 0 is seen.
    let seen_at = |lens: Vec2| {
        let (top, bottom) = (height(0.25, lens), height(0.75, lens));
        0.25 + 0.5 * top / (top - bottom)
    };
    let [a, b] = [Vec2::new(0.5, 0.0), Vec2::new(0.5, 1.0)].map(seen_at);
    let confusion = (a - b).abs() * 24.0;
    assert!((confusion / 0.320512821 - 1.0).abs() < 1e-4, "{confusion} mm");
    // By the focal length itself the blur in the plane of focus is the same, A (d − s)/d, and the magnification of a lens that is not
    // moved out is f/s.
    let plain = described(json!({ "focal_length": focal, "f_number": 2, "focus_distance": 2 }));
    let blur = [Vec2::new(0.5, 0.0), Vec2::new(0.5, 1.0)].map(|lens| {
        // The ray of a point on the axis at 4 m through the lens point, in the plane at 2 m.
        let on_lens = plain.ray(Vec2::splat(0.5), 1.5, lens, 0.0).origin.as_dvec3();
        0.5 * on_lens.y
    });
    assert!(((blur[0] - blur[1]).abs() * 1e3 / (diameter * 0.5) - 1.0).abs() < FEW_ROUNDINGS);
    assert!((diameter * 0.5 * focal / (focus - focal) / 0.320512821 - 1.0).abs() < 1e-8);
}

/// Points on the lens lie in the polygon, whose corners are R from the centre; their mean is 0 and the mean of r² that of the polygon,
/// R² (2 + cos(2π/n))/6. Each of the n triangles gets the same share, and so does the inner half of the area of each.
#[test]
fn blades_are_sampled_evenly() {
    let (radius, n) = (0.5, 60_000);
    for (blades, rotation) in [(3, 0.0), (5, 0.0), (6, 17.0), (7, -400.0), (64, 1.0)] {
        let camera = Camera::Perspective(Perspective::new(identity(), 40.0, radius, 2.0).with_blades(Blades::new(blades, rotation)));
        let (count, mut random) = (f64::from(blades), Random::new(3));
        let first = PI / 2.0 + rotation.to_radians();
        let (mut square, mut sum, mut farthest) = (0.0, DVec3::ZERO, 0f64);
        let (mut triangles, mut inner) = (vec![0u32; blades as usize], 0);
        for _ in 0..n {
            let p = camera.ray(Vec2::splat(0.5), 1.5, random.uniform_square(), 0.0).origin.as_dvec3() / f64::from(radius);
            // Angle from the corner before the point, in units of the angle between corners.
            let around = ((p.y.atan2(p.x) - first) / TAU * count).rem_euclid(count);
            let to_side = p.truncate().length() * ((around.fract() - 0.5) * TAU / count).cos() / (PI / count).cos();
            assert!(p.z == 0.0 && to_side < 1.0 + FEW_ROUNDINGS, "{blades} blades: {p}");
            triangles[around as usize % blades as usize] += 1;
            inner += u32::from(to_side < 0.5f64.sqrt());
            (square, sum, farthest) = (square + p.length_squared(), sum + p, farthest.max(p.length()));
        }
        let n = f64::from(n);
        // Five standard errors of shares and of means of numbers within ±1.
        let within = |found: f64, expected: f64, deviation: f64| (found - expected).abs() < 5.0 * deviation / n.sqrt();
        assert!(within(f64::from(inner) / n, 0.5, 0.5), "{blades} blades: {inner}");
        let share = 1.0 / count;
        triangles.iter().for_each(|k| assert!(within(f64::from(*k) / n, share, (share * (1.0 - share)).sqrt()), "{blades}: {triangles:?}"));
        assert!(within(square / n, (2.0 + (TAU / count).cos()) / 6.0, 0.5), "{blades} blades: r² {}", square / n);
        assert!(within(sum.x / n, 0.0, 0.75) && within(sum.y / n, 0.0, 0.75), "{blades} blades: {sum}");
        assert!(farthest > 0.95 && farthest < 1.0 + FEW_ROUNDINGS, "{blades} blades: {farthest}");
    }
}

/// Without blades, and with 0 of them, the lens is the same disk, bit for bit.
#[test]
fn no_blades_are_a_disk() {
    let [plain, round] = [json!({}), json!({ "blades": 0, "rotation": 20 })]
        .map(|iris| described(json!({ "lens_radius": 0.1, "focus_distance": 2, "aperture": iris })));
    assert_eq!(plain, described(json!({ "lens_radius": 0.1, "focus_distance": 2 })));
    assert_eq!(plain, round);
}

/// Normal of the plane of focus: the axis, turned about x and then about y.
fn normal(tilt: [f64; 2]) -> DVec3 {
    let [about_x, about_y] = tilt.map(f64::to_radians);
    DMat3::from_rotation_y(about_y) * DMat3::from_rotation_x(about_x) * DVec3::Z
}

proptest! {
    #![proptest_config(cases(5_000))]

    /// A shifted film shows at (x, y) what the film shows at (x + right, y − up) that is not shifted, which may be beyond its edge.
    #[test]
    fn a_shift_moves_the_view(x in 0.0..1.0, y in 0.0..1.0, right in -2.0..2.0, up in -2.0..2.0, fov in 5.0f64..120.0, aspect in 0.25f32..4.0) {
        let camera = Camera::Perspective(Perspective::new(identity(), fov, 0.0, 1.0).shifted([right, up]));
        let tan = (fov / 2.0).to_radians().tan();
        let (across, height) = (2.0 * (x + right) - 1.0, 1.0 - 2.0 * (y - up));
        let expected = DVec3::new(across * tan * f64::from(aspect), height * tan, -1.0).normalize();
        let found = ray(&camera, [x, y], aspect, Vec2::splat(0.5)).direction.as_dvec3();
        prop_assert!((found - expected).length() < 2.0 * FEW_ROUNDINGS, "{} is not {}", found, expected);
    }

    /// All rays of a film point meet in the tilted plane of focus, where the pinhole's ray goes through it. If that is behind the
    /// camera, they come from there.
    #[test]
    fn the_tilted_plane_of_focus_is_sharp(
        x in 0.0..1.0, y in 0.0..1.0, u in 0f32..1.0, v in 0f32..1.0, about_x in -80.0..80.0, about_y in -80.0..80.0,
        fov in 5.0f64..100.0, radius in 0.001f32..0.5, focus in 0.5f32..20.0, blades in 2u32..8,
    ) {
        let plain = Perspective::new(identity(), fov, radius, focus);
        let lens = if blades > 2 { plain.with_blades(Blades::new(blades, 10.0)) } else { plain };
        let camera = Camera::Perspective(lens.tilted([about_x, about_y]));
        let towards = ray(&Camera::Perspective(Perspective::new(identity(), fov, 0.0, 1.0)), [x, y], 1.5, Vec2::ZERO).direction.as_dvec3();
        let (n, center) = (normal([about_x, about_y]), DVec3::new(0.0, 0.0, -f64::from(focus)));
        let distance = n.dot(center) / n.dot(towards);
        let expected = towards * distance;
        // Near the horizon of the plane its points are too far away.
        prop_assume!(distance.abs() < 100.0 * f64::from(focus));
        let found = ray(&camera, [x, y], 1.5, Vec2::new(u, v));
        let (o, d) = (found.origin.as_dvec3(), found.direction.as_dvec3());
        // How far the line of the ray passes by the point.
        let away = (expected - o).cross(d).length();
        let slant = (1.0 + f64::from(radius / focus)) / n.z;
        prop_assert!(away < FEW_ROUNDINGS * (1.0 + distance.abs()) * slant * slant, "{} m from {}", away, expected);
        prop_assert!(d.z < 0.0 && o.z == 0.0);
    }

    /// r = m(θ)/m(θ_max) of the radius of the circle, in the direction of the azimuth; outside of the circle there is nothing.
    #[test]
    fn fisheye_lenses_are_their_formulas(x in 0.0..1.0, y in 0.0..1.0, fov in 5.0f64..175.0, aspect in 0.25f32..4.0, kind in 0usize..4) {
        let (mapping, m): (_, fn(f64) -> f64) = [
            (FisheyeMapping::Equidistant, (|angle| angle) as fn(f64) -> f64),
            (FisheyeMapping::Equisolid, |angle| (0.5 * angle).sin()),
            (FisheyeMapping::Stereographic, |angle| (0.5 * angle).tan()),
            (FisheyeMapping::Orthographic, f64::sin),
        ][kind];
        // Beyond the half space where the lens allows it.
        let fov = if mapping == FisheyeMapping::Orthographic { fov } else { 2.0 * fov };
        let camera = Camera::Fisheye(Fisheye::new(identity(), fov, mapping));
        let wide = f64::from(aspect).max(1.0);
        let high = (1.0 / f64::from(aspect)).max(1.0);
        let place = DVec2::new((2.0 * x - 1.0) * wide, (1.0 - 2.0 * y) * high);
        let CameraRay { ray, weight } = camera.sample(DVec2::new(x, y).as_vec2(), aspect, Vec2::ZERO, 0.0);
        prop_assume!((place.length() - 1.0).abs() > 1e-6);
        prop_assert_eq!(weight, if place.length() < 1.0 { 1.0 } else { 0.0 });
        if weight > 0.0 {
            let w = ray.direction.as_dvec3();
            let angle = w.truncate().length().atan2(-w.z);
            let slope = if mapping == FisheyeMapping::Stereographic { 0.5 / (0.5 * angle).cos().powi(2) } else { 1.0 };
            let found = m(angle) / m(fov.to_radians() / 2.0);
            let tolerance = 4.0 * FEW_ROUNDINGS * slope.max(1.0) / m(fov.to_radians() / 2.0) + FEW_ROUNDINGS;
            prop_assert!((found - place.length()).abs() < tolerance, "{:?}: {} and not {}", mapping, found, place.length());
            prop_assert!((w.truncate() * place.length() - place * w.truncate().length()).length() < FEW_ROUNDINGS);
        }
    }
}

/// Where the axis of a shifted lens meets the film, it looks along the axis: half a height up, the horizon is at the lower edge.
#[test]
fn half_a_height_up_the_horizon_is_at_the_lower_edge() {
    let camera = described(json!({ "fov": 60, "shift": [0, 0.5] }));
    assert_eq!(ray(&camera, [0.5, 1.0], 1.5, Vec2::ZERO).direction.as_dvec3(), DVec3::NEG_Z);
    let camera = described(json!({ "fov": 60, "shift": [-0.5, 0] }));
    assert_eq!(ray(&camera, [1.0, 0.5], 1.5, Vec2::ZERO).direction.as_dvec3(), DVec3::NEG_Z);
}

/// Under a sky of radiance 1 the round picture is 1 and the rest black, with every integrator that finds a sky, pixel by pixel.
#[test]
fn a_round_picture_is_black_around_it() {
    for mapping in ["equidistant", "equisolid", "stereographic", "orthographic"] {
        let camera = json!({ "type": "fisheye", "fov": 170, "mapping": mapping });
        let scene = json!({ "pt": 1, "camera": camera, "film": { "width": 24, "height": 16 }, "background": { "radiance": 1 } });
        let world: Arc<dyn Scene> = Arc::new(built(&scene.to_string()).world);
        for entry in ALL.iter().filter(|entry| !entry.simulates.is_empty()) {
            let sampler = SamplerSpec { kind: Kind::Sobol, spp: 4, ..SamplerSpec::default() };
            let image = film(world.clone(), entry.name, "", FilmSpec::new(24, 16), sampler).image();
            for (k, [value, ..]) in image.pixels().enumerate() {
                let distance = ((k % 24) as f64 - 11.5).hypot((k / 24) as f64 - 7.5);
                match distance {
                    d if d < 8.0 - 0.5f64.sqrt() => assert_eq!(value, 1.0, "{mapping} by {}, pixel {k}", entry.name),
                    d if d > 8.0 + 0.5f64.sqrt() => assert_eq!(value, 0.0, "{mapping} by {}, pixel {k}", entry.name),
                    _ => assert!((0.0..=1.0).contains(&value), "{mapping} by {}, pixel {k}: {value}", entry.name),
                }
            }
        }
    }
}

/// The differential of a fisheye's ray is the change to the neighbours, also at the edge of the circle, where one of them does not exist.
#[test]
fn differentials_stay_in_the_circle() {
    let camera = Camera::Fisheye(Fisheye::new(identity(), 180.0, FisheyeMapping::Equidistant));
    let pixel = Vec2::splat(1e-3);
    for film in [Vec2::new(0.5, 0.5), Vec2::new(0.9995, 0.5), Vec2::new(0.0005, 0.5), Vec2::new(0.5, 0.0005), Vec2::new(0.2, 0.7)] {
        let ray = camera.ray(film, 1.0, Vec2::ZERO, 0.0);
        let found = camera.differential(&ray, film, pixel, 1.0, Vec2::ZERO);
        // An equidistant lens turns by π times the part of the film, along the radius.
        let radial = (film - 0.5).normalize_or(Vec2::X);
        let change = (found.direction[0] * radial.x + found.direction[1] * radial.y).length();
        assert!((f64::from(change) / (PI * 1e-3) - 1.0).abs() < 0.02, "{film}: {change}");
    }
}
