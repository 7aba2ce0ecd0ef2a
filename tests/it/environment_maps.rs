//! Environment maps and suns: conventions, densities, exact irradiances, and bits that do not change with scale and rotation.

use std::collections::BTreeMap;
use std::f32::consts::FRAC_1_SQRT_2;
use std::f64::consts::{PI, TAU};
use std::io::Cursor;
use std::sync::Arc;

use glam::{DVec3, Mat3, UVec2, Vec2, Vec3};
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::light::{Environment, EnvironmentMap, Light, LightSample, LightSampleContext, Lights, Mapping, Sky, Sun};
use pt::math::equal_area::{sphere_to_square, square_to_sphere};
use pt::math::{Rgb, Spectrum};
use pt::scene::Scene as _;
use pt::texture::image::Pixels;

use crate::random::Random;

/// A map whose pixel (x, y) has the colour `color(x, y)`.
fn map(size: [u32; 2], mapping: Mapping, color: impl Fn(u32, u32) -> [f32; 3]) -> EnvironmentMap {
    turned(size, mapping, Mat3::IDENTITY, color)
}

fn turned(size: [u32; 2], mapping: Mapping, to_world: Mat3, color: impl Fn(u32, u32) -> [f32; 3]) -> EnvironmentMap {
    let values = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| color(x, y)).collect();
    EnvironmentMap::new(Arc::new(Pixels::new(UVec2::from(size), values).expect("pixels")), mapping, Rgb::WHITE, to_world)
}

fn lights(map: EnvironmentMap) -> Lights {
    alone(Light::EnvironmentMap(Arc::new(map)))
}

fn alone(light: Light) -> Lights {
    Lights::new(vec![light], vec![].into(), (Vec3::ZERO, 1.0))
}

/// A point on an opaque surface with this normal.
fn facing(n: Vec3) -> LightSampleContext {
    LightSampleContext { ng: n, ns: n, ..LightSampleContext::at(Vec3::ZERO) }
}

/// Pixels of random brightness, over five decades.
fn noisy(seed: u64) -> impl Fn(u32, u32) -> [f32; 3] {
    move |x, y| {
        let mut random = Random::new(seed + u64::from(y * 4096 + x));
        [0; 3].map(|_| random.decade(-3.0, 2.0) as f32)
    }
}

/// Maps whose directions are easily sampled wrongly.
fn maps() -> Vec<(&'static str, EnvironmentMap)> {
    let only = |at: [u32; 2]| move |x, y| [if [x, y] == at { 1e3 } else { 0.0 }; 3];
    let row = |of: u32| move |_, y| [if y == of { 5.0 } else { 0.0 }; 3];
    vec![
        ("noise", map([32, 16], Mapping::LatLong, noisy(1))),
        ("noise on a square", map([16, 16], Mapping::Octahedral, noisy(2))),
        ("turned noise", turned([16, 8], Mapping::LatLong, Mat3::from_rotation_x(1.0) * Mat3::from_rotation_y(2.0), noisy(3))),
        ("mirrored noise", turned([8, 8], Mapping::Octahedral, Mat3::from_diagonal(Vec3::new(1.0, -1.0, 1.0)), noisy(4))),
        ("one pixel at the pole", map([16, 8], Mapping::LatLong, only([3, 0]))),
        ("one pixel at the seam", map([16, 8], Mapping::LatLong, only([15, 5]))),
        ("one pixel in a corner", map([8, 8], Mapping::Octahedral, only([7, 0]))),
        ("one pixel at a side", map([8, 8], Mapping::Octahedral, only([3, 7]))),
        ("lower pole lit", map([16, 8], Mapping::LatLong, row(7))),
        ("two pixels wide", map([2, 4], Mapping::LatLong, noisy(5))),
        ("one pixel wide", map([1, 5], Mapping::LatLong, noisy(6))),
        ("one pixel", map([1, 1], Mapping::LatLong, noisy(7))),
        ("one pixel of a square", map([1, 1], Mapping::Octahedral, noisy(8))),
        ("odd width", map([7, 3], Mapping::LatLong, noisy(9))),
    ]
}

/// Directions in the middles of `n`² parts of equal solid angle, and their solid angle.
fn directions(n: u32) -> (impl Iterator<Item = Vec3>, f64) {
    let middle = move |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    let direction = move |(i, j)| {
        let (z, phi) = (2.0 * middle(i) - 1.0, TAU * middle(j));
        DVec3::new((1.0 - z * z).sqrt() * phi.cos(), z, (1.0 - z * z).sqrt() * phi.sin()).as_vec3()
    };
    ((0..n).flat_map(move |i| (0..n).map(move |j| (i, j))).map(direction), 4.0 * PI / f64::from(n * n))
}

fn radiance(lights: &Lights, w: Vec3) -> Spectrum {
    lights.background(w).map(|(_, radiance)| radiance).fold(Spectrum::BLACK, |a, b| a + b)
}

fn smooth(sample: &LightSample) -> f64 {
    sample.density.smooth().expect("a density").get().into()
}

/// Hammersley's set of points, with an error far below that of random points.
fn points(count: u32) -> impl Iterator<Item = Vec2> {
    let point = move |k: u32| Vec2::new((f64::from(k) + 0.5) as f32 / count as f32, (f64::from(k.reverse_bits()) / 4294967296.0) as f32);
    (0..count).map(move |k| point(k).min(Vec2::splat(1.0 - f32::EPSILON / 2.0)))
}

/// pbrt's table: points of the square and their directions.
#[test]
fn the_square_maps_to_the_sphere_as_in_pbrt() {
    for (square, w) in [
        ([0.5, 0.5], [0.0, 0.0, 1.0]),
        ([0.75, 0.5], [0.661438, 0.0, 0.75]),
        ([0.25, 0.25], [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0]),
        ([0.625, 0.75], [0.449609, 0.778746, 0.4375]),
        ([0.9, 0.8], [0.665432, 0.384188, -0.64]),
    ] {
        let (square, w) = (Vec2::from(square), Vec3::from(w));
        assert!((square_to_sphere(square) - w).length() < 2e-6, "{square}: {}", square_to_sphere(square));
        // The tables have six digits, of which the square loses up to one near the equator.
        assert!((sphere_to_square(w.normalize()) - square).length() < 2e-6, "{w}: {}", sphere_to_square(w));
    }
}

/// The Jacobian of the map is 4π everywhere: by differences over a hundredth of the side.
#[test]
fn equal_areas_are_equal_solid_angles() {
    let mut random = Random::new(1);
    for _ in 0..2000 {
        let [u, v] = [0; 2].map(|_| (random.unit() * 0.99) as f32);
        let step = 0.01;
        let corner = |du: f32, dv: f32| square_to_sphere(Vec2::new(u + du, v + dv)).as_dvec3();
        let [a, b, c, d] = [corner(0.0, 0.0), corner(step, 0.0), corner(step, step), corner(0.0, step)];
        assert!((a.length() - 1.0).abs() < 1e-6, "{a}");
        // Folds of the octahedron break the two triangles.
        let folds = |x: f32| (2.0 * x - 1.0) * (2.0 * (x + step) - 1.0) < 0.0;
        let height = |du: f32, dv: f32| (2.0 * (u + du) - 1.0).abs() + (2.0 * (v + dv) - 1.0).abs() - 1.0;
        let heights = [height(0.0, 0.0), height(step, 0.0), height(step, step), height(0.0, step)];
        if folds(u) || folds(v) || heights.iter().any(|h| h * heights[0] < 0.0) {
            continue;
        }
        let area = 0.5 * ((b - a).cross(c - a).length() + (c - a).cross(d - a).length());
        assert!((area / (4.0 * PI * f64::from(step * step)) - 1.0).abs() < 0.03, "({u}, {v}): {area}");
    }
}

/// Name of a program, its mapping, the size of a picture, the rotation to the world, and directions with the columns and rows that they
/// show.
type Convention = (&'static str, Mapping, [u32; 2], Mat3, &'static [([f32; 3], [f32; 2])]);

/// The directions that each renderer's maps show, after the rotation that docs/environment.md gives for it: the columns and rows that
/// are seen in a picture whose red is the column and whose green is the row, both counted from 1.
#[test]
fn each_convention_has_its_directions() {
    let half_turn = Mat3::from_rotation_y(std::f32::consts::PI);
    let quarter_turn = Mat3::from_rotation_y(-std::f32::consts::FRAC_PI_2);
    let up_is_z = Mat3::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let rows: [Convention; 4] = [
        // Of pt: −z in the middle, +x to its right.
        (
            "pt",
            Mapping::LatLong,
            [8, 4],
            Mat3::IDENTITY,
            &[([0.0, 0.0, -1.0], [4.5, 2.5]), ([1.0, 0.0, 0.0], [6.5, 2.5]), ([-1.0, 0.0, 0.0], [2.5, 2.5]), ([0.0, 1.0, 0.0], [4.5, 1.0])],
        ),
        // Measured with Mitsuba 3. (It puts the middles of the first and last row on the poles, and so shows (0.3, 0.4, −0.866) the row
        // 2.107: a shift of up to half a pixel towards the equator.)
        (
            "Mitsuba",
            Mapping::LatLong,
            [8, 4],
            half_turn,
            &[
                ([0.0, 0.0, -1.0], [4.5, 2.5]),
                ([1.0, 0.0, 0.0], [2.5, 2.5]),
                ([0.0, 0.0, 1.0], [4.5, 2.5]),
                ([-1.0, 0.0, 0.0], [6.5, 2.5]),
                ([0.3, 0.4, -0.8660254], [1.52786, 1.97604]),
            ],
        ),
        // u = ½ + atan2(z, x)/2π, v = acos(y)/π, as three.js and Blender's glTF scenes have it.
        (
            "glTF",
            Mapping::LatLong,
            [8, 4],
            quarter_turn,
            &[([1.0, 0.0, 0.0], [4.5, 2.5]), ([0.0, 0.0, 1.0], [6.5, 2.5]), ([0.0, 0.0, -1.0], [2.5, 2.5])],
        ),
        // pbrt's table above, with 8² pixels and +z up.
        (
            "pbrt",
            Mapping::Octahedral,
            [8, 8],
            up_is_z,
            &[
                ([0.0, 0.0, 1.0], [4.5, 4.5]),
                ([0.661438, 0.0, 0.75], [6.5, 4.5]),
                ([-FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0], [2.5, 2.5]),
                ([0.449609, 0.778746, 0.4375], [5.5, 6.5]),
                ([0.665432, 0.384188, -0.64], [7.7, 6.9]),
            ],
        ),
    ];
    for (name, mapping, size, to_world, places) in rows {
        let map = turned(size, mapping, to_world, |x, y| [x as f32 + 1.0, y as f32 + 1.0, 0.0]);
        for &(w, [column, row]) in places {
            let [r, g, _] = map.radiance(Vec3::from(w).normalize()).to_rgb();
            // Column and row of a pole or of the seam are means over the pixels that meet there.
            let is_pole = w == [0.0, 1.0, 0.0];
            assert!((g - row).abs() < 2e-4 && (is_pole || (r - column).abs() < 2e-4), "{name}, {w:?}: ({r}, {g})");
        }
    }
}

/// Going from the picture to a direction and back leads to the same place, everywhere.
#[test]
fn mappings_are_inverses() {
    let mut random = Random::new(2);
    for mapping in [Mapping::LatLong, Mapping::Octahedral] {
        for _ in 0..20_000 {
            let uv = random.square();
            let w = mapping.direction(uv);
            let again = mapping.direction(mapping.coordinates(w));
            assert!((w.length() - 1.0).abs() < 1e-6 && (again - w).length() < 2e-6, "{mapping:?} {uv}: {w} and {again}");
            let w = random.direction().as_vec3();
            assert!((mapping.direction(mapping.coordinates(w)) - w).length() < 2e-6, "{mapping:?}: {w}");
        }
    }
}

/// Densities, of directions for a point and of emitted rays, integrate to 1 over the sphere.
#[test]
fn densities_integrate_to_one() {
    const N: u32 = 1200;
    let mut random = Random::new(3);
    for (name, map) in maps() {
        let lights = lights(map);
        let n = random.direction().as_vec3();
        for (what, cx) in [("opaque", facing(n)), ("clear", LightSampleContext { transmits: true, ..facing(n) })] {
            let (directions, solid_angle) = directions(N);
            let sum: f64 = directions.map(|w| f64::from(lights.background_pdf(0, &cx, w).get())).sum();
            // The density is linear between pixels and the poles have few points: the sum is right to a few thousandths.
            assert!((sum * solid_angle - 1.0).abs() < 4e-3, "{name}, {what}: {}", sum * solid_angle);
        }
        let (directions, solid_angle) = directions(N);
        let sum: f64 =
            directions.filter_map(|w| lights.emission_density(0, None, -w, 0.0).direction.smooth()).map(|p| f64::from(p.get())).sum();
        assert!((sum * solid_angle - 1.0).abs() < 4e-3, "{name}, emitted: {}", sum * solid_angle);
    }
}

/// Weighted samples have the mean that the integral of the radiance has, for functions that single out every side of the sphere.
#[test]
fn a_picture_is_sampled_in_proportion_to_its_interpolation() {
    const N: u32 = 600;
    const SAMPLES: u32 = 1 << 16;
    type Function = (&'static str, fn(Vec3) -> f64);
    let functions: [Function; 4] = [
        ("whole", |_| 1.0),
        ("x", |w| f64::from(w.x > 0.1)),
        ("y", |w| f64::from(w.y).powi(2)),
        ("z", |w| f64::from(1.0 + w.z + 0.5 * w.x)),
    ];
    for (name, map) in maps() {
        let lights = lights(map);
        for (what, of) in functions {
            let (directions, solid_angle) = directions(N);
            let exact: f64 = directions.map(|w| f64::from(radiance(&lights, w).average()) * of(w)).sum::<f64>() * solid_angle;
            let (mut sum, mut squares) = (0.0, 0.0);
            for u in points(SAMPLES) {
                let sample = lights.sample(&LightSampleContext::at(Vec3::ZERO), 0.5, u);
                let value = sample.map_or(0.0, |s| f64::from(s.weight().average()) * of(s.wi));
                sum += value / f64::from(SAMPLES);
                squares += value * value / f64::from(SAMPLES);
            }
            let error = ((squares - sum * sum).max(0.0) / f64::from(SAMPLES)).sqrt();
            // Four standard errors of random points, and what the sum over directions is off beside single bright pixels.
            assert!((sum - exact).abs() <= 4.0 * error + 3e-3 * exact, "{name}, {what}: {sum} ± {error} and not {exact}");
        }
    }
}

/// The sample's density is that of its direction to the last bit, and no sample is lost: radiance above 0 has a density above 0.
#[test]
fn every_lit_direction_can_be_sampled() {
    let mut random = Random::new(5);
    for (name, map) in maps() {
        let lights = lights(map);
        for _ in 0..3000 {
            let cx = match random.below(3) {
                0 => LightSampleContext::at(Vec3::ZERO),
                1 => facing(random.direction().as_vec3()),
                _ => LightSampleContext { transmits: true, ..facing(random.direction().as_vec3()) },
            };
            if let Some(sample) = lights.sample(&cx, 0.5, random.square()) {
                assert_eq!(sample.density.smooth(), Some(lights.background_pdf(0, &cx, sample.wi)), "{name}");
                assert_eq!(sample.li, radiance(&lights, sample.wi), "{name}");
                assert!(sample.weight().is_valid() && (sample.wi.length() - 1.0).abs() < 1e-6, "{name}: {sample:?}");
            }
            let w = random.direction().as_vec3();
            let can_be_lit = !cx.is_one_sided() || cx.ns.dot(w) > 0.0;
            if can_be_lit && !radiance(&lights, w).is_black() {
                assert!(lights.background_pdf(0, &cx, w).get() > 0.0, "{name}: {w}");
            }
        }
    }
}

/// A map of one colour is a constant environment: the same samples, densities and radiances to the last bit.
#[test]
fn maps_of_one_colour_are_constant_environments() {
    let mut random = Random::new(7);
    let color = [0.3, 0.7, 1.9];
    let constant = alone(Light::Environment(Environment { radiance: Rgb::new(0.3, 0.7, 1.9) }));
    for (mapping, size) in [(Mapping::LatLong, [33, 17]), (Mapping::LatLong, [1, 1]), (Mapping::Octahedral, [16, 16])] {
        let map = lights(map(size, mapping, |_, _| color));
        for _ in 0..2000 {
            let cx = if random.below(2) == 0 { facing(random.direction().as_vec3()) } else { LightSampleContext::at(Vec3::ZERO) };
            let (choice, u, w) = (random.unit() as f32, random.square(), random.direction().as_vec3());
            assert_eq!(map.sample(&cx, choice, u), constant.sample(&cx, choice, u), "{mapping:?}");
            assert_eq!(map.background_pdf(0, &cx, w), constant.background_pdf(0, &cx, w), "{mapping:?}");
            assert_eq!(radiance(&map, w), radiance(&constant, w), "{mapping:?}");
            let start = random.square();
            assert_eq!(map.emit(choice, start, u, 0.0), constant.emit(choice, start, u, 0.0), "{mapping:?}");
        }
    }
}

/// A map times a power of two gives the same directions and densities, and radiances times that power, to the last bit.
#[test]
fn scaled_maps_keep_their_bits() {
    for factor in [2f32.powi(40), 2f32.powi(-40)] {
        let of = noisy(10);
        let plain = lights(map([32, 16], Mapping::LatLong, &of));
        let scaled = lights(map([32, 16], Mapping::LatLong, |x, y| of(x, y).map(|c| c * factor)));
        let mut random = Random::new(8);
        for _ in 0..5000 {
            let (cx, u) = (facing(random.direction().as_vec3()), random.square());
            let [a, b] = [&plain, &scaled].map(|lights| lights.sample(&cx, 0.5, u));
            assert_eq!(a.map(|s| LightSample { li: s.li * factor, ..s }), b);
        }
    }
}

/// A map that is turned by quarter turns gives the samples of a surface that is turned back, with exchanged axes, to the last bit.
#[test]
fn turned_maps_keep_their_bits() {
    // Rotation of −90° about y: (x, y, z) becomes (−z, y, x).
    let turn = Mat3::from_cols(Vec3::new(0.0, 0.0, 1.0), Vec3::Y, Vec3::new(-1.0, 0.0, 0.0));
    let exchanged = |w: Vec3| Vec3::new(-w.z, w.y, w.x);
    for mapping in [Mapping::LatLong, Mapping::Octahedral] {
        let [plain, turned] = [Mat3::IDENTITY, turn].map(|to_world| lights(turned([16, 16], mapping, to_world, noisy(11))));
        let (mut random, mut turned_count) = (Random::new(9), 0);
        for _ in 0..5000 {
            let w = random.direction().as_vec3();
            assert_eq!(radiance(&plain, w), radiance(&turned, exchanged(w)), "{mapping:?}");
            let u = random.square();
            // In empty space the flat part is sampled in the world, so that only samples of peaks turn with the map.
            let [a, b] = [&plain, &turned].map(|lights| lights.sample(&LightSampleContext::at(Vec3::ZERO), 0.5, u));
            if let (Some(a), Some(b)) = (a, b) {
                let has_turned = exchanged(a.wi) == b.wi && a.li == b.li && smooth(&a).to_bits() == smooth(&b).to_bits();
                turned_count += u32::from(has_turned);
                assert!(has_turned || a.wi == b.wi, "{mapping:?}: {a:?} and {b:?}");
            }
        }
        // Peaks have more than half of the light.
        assert!(turned_count > 2000, "{mapping:?}: {turned_count}");
    }
}

/// Black maps have no light and are never chosen.
#[test]
fn dark_maps_are_never_chosen() {
    let mut random = Random::new(10);
    let dark = map([8, 4], Mapping::LatLong, |_, _| [0.0; 3]);
    assert_eq!(dark.mean(), 0.0);
    let lights = Lights::new(
        vec![Light::EnvironmentMap(Arc::new(dark)), Light::Environment(Environment { radiance: Rgb::WHITE })],
        vec![].into(),
        (Vec3::ZERO, 1.0),
    );
    assert_eq!(lights.background(Vec3::Y).count(), 1);
    for _ in 0..100 {
        let cx = facing(random.direction().as_vec3());
        assert_eq!(lights.probability(0, &cx), 0.0);
        assert_eq!(lights.sample(&cx, random.unit() as f32, random.square()).map(|s| s.light), Some(1));
    }
}

/// The share of a map in the choice among lights follows its irradiance on the surface, within a tenth for a smooth map.
#[test]
fn irradiance_by_harmonics_is_near_the_integral() {
    let sky = |_: u32, y: u32| if y < 16 { [0.2, 0.5, 1.0] } else { [0.1, 0.08, 0.05] };
    let lit = |map: EnvironmentMap| {
        Lights::new(
            vec![Light::EnvironmentMap(Arc::new(map)), Light::Environment(Environment { radiance: Rgb::gray(0.3) })],
            vec![].into(),
            (Vec3::ZERO, 1.0),
        )
    };
    let lights = lit(map([64, 32], Mapping::LatLong, sky));
    let own = lights_of_map(&lights);
    let mut random = Random::new(11);
    for _ in 0..50 {
        let n = random.direction().as_vec3();
        let (directions, solid_angle) = directions(200);
        let exact: f64 = directions.map(|w| f64::from(own(w)) * f64::from(n.dot(w).max(0.0))).sum::<f64>() * solid_angle;
        let share = exact / (exact + 0.3 * PI);
        let probability = f64::from(lights.probability(0, &facing(n)));
        // A quarter of the choices is divided equally.
        let expected = 0.75 * share + 0.125;
        assert!((probability / expected - 1.0).abs() < 0.1, "{n}: {probability} and not {expected}");
    }
}

/// The radiance of the first light alone.
fn lights_of_map(lights: &Lights) -> impl Fn(Vec3) -> f32 + '_ {
    |w| lights.background(w).find(|(light, _)| *light == 0).map_or(0.0, |(_, radiance)| radiance.average())
}

/// The sun's disk of .2665°: solid angle 6.7967024·10⁻⁵ and irradiance 6.7966656·10⁻⁵ of its radiance; and wide disks, up to half of the
/// sky, whose irradiance is π L sin² α.
#[test]
fn a_sun_lights_as_its_solid_angle_says() {
    let mut random = Random::new(12);
    for (half_angle, solid_angle, irradiance) in [
        (0.2665, 6.7967024e-5, 6.7966656e-5),
        (30.0, TAU * (1.0 - (PI / 6.0).cos()), PI * 0.25),
        (90.0, TAU, PI),
        (1e-4, PI * (PI * 1e-4 / 180.0).powi(2), PI * (PI * 1e-4 / 180.0).powi(2)),
    ] {
        let up = random.direction().as_vec3();
        let lights = alone(Light::Sun(Sun::new(-up, Rgb::gray(2.0), half_angle)));
        let cx = facing(up);
        let (mut sum, mut area, mut inside) = (0.0, 0.0, 0);
        const SAMPLES: u32 = 1 << 14;
        for u in points(SAMPLES) {
            let sample = lights.sample(&cx, 0.5, u).expect("a sample");
            sum += f64::from(sample.weight().average()) * f64::from(sample.wi.dot(up)) / f64::from(SAMPLES);
            area += 1.0 / smooth(&sample) / f64::from(SAMPLES);
            inside += u32::from(!radiance(&lights, sample.wi).is_black());
        }
        assert!((area / solid_angle - 1.0).abs() < 1e-5, "{half_angle}°: solid angle {area}");
        // The points of the set leave an error of a few 10⁻⁵ in the mean cosine of wide disks.
        assert!((sum / (2.0 * irradiance) - 1.0).abs() < 1e-4, "{half_angle}°: irradiance {sum}");
        // Only samples at the very edge may be taken to be beyond it, as directions are rounded.
        assert!(f64::from(inside) > 0.9 * f64::from(SAMPLES), "{half_angle}°: {inside} of {SAMPLES} see the disk");
        assert!(radiance(&lights, -up).is_black() && lights.background_pdf(0, &cx, -up).get() == 0.0);
    }
}

const SCENE: &str = r#"{ "pt": 1, "camera": { "type": "spherical" }, "film": { "width": 24, "height": 12, "filter": { "type": "box" } },
    "shapes": [], "background": BACKGROUND }"#;

/// Reads and builds [`SCENE`] with a background and a file in memory.
fn built(background: &str, file: (&str, Vec<u8>)) -> Result<Built, String> {
    let text = SCENE.replace("BACKGROUND", background);
    let root = describe::root(text.as_bytes(), "scene.json").map_err(|e| e.to_string())?;
    let scene = describe::read(&root, "scene.json").map_err(|e| e.to_string())?;
    let files = Files { made: BTreeMap::from([(file.0.to_owned(), file.1)]), ..Files::default() };
    pt::build::build(&scene, Source { root: &root, file: "scene.json", files: &files }).map_err(|e| e.to_string())
}

/// A picture with random colours in some format.
fn picture(format: image::ImageFormat) -> (image::Rgb32FImage, Vec<u8>) {
    let mut random = Random::new(13);
    let picture = image::Rgb32FImage::from_fn(8, 4, |_, _| image::Rgb([0; 3].map(|_| random.unit() as f32)));
    let mut bytes = Cursor::new(vec![]);
    picture.write_to(&mut bytes, format).expect("written");
    (picture, bytes.into_inner())
}

/// The sun stands where its azimuth and elevation say, also in a sky that is turned; without the disk there is the sky alone.
#[test]
fn the_sun_stands_where_the_scene_says() {
    let sky = |keys: &str, transform: &str| format!(r#"{{ "sky": {{ {keys} }}, "transform": [{transform}] }}"#);
    let turn = r#"{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }"#;
    let (sin, cos) = f32::to_radians(30.0).sin_cos();
    // The example of the Solar Position Algorithm, with -z to the north and +x to the east.
    let golden = r#""place": { "latitude": 39.742476, "longitude": -105.1786, "time": "2003-10-17T12:30:30-07:00" }"#;
    let ((sin_up, cos_up), (sin_east, cos_east)) = (f32::to_radians(39.872).sin_cos(), f32::to_radians(194.34).sin_cos());
    for (keys, transform, towards) in [
        (r#""elevation": 30, "azimuth": 0"#, "", Vec3::new(0.0, sin, -cos)),
        (r#""elevation": 30, "azimuth": 90"#, "", Vec3::new(cos, sin, 0.0)),
        (r#""elevation": 30, "azimuth": 180"#, turn, Vec3::new(0.0, -cos, sin)),
        (r#""elevation": 90"#, turn, Vec3::Z),
        (golden, "", Vec3::new(cos_up * sin_east, sin_up, -cos_up * cos_east)),
    ] {
        let lit = built(&sky(keys, transform), ("", vec![])).expect("a scene");
        let lights = lit.world.lights();
        // The disk is 6 · 10⁴ times as bright as the sky around it.
        let [at, beside] = [towards, towards + Vec3::new(0.02, 0.0, 0.0)].map(|w| radiance(lights, w.normalize()).average());
        assert!(at > 1e3 * beside && beside > 0.0, "{keys} {transform}: {at} and {beside}");
        // Around the zenith of the sky the sun lights a surface by its elevation; the bright part of the sky is around the sun.
        let alone = built(&sky(&format!(r#"{keys}, "sun": false"#), transform), ("", vec![])).expect("a scene");
        let around = radiance(alone.world.lights(), towards).average();
        assert!(around < at / 1e3 && around > radiance(alone.world.lights(), -towards).average(), "{keys} {transform}: {around}");
        assert_eq!((lights.len(), alone.world.lights().len()), (2, 1));
    }
}

/// The sky has the same bits on one thread and on three.
#[test]
fn the_sky_has_the_same_bits_on_any_number_of_threads() {
    let sky = Sky { elevation: 12.0, turbidity: 3.0, ground: [0.3; 3], altitude: 100.0 };
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| sky.light())
    });
    assert_eq!(one.pixels, three.pixels);
    assert_eq!(one.sun, three.sun);
}

/// Radiance HDR and OpenEXR show the values that are in them, times the scale, in the middles of their pixels.
#[test]
fn files_of_maps_are_read() {
    for (name, format, precision) in [("a.exr", image::ImageFormat::OpenExr, 1e-6), ("a.hdr", image::ImageFormat::Hdr, 1.0 / 128.0)] {
        let (picture, bytes) = picture(format);
        let background = format!(r#"{{ "image": "{name}", "scale": [2, 1, 0.5] }}"#);
        let built = built(&background, (name, bytes)).unwrap_or_else(|e| panic!("{name}: {e}"));
        for (x, y, pixel) in picture.enumerate_pixels() {
            let uv = Vec2::new((x as f32 + 0.5) / 8.0, (y as f32 + 0.5) / 4.0);
            let [r, g, b] = radiance(built.world.lights(), Mapping::LatLong.direction(uv)).to_rgb();
            // Radiance HDR has one exponent for all three components.
            let most = pixel.0.into_iter().fold(0.0, f32::max);
            for (found, wanted) in [(r / 2.0, pixel[0]), (g, pixel[1]), (b * 2.0, pixel[2])] {
                assert!((found - wanted).abs() <= precision * most + 1e-5, "{name} ({x}, {y}): {found} and not {wanted}");
            }
        }
    }
}

/// A panorama of the spherical camera, used as background, shows the same panorama.
#[test]
fn panoramas_show_themselves() {
    let (picture, bytes) = picture(image::ImageFormat::OpenExr);
    let built = built(r#"{ "image": "a.exr" }"#, ("a.exr", bytes)).expect("a scene");
    for (x, y, pixel) in picture.enumerate_pixels() {
        let film = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(8.0, 4.0);
        let ray = built.world.camera().ray(film, 2.0, Vec2::splat(0.5), 0.0);
        let found = radiance(built.world.lights(), ray.direction).to_rgb();
        assert!(found.iter().zip(pixel.0).all(|(a, b)| (a - b).abs() < 1e-4), "({x}, {y}): {found:?} and not {:?}", pixel.0);
    }
}

/// Each wrong background is refused with the place and what was expected.
#[test]
fn wrong_backgrounds_are_refused() {
    let exr = || picture(image::ImageFormat::OpenExr).1;
    let square = || {
        let mut bytes = Cursor::new(vec![]);
        image::Rgb32FImage::from_pixel(2, 2, image::Rgb([1.0; 3])).write_to(&mut bytes, image::ImageFormat::OpenExr).expect("written");
        bytes.into_inner()
    };
    let bright = || {
        let mut bytes = Cursor::new(vec![]);
        image::Rgb32FImage::from_pixel(4, 2, image::Rgb([100.0; 3])).write_to(&mut bytes, image::ImageFormat::OpenExr).expect("written");
        bytes.into_inner()
    };
    // Deep data is a bit of the version.
    let deep = || {
        let mut bytes = exr();
        bytes[5] |= 0x08;
        bytes
    };
    for (background, bytes, wanted) in [
        ("{}", exr(), r#"expected "radiance", "image" (a picture of the surroundings) or "sky""#),
        (r#"{ "radiance": 1, "image": "a.exr" }"#, exr(), "give one of radiance, image and sky"),
        (r#"{ "image": "a.exr", "scale": 1e30, "transform": [] }"#, bright(), "expected at most 1e30"),
        (r#"{ "sky": { "irradiance": 1e26 } }"#, exr(), "expected at most 1e25 W/m²"),
        (r#"{ "sky": {}, "radiance": 1 }"#, exr(), "give one of radiance, image and sky"),
        (r#"{ "sky": { "elevation": 91 } }"#, exr(), "expected an angle in degrees from -18 to 90, found 91"),
        (
            r#"{ "sky": { "azimuth": 3, "place": { "latitude": 48, "longitude": 11, "time": "2026-06-21T12:00Z" } } }"#,
            exr(),
            r#"/background/sky/place: give "place", or "elevation" and "azimuth""#,
        ),
        (
            r#"{ "sky": { "place": { "latitude": 48, "longitude": 11, "time": "2026-12-21T23:00Z" } } }"#,
            exr(),
            "° below the horizon there: pt has no sky of the night",
        ),
        (
            r#"{ "sky": { "place": { "latitude": 48, "longitude": 11, "time": "21 June 2026" } } }"#,
            exr(),
            "expected a time with its distance from UTC, as 2026-06-21T18:30+02:00, found",
        ),
        (r#"{ "sky": { "place": { "latitude": 91, "longitude": 11, "time": "2026-06-21T12:00Z" } } }"#, exr(), "from -90 to 90, found 91"),
        (r#"{ "radiance": 1, "scale": 2 }"#, exr(), r#"only a background with an "image" has this"#),
        (r#"{ "image": "b.exr" }"#, exr(), "b.exr: no such file"),
        (r#"{ "image": "a.exr", "mapping": "octahedral" }"#, exr(), "expected a square picture for an octahedral map, found 8 × 4"),
        (r#"{ "image": "a.exr", "mapping": "cube" }"#, exr(), "unknown"),
        (r#"{ "image": "a.exr", "transform": [{ "translate": [1, 0, 0] }] }"#, exr(), "expected rotations only"),
        (r#"{ "image": "a.exr", "transform": [{ "scale": 2 }] }"#, exr(), "expected rotations only"),
        (r#"{ "image": "a.exr" }"#, exr()[..exr().len() / 2].to_vec(), "not a usable OpenEXR picture"),
        (r#"{ "image": "a.exr" }"#, deep(), "flatten it"),
    ] {
        let Err(said) = built(background, ("a.exr", bytes)) else { panic!("{background} is accepted, not {wanted:?}") };
        assert!(said.contains(wanted), "{background}: {said}");
    }
    let warned = built(r#"{ "image": "a.exr" }"#, ("a.exr", square())).expect("a scene").warnings;
    assert!(warned.iter().any(|w| w.contains("octahedral")), "{warned:?}");
    assert!(built(r#"{ "image": "a.exr", "mapping": "octahedral", "transform": [{ "scale": [1, -1, 1] }] }"#, ("a.exr", square())).is_ok());
}
