//! The realistic camera: cardinal points by the lensmaker's equation, rays followed back to the film by another tracer, light that
//! arrives at the film, and focus.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3, Vec2};
use pt::camera::realistic::{LensTable, Sensor, ThickLens};
use pt::camera::{Camera, CameraRay, Perspective, Pose, Realistic};
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::math::Transform;
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use serde_json::json;

use crate::light_tracer::{built, film};
use crate::random::Random;

/// Rows of a table: radius, thickness, index, diameter (mm).
type Rows = Vec<[f64; 4]>;

/// A double Gauss of f/2 with a focal length of about 50 mm. Source: Tronnier, US patent 2,673,491 (1954), scaled from 100 mm.
const DOUBLE_GAUSS: [[f64; 4]; 11] = [
    [29.475, 3.76, 1.67, 25.2],
    [84.83, 0.12, 1.0, 25.2],
    [19.275, 4.025, 1.67, 23.0],
    [40.77, 3.275, 1.699, 23.0],
    [12.75, 5.705, 1.0, 18.0],
    [0.0, 4.5, 1.0, 17.1],
    [-14.495, 1.18, 1.603, 17.0],
    [40.77, 6.065, 1.658, 20.0],
    [-20.385, 0.19, 1.0, 20.0],
    [437.065, 3.22, 1.717, 20.0],
    [-39.73, 0.0, 1.0, 20.0],
];

/// A lens with a focal length of 50 mm behind a stop (mm). It is as thin as it can be: its surfaces do not meet within the stop, whose
/// radius is √(50 t) where they would.
fn thin(stop: f64) -> Rows {
    let thickness = (1.5 * stop * stop / 200.0).max(2e-3);
    vec![[0.0, 1e-6, 1.0, stop], [50.0, thickness, 1.5, 10.0], [-50.0, 0.0, 1.0, 10.0]]
}

fn table(rows: &[[f64; 4]]) -> LensTable {
    LensTable::new(rows).expect("a lens").scaled(1e-3)
}

/// A camera at the origin with a film for 36 × 24 mm.
fn camera(rows: &[[f64; 4]], focus_distance: f64) -> Realistic {
    let sensor = Sensor { height: 0.024, width: Some(0.036) };
    Realistic::new(Pose::new(&Transform::IDENTITY), &table(rows), focus_distance, sensor, 1.5).expect("a camera")
}

/// Part of an opening beyond its edge that still lets rays of 32-bit floats through, which come from a distance.
const ROUNDING: f64 = 1e-4;

/// Point of the film (m) for a position on it.
fn on_film(at: DVec2) -> DVec2 {
    DVec2::new(0.5 - at.x, at.y - 0.5) * DVec2::new(0.036, 0.024)
}

/// Mean weight of the rays of a film position, over a fine grid of points of the lens.
fn mean_weight(camera: &Camera, film: Vec2) -> f64 {
    const N: u32 = 400;
    let lens = |k: u32| Vec2::new((k % N) as f32 + 0.5, (k / N) as f32 + 0.5) / N as f32;
    (0..N * N).map(|k| f64::from(camera.sample(film, 1.5, lens(k), 0.0).weight)).sum::<f64>() / f64::from(N * N)
}

/// 1/f = (n − 1) (1/R₁ − 1/R₂ + (n − 1) d/(n R₁ R₂)), and the principal planes −f (n − 1) d/(n R₂) behind the front and −f (n − 1) d/(n R₁)
/// behind the rear vertex, where R₂ is negative for a lens that bulges to the rear.
#[test]
fn a_singlet_is_that_of_the_lensmaker() {
    for (n, front, rear, d) in [(1.5, 50.0, -70.0, 10.0), (1.8, 20.0, 45.0, 3.0), (1.33, -80.0, -15.0, 4.0), (1.7, 30.0, 0.0, 6.0)] {
        let table = LensTable::new(&[[front, d, n, 8.0], [rear, 0.0, 1.0, 8.0]]).expect("a lens");
        let [c1, c2] = [front, rear].map(|radius: f64| if radius == 0.0 { 0.0 } else { 1.0 / radius });
        let focal = 1.0 / ((n - 1.0) * (c1 - c2 + (n - 1.0) * d / n * c1 * c2));
        let expected = [focal, -focal * (n - 1.0) * d / n * c2, -focal * (n - 1.0) * d / n * c1];
        let found = ThickLens::new(&table).expect("it focuses");
        for (found, expected) in [found.focal_length, found.front, found.rear].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12 * focal, "n {n}, {front}, {rear}, {d}: {found} and not {expected}");
        }
        assert!((found.separation - (d + expected[2] - expected[1])).abs() < 1e-12 * focal);
        // Scaled, all lengths are.
        let scaled = ThickLens::new(&table.scaled(0.25)).expect("it focuses");
        assert_eq!([scaled.focal_length, scaled.front], [0.25 * found.focal_length, 0.25 * found.front]);
    }
}

/// 1/u + 1/v = 1/f with u from the object to H and v from H' to the film, for near and far objects.
#[test]
fn the_film_is_where_the_thick_lens_focuses() {
    let lens = ThickLens::new(&table(&DOUBLE_GAUSS)).expect("it focuses");
    // That of the patent, scaled; the indices of the table are rounded.
    assert!((lens.focal_length / 0.05 - 1.0).abs() < 0.01, "{}", lens.focal_length);
    for distance in [1.001 * lens.least_distance(), 0.3, 1.0, 25.0, 1e7] {
        let v = lens.film_distance(distance).expect("it focuses") - lens.rear;
        let u = distance - lens.separation - v;
        assert!(((1.0 / u + 1.0 / v) * lens.focal_length - 1.0).abs() < 1e-7 && u > v, "{distance} m: {u} and {v}");
    }
    assert_eq!(lens.film_distance(0.999 * lens.least_distance()), None);
    assert!((lens.least_distance() - 4.0 * lens.focal_length - lens.separation).abs() < 1e-15);
}

/// Follows a ray from the scene to the film with angles to the normals, in planes of incidence: the refracted direction has the angle
/// asin(sin θ n/n'). Returns the point of the film; `None` where the ray does not get through.
fn to_film(rows: &[[f64; 4]], film_distance: f64, mut p: DVec3, mut d: DVec3) -> Option<DVec2> {
    let length: f64 = rows[..rows.len() - 1].iter().map(|row| row[1]).sum();
    let (mut z, mut before) = (-(film_distance * 1e3 + length), 1.0);
    for [radius, thickness, ior, diameter] in rows {
        let normal = if *radius == 0.0 {
            p += d * ((z - p.z) / d.z);
            DVec3::NEG_Z
        } else {
            let center = DVec3::new(0.0, 0.0, z + radius);
            let (b, c) = ((p - center).dot(d), (p - center).length_squared() - radius * radius);
            let root = (b * b - c).sqrt();
            // The crossing on the side of the vertex.
            let t = if *radius > 0.0 { -b - root } else { -b + root };
            p += d * t;
            (center - p) / -radius
        };
        if p.truncate().length() > 0.5 * diameter * (1.0 + ROUNDING) || !p.is_finite() {
            return None;
        }
        let after = if *ior == 0.0 { 1.0 } else { *ior };
        let axis = d.cross(normal);
        if axis.length() > 1e-14 {
            let cos = -d.dot(normal);
            let angle = axis.length().atan2(cos);
            let refracted = (angle.sin() * before / after).asin();
            d = DMat3::from_axis_angle(axis.normalize(), refracted - angle) * d;
            // The turn is about the right axis.
            if (d.dot(-normal).acos() - refracted).abs() > 1e-6 {
                return None;
            }
        }
        (z, before) = (z + thickness, after);
    }
    Some((p + d * (-p.z / d.z)).truncate())
}

/// Each ray, followed back through the lens by another tracer, arrives at its place on the film: upright pictures have the film upside
/// down.
#[test]
fn rays_are_followed_back_to_their_place_on_the_film() {
    let wide = [[0.0, 2.0, 0.0, 4.0], [-14.0, 3.0, 1.62, 14.0], [-9.0, 0.0, 0.0, 16.0]];
    for (rows, focus) in [(DOUBLE_GAUSS.to_vec(), 1.5), (DOUBLE_GAUSS.to_vec(), 1e6), (thin(3.0), 2.0), (wide.to_vec(), 0.4)] {
        let realistic = camera(&rows, focus);
        let (distance, camera) = (realistic.film_distance(), Camera::Realistic(realistic));
        let (mut random, mut through) = (Random::new(4), 0);
        for _ in 0..4000 {
            let film = random.uniform_square();
            let CameraRay { ray, weight } = camera.sample(film, 1.5, random.uniform_square(), 0.0);
            if weight == 0.0 {
                assert_eq!(ray.t_max, 0.0);
                continue;
            }
            through += 1;
            // From 10 cm in front of the lens.
            let (origin, d) = (ray.origin.as_dvec3() * 1e3, ray.direction.as_dvec3().normalize());
            let found = to_film(&rows, distance, origin + d * 100.0, -d).expect("it came this way");
            let expected = on_film(film.as_dvec2()) * 1e3;
            // Roundings of the ray: of the direction, times 10 cm, and again times the way to the film.
            assert!((found - expected).length() < 2e-5, "{film}: {found} mm and not {expected} mm");
        }
        assert!(through > 1000, "{through}");
    }
}

/// Light of radiance 1 from everywhere gives the middle of the film 1, and Ω₀ = π sin² θ₀ is that of the cone from there to the stop.
#[test]
fn the_middle_of_the_film_has_the_radiance() {
    for (rows, focus) in [(DOUBLE_GAUSS.to_vec(), 2.0), (thin(8.0), 3.0), (thin(0.05), 3.0)] {
        let camera = Camera::Realistic(camera(&rows, focus));
        // 160,000 points; the rim of the pupil crosses about 1600 cells.
        let mean = mean_weight(&camera, Vec2::splat(0.5));
        assert!((mean - 1.0).abs() < 2e-3, "{mean}");
    }
    for stop in [2.0, 0.5, 0.05] {
        let camera = camera(&thin(stop), 3.0);
        let sine = 0.5e-3 * stop / camera.film_distance().hypot(0.5e-3 * stop);
        // Aberrations grow with the square of the stop over the focal length, which is at most 1/625.
        let (found, expected) = (camera.projected_solid_angle(), PI * sine * sine);
        assert!((found / expected - 1.0).abs() < 1e-3, "{stop} mm: {found} and not {expected}");
    }
}

/// A small stop beside a thin lens: the film gets cos⁴ θ of what its middle gets.
#[test]
fn light_falls_off_by_the_fourth_power_of_the_cosine() {
    let realistic = camera(&thin(0.2), 5.0);
    let (distance, camera) = (realistic.film_distance(), Camera::Realistic(realistic));
    for film in [[0.5, 0.5], [0.3, 0.5], [0.1, 0.9], [0.99, 0.01], [0.6, 0.05]] {
        let off = on_film(film.into()).length();
        let cos = distance / distance.hypot(off);
        let found = mean_weight(&camera, DVec2::from(film).as_vec2());
        assert!((found / cos.powi(4) - 1.0).abs() < 5e-3, "{film:?}: {found} and not {}", cos.powi(4));
    }
}

/// The irradiance at film points off the axis, relative to the middle, is that of all rays which another tracer finds to get through:
/// no part of the pupil is left out. The double Gauss darkens its corners by more than cos⁴.
#[test]
fn vignetting_is_that_of_all_rays() {
    const N: i32 = 600;
    let realistic = camera(&DOUBLE_GAUSS, 3.0);
    let (distance, solid_angle) = (realistic.film_distance(), realistic.projected_solid_angle());
    let camera = Camera::Realistic(realistic);
    let (stops, length) = (&DOUBLE_GAUSS, DOUBLE_GAUSS[..10].iter().map(|row| row[1]).sum::<f64>());
    let mut before = f64::INFINITY;
    for x in [0.5, 0.35, 0.2, 0.05, 0.0] {
        let film = on_film(DVec2::new(x, 0.5 - 0.4 * (0.5 - x)));
        // Through a plane behind the lens: from the film to the scene with the rows reversed is the same as from the scene.
        let reversed: Rows = (0..stops.len())
            .rev()
            .map(|k| [-stops[k][0], if k == 0 { 0.0 } else { stops[k - 1][1] }, if k == 0 { 1.0 } else { stops[k - 1][2] }, stops[k][3]])
            .collect();
        let half = 16e-3;
        let mut sum = 0.0;
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let rear = (DVec2::new(f64::from(i), f64::from(j)) + 0.5 - 0.5 * f64::from(N)) * (2.0 * half / f64::from(N));
            let way = (rear - film).extend(distance);
            // In the frame of the reversed lens its first surface is `distance` after the film; where the ray ends up does not matter.
            let start = film.extend(-(2.0 * distance + length * 1e-3)) * 1e3;
            if to_film(&reversed, distance, start, way.normalize()).is_some() {
                let cos = distance / way.length();
                sum += cos.powi(4) / (distance * distance) * (2.0 * half / f64::from(N)).powi(2);
            }
        }
        let (found, expected) = (mean_weight(&camera, DVec2::new(x, 0.5 - 0.4 * (0.5 - x)).as_vec2()), sum / solid_angle);
        assert!((found - expected).abs() < 4e-3, "{x}: {found} and not {expected}");
        let cos = distance / distance.hypot(film.length());
        assert!(found < before && (x > 0.0 || found < cos.powi(4)), "{x}: {found} is no vignetting");
        before = found;
    }
    assert!(before > 0.05, "the corner is not black: {before}");
}

/// Rays of a film point cross the axis at the distance of focus, counted from the film, if the stop is so small that only rays near the
/// axis get through.
#[test]
fn the_lens_is_in_focus() {
    let mut narrow = DOUBLE_GAUSS;
    narrow[5][3] = 0.5;
    for (rows, focus) in [(narrow.to_vec(), 1.0), (narrow.to_vec(), 0.35), (thin(0.5), 2.0)] {
        let camera = Camera::Realistic(camera(&rows, focus));
        for lens in [Vec2::new(0.2, 0.5), Vec2::new(0.5, 0.8), Vec2::new(0.35, 0.3)] {
            let CameraRay { ray, weight } = camera.sample(Vec2::splat(0.5), 1.5, lens, 0.0);
            assert!(weight > 0.0);
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let t = -o.truncate().dot(d.truncate()) / d.truncate().length_squared();
            let found = -(o + d * t).z;
            // Aberrations grow with the square of the stop, roundings of the direction with the distance.
            assert!((found / focus - 1.0).abs() < 2e-3, "focus {focus} m: {found} m");
        }
    }
}

/// f = 50 mm, focused on a plane 2 m from the lens: a point at 4 m blurs to c = A |d − s|/d · f/(s − f), .320512821 mm at f/2. The lens is
/// stopped down to f/100, where a single element has hardly any aberrations, and c is a fiftieth.
///
/// The cone of rays from the middle of the film has the diameter A (d − s)/s at the distance d. A point there blurs in the plane of focus
/// to s/d of it, and on the film to that times f/(s − f). The diameter follows from the mean of r², which is R²/2 for a disk.
#[test]
fn the_circle_of_confusion_is_that_of_a_thin_lens() {
    let image = 50.0 * 2e3 / (2e3 - 50.0);
    let realistic = camera(&thin(0.5), (2e3 + image) * 1e-3);
    let (lens_at, camera) = (realistic.film_distance(), Camera::Realistic(realistic));
    assert!((lens_at * 1e3 / image - 1.0).abs() < 1e-4, "{lens_at}");
    const N: u32 = 300;
    let (mut square, mut count) = (0.0, 0.0);
    for k in 0..N * N {
        let lens = Vec2::new((k % N) as f32 + 0.5, (k / N) as f32 + 0.5) / N as f32;
        let CameraRay { ray, weight } = camera.sample(Vec2::splat(0.5), 1.5, lens, 0.0);
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let p = o + d * ((-(lens_at + 4.0) - o.z) / d.z);
        square += f64::from(weight) * p.truncate().length_squared();
        count += f64::from(weight);
    }
    let cone = 2.0 * (2.0 * square / count).sqrt();
    let confusion = cone * (2.0 / 4.0) * 50.0 / (2e3 - 50.0) * 1e3;
    assert!((50.0 * confusion / 0.320512821 - 1.0).abs() < 5e-3, "{confusion} mm");
}

/// Near the axis the thin lens of a realistic camera sends its rays to the same points of the plane in focus, and its cone of rays is as wide.
#[test]
fn the_thin_lens_has_the_picture_near_the_axis() {
    // Through a wide opening the lens has aberrations.
    let mut stopped = DOUBLE_GAUSS;
    stopped[5][3] = 2.0;
    for focus in [0.6, 2.0] {
        let realistic = camera(&stopped, focus);
        let thin = realistic.thin_lens();
        assert!((thin.place + thin.focus_distance - focus).abs() < 1e-12);
        let pose = Pose::new(&Transform::translate(DVec3::new(0.0, 0.0, -thin.place)).expect("finite"));
        let perspective = Perspective::new(pose, 45.0, thin.radius as f32, thin.focus_distance as f32);
        let perspective = Camera::Perspective(perspective.with_sensor(thin.image_distance, 0.024, Some(0.036)));
        let realistic = Camera::Realistic(realistic);
        // Where a ray is at a distance from the film, and its weight.
        let met = |camera: &Camera, film: Vec2, lens: Vec2, distance: f64| {
            let CameraRay { ray, weight } = camera.sample(film, 1.5, lens, 0.0);
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            ((o + d * ((-distance - o.z) / d.z)).truncate(), f64::from(weight))
        };
        let width = 0.036 * thin.focus_distance / thin.image_distance;
        for film in [Vec2::new(0.5, 0.5), Vec2::new(0.53, 0.48), Vec2::new(0.46, 0.52)] {
            let [a, b] = [&realistic, &perspective].map(|camera| met(camera, film, Vec2::splat(0.5), focus).0);
            assert!((a - b).length() < 1e-3 * width, "{film}: {a} and not {b}");
        }
        const N: u32 = 200;
        let radius = |camera: &Camera| {
            let lens = |k: u32| Vec2::new((k % N) as f32 + 0.5, (k / N) as f32 + 0.5) / N as f32;
            let all = (0..N * N).map(|k| met(camera, Vec2::splat(0.5), lens(k), 2.0 * focus));
            let (square, count) =
                all.fold((0.0, 0.0), |(square, count), (p, weight)| (square + weight * p.length_squared(), count + weight));
            (2.0 * square / count).sqrt()
        };
        let [found, wanted] = [radius(&realistic), radius(&perspective)];
        // Light that arrives at a wide angle counts by the fourth power of its cosine: at f/18 less than a thousandth.
        assert!((found / wanted - 1.0).abs() < 0.005, "{found} m and not {wanted} m");
    }
}

/// In focus at infinity, neighbouring pixels differ by their width over the focal length, in angle.
#[test]
fn differentials_are_those_of_the_focal_length() {
    let mut narrow = DOUBLE_GAUSS;
    narrow[5][3] = 0.5;
    let (camera, focal) = (Camera::Realistic(camera(&narrow, 1e7)), ThickLens::new(&table(&narrow)).expect("it focuses").focal_length);
    let (film, lens, pixel) = (Vec2::splat(0.5), Vec2::new(0.4, 0.55), Vec2::new(1e-3, 2e-3));
    let ray = camera.ray(film, 1.5, lens, 0.0);
    let found = camera.differential(&ray, film, pixel, 1.5, lens);
    for (k, expected) in [DVec3::new(0.036 * 1e-3, 0.0, 0.0), DVec3::new(0.0, -0.024 * 2e-3, 0.0)].into_iter().enumerate() {
        let found = found.direction[k].as_dvec3();
        assert!((found - expected / focal).length() < 1e-3 * expected.length() / focal, "{k}: {found} and not {}", expected / focal);
    }
    // Where no ray gets through there is no neighbour either, and all stays finite.
    let camera = Camera::Realistic(self::camera(&DOUBLE_GAUSS, 1.0));
    let mut random = Random::new(8);
    for _ in 0..2000 {
        let (film, lens) = (random.uniform_square(), random.uniform_square());
        let found = camera.differential(&camera.ray(film, 1.5, lens, 0.0), film, pixel, 1.5, lens);
        assert!(found.origin.iter().chain(&found.direction).all(|v| v.is_finite()), "{film} {lens}: {found:?}");
    }
}

/// Paths from the lights do not find the way through the lens, and `light` says so; all other methods simulate it. They see the same
/// vignetted sky.
#[test]
fn integrators_simulate_the_lens_or_say_that_they_do_not() {
    let scene = json!({
        "pt": 1, "film": { "width": 12, "height": 8 }, "background": { "radiance": 1 },
        "camera": { "type": "realistic", "lens": DOUBLE_GAUSS, "focus_distance": 2 }
    });
    let world = Arc::new(built(&scene.to_string()).world);
    assert!(world.effects().contains(Effects::REALISTIC_LENS | Effects::THIN_LENS));
    let expected = |k: u32| mean_weight(world.camera(), (Vec2::new((k % 12) as f32, (k / 12) as f32) + 0.5) / Vec2::new(12.0, 8.0));
    for entry in ALL.iter().filter(|entry| !entry.simulates.is_empty()) {
        let lacks = entry.lacks(world.effects());
        match entry.name {
            "light" => assert!(lacks.is_some_and(|said| said.starts_with("realistic lens (only lamps and the background are seen"))),
            name => assert_eq!(lacks, None, "{name}"),
        }
        let sampler = SamplerSpec { kind: Kind::Sobol, spp: 4096, ..SamplerSpec::default() };
        let image = film(world.clone(), entry.name, "", FilmSpec::new(12, 8), sampler).image();
        // Pixels at the edge of the picture see a range of angles.
        for k in [0, 17, 41, 54] {
            let [value, ..] = image.pixels().nth(k as usize).expect("a pixel");
            assert!((f64::from(value) - expected(k)).abs() < 0.02, "pixel {k} by {}: {value} and not {}", entry.name, expected(k));
        }
    }
}

/// Scaled by a power of two, with all that the scene has, the camera's rays are the same, bit for bit.
#[test]
fn scaled_cameras_have_the_same_rays() {
    for k in [-20, 3, 20] {
        let factor = 2f64.powi(k);
        let [plain, scaled] = [1.0, factor].map(|factor| {
            let table = LensTable::new(&DOUBLE_GAUSS).expect("a lens").scaled(1e-3 * factor);
            let sensor = Sensor { height: 0.024 * factor, width: None };
            let camera = Realistic::new(Pose::new(&Transform::IDENTITY), &table, 1.5 * factor, sensor, 1.5).expect("a camera");
            Camera::Realistic(camera)
        });
        let mut random = Random::new(9);
        for _ in 0..500 {
            let (film, lens) = (random.uniform_square(), random.uniform_square());
            let [a, b] = [&plain, &scaled].map(|camera| camera.sample(film, 1.5, lens, 0.0));
            assert_eq!((a.ray.origin * factor as f32, a.ray.direction, a.weight), (b.ray.origin, b.ray.direction, b.weight));
        }
    }
}
