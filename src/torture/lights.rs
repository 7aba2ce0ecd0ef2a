//! Lights that are tiny, huge, far or seen edge-on, and environment maps of few pixels.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, Mat3, UVec2, Vec2, Vec3, Vec4};

use super::{Failures, Random, Row, terminator};
use crate::light::{EnvironmentMap, Light, LightSampleContext, Lights, Mapping, Sun};
use crate::math::float::unit_f32;
use crate::math::{Rgb, SphericalRectangle, SphericalTriangle, Transform};
use crate::shape::curves::Basis;
use crate::shape::{BilinearPatch, Cone, Curves, Cylinder, Disk, Geometry, PartialDisk, PartialSphere, Quad, Shape, Sphere};
use crate::texture::image::Pixels;

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![sampled(), spherical(), inside(), maps(), dark_maps(), terminator::row()]
}

/// A bent curve of one piece, which tapers: a tube, or a ribbon that twists.
fn bend(is_ribbon: bool) -> Curves {
    let points = [[-1.0, -0.2, 0.1, 0.4], [-0.3, 0.5, -0.2, 0.3], [0.4, -0.3, 0.2, 0.3], [1.0, 0.2, -0.1, 0.2]];
    let normals = [[0.1, 1.0, 0.2], [0.0, 0.8, 0.6], [-0.2, 0.9, 0.5], [0.3, 1.0, -0.2]];
    let normals = if is_ribbon { normals.map(Vec3::from).to_vec() } else { vec![] };
    Curves { basis: Basis::Bezier, points: points.map(Vec4::from).to_vec(), counts: vec![4], normals }
}

/// Shapes of sizes from 10⁻⁶ to 10⁶ seen from distances of 10⁻³ to 10⁶ times their size, also edge-on.
fn sampled() -> Row {
    let row = Row::new("L5", "samples of lamps: numbers, on the lamp, with the density that is evaluated", "1e-3 of the density, far out");
    let row = row.peers("cones below 1.5° collapse in pbrt-v3 (#212)");
    type Make = fn(&Transform) -> crate::error::Result<Box<dyn Shape>>;
    const SADDLE: [DVec3; 4] =
        [DVec3::new(-0.8, -0.7, 0.2), DVec3::new(0.8, -0.8, -0.3), DVec3::new(-0.7, 0.8, -0.3), DVec3::new(0.8, 0.7, 0.4)];
    let shapes: [(&str, Make); 10] = [
        ("sphere", |place| Sphere { radius: 1.0 }.bake(place)),
        ("square", |place| Quad { size: [2.0, 1.0] }.bake(place)),
        ("disk", |place| Disk { radius: 1.0 }.bake(place)),
        ("cylinder", |place| Cylinder { radius: 1.0, z: [-0.5, 0.8], phi_max: 360.0 }.bake(place)),
        ("cone", |place| Cone { radius: 1.0, height: 1.2, phi_max: 300.0 }.bake(place)),
        ("bowl", |place| PartialSphere { radius: 1.0, z: [-1.0, 0.3], phi_max: 360.0 }.bake(place)),
        ("ring", |place| PartialDisk { radius: 1.0, inner_radius: 0.5, phi_max: 200.0 }.bake(place)),
        ("saddle", |place| BilinearPatch { corners: SADDLE }.bake(place)),
        ("bent tube", |place| bend(false).bake(place)),
        ("ribbon", |place| bend(true).bake(place)),
    ];
    shapes.into_iter().fold(row, |row, (name, make)| {
        row.never(format!("{name}, any size and distance"), 10_000_000, move |tries| {
            Failures::count_judged(tries, |random| {
                let (size, distance) = (random.decade(-6.0, 6.0), random.decade(-3.0, 6.0));
                let place = Transform::scale(DVec3::splat(size)).expect("not zero").then(&random.rotation());
                let shape = make(&place).expect("an area");
                let away = if random.below(8) == 0 { place.vector(random.direction().with_z(0.0)).normalize() } else { random.direction() };
                let from = (away * size * distance).as_vec3();
                let (point, pdf) = shape.sample_from(0, from, random.square())?;
                // From a place on the lamp itself the sample may be that place; such samples are dropped.
                let wi = (point.p - from).try_normalize()?;
                let again = shape.pdf_from(0, from, &point).get();
                let near = point.p.as_dvec3().length() <= 1.5 * size;
                let numbers = point.p.is_finite() && point.ng.is_finite() && pdf.get() > 0.0 && pdf.get().is_finite();
                // Near the horizon of a lamp the rounding of the point moves the cosine by its own size.
                let tells = wi.dot(point.ng).abs() > 1e-3 && distance > 1.1;
                let same = !tells || (again / pdf.get() - 1.0).abs() < 1e-3;
                Some((!(numbers && near && same)).then(|| format!("size {size:e} from {from:?}: {point:?}, {pdf:?} and {again:?}")))
            })
        })
    })
}

/// From on and within a sphere.
fn inside() -> Row {
    Row::new("L7", "samples of a spherical lamp from its surface and from within", "finite").never("unit sphere", 2_000_000, |tries| {
        let sphere = Sphere { radius: 1.0 }.bake(&Transform::IDENTITY).expect("a sphere");
        Failures::count_judged(tries, |random| {
            let from = (random.direction() * random.pick(&[0.0, 0.5, 1.0 - 1e-7, 1.0, 1.0 + 1e-7, 1.0001])).as_vec3();
            let (point, pdf) = sphere.sample_from(0, from, random.square())?;
            let holds = point.p.is_finite() && point.ng.is_finite() && pdf.get() > 0.0 && pdf.get().is_finite();
            Some((!holds).then(|| format!("from {from:?}: {point:?}, {pdf:?}")))
        })
    })
}

/// How far a direction lies outside of a triangle or parallelogram, as an angle; negative inside.
fn outside(corners: &[DVec3], w: Vec3) -> f64 {
    let middle = corners.iter().sum::<DVec3>();
    let beyond = |i: usize| {
        let normal = corners[i].cross(corners[(i + 1) % corners.len()] - corners[i]).normalize();
        -w.as_dvec3().dot(normal) * middle.dot(normal).signum()
    };
    (0..corners.len()).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}

fn spherical() -> Row {
    let row = Row::new("L6", "directions to triangles and rectangles: unit, and inside", "1.2e-7: rounding of three coordinates");
    let row = row.peers("pbrt: NaN after 67,000 s (#211)");
    let place = |random: &mut Random| {
        let scale = random.decade(-4.0, 4.0);
        let place = random.direction() * scale * random.decade(-1.0, 1.0);
        (place, scale)
    };
    let judge = |corners: &[DVec3], w: Vec3| {
        let holds = w.is_finite() && (w.length() - 1.0).abs() < 2e-7 && outside(corners, w) < 1.2e-7;
        (!holds).then(|| format!("{corners:?}: {w:?}"))
    };
    row.never("triangles", 10_000_000, move |tries| {
        Failures::count_judged(tries, |random| {
            let (place, scale) = place(random);
            let corners = [(); 3].map(|()| (place + random.in_cube() * scale).as_vec3());
            let seen = SphericalTriangle::new(corners)?;
            Some(judge(&corners.map(Vec3::as_dvec3), seen.sample(random.square())))
        })
    })
    .never("rectangles", 10_000_000, move |tries| {
        Failures::count_judged(tries, |random| {
            let (corner, scale) = place(random);
            let turn = random.rotation();
            let [x, y] = [DVec3::X, DVec3::Y].map(|axis| turn.vector(axis) * scale * random.decade(-2.0, 0.3));
            let (corner, [x, y]) = (corner.as_vec3(), [x, y].map(DVec3::as_vec3));
            let seen = SphericalRectangle::new(corner, [x, y])?;
            // Edges are rounded, and the second is taken as perpendicular to the first.
            let [corner, x, y] = [corner, x, y].map(Vec3::as_dvec3);
            let y = y - x * (x.dot(y) / x.length_squared());
            let corners = [corner, corner + x, corner + x + y, corner + y];
            Some(judge(&corners, seen.sample(random.square())))
        })
    })
}

fn map(size: [u32; 2], color: impl Fn(u32) -> f32) -> EnvironmentMap {
    let values = (0..size[0] * size[1]).map(|k| [color(k); 3]).collect();
    let pixels = Arc::new(Pixels::new(UVec2::from(size), values).expect("pixels"));
    EnvironmentMap::new(pixels, Mapping::LatLong, Rgb::WHITE, Mat3::IDENTITY)
}

fn alone(map: EnvironmentMap) -> Lights {
    Lights::new(vec![Light::EnvironmentMap(Arc::new(map))], Arc::from(Vec::new()), (Vec3::ZERO, 1.0))
}

/// Densities over the sphere add up to 1, and samples have the density that is evaluated.
fn maps() -> Row {
    let row = Row::new("L9", "integral of an environment map's density over the sphere", "midpoint rule with 512 × 1024 directions");
    let row = row.peers("pbrt-v3 is off by half a texel (#62); three-gpu-pathtracer fails with 1 × 1 (#541)");
    type Brightness = fn(u32) -> f32;
    let maps: [(&str, [u32; 2], Brightness); 5] = [
        ("1 × 1", [1, 1], |_| 2.0),
        ("1 × 5", [1, 5], |k| k as f32),
        ("7 × 1", [7, 1], |k| k as f32 * k as f32),
        ("16 × 8, one bright pixel", [16, 8], |k| if k == 37 { 1e6 } else { 0.01 }),
        ("8 × 4, noise", [8, 4], |k| (k.wrapping_mul(2_654_435_761) >> 24) as f32),
    ];
    maps.into_iter().fold(row, |row, (name, size, color)| {
        row.number(name, 1.0, 4e-3, move || {
            let (lights, anywhere) = (alone(map(size, color)), LightSampleContext::at(Vec3::ZERO));
            const ROWS: u32 = 512;
            let step = PI / f64::from(ROWS);
            let density = |row: u32, column: u32| {
                let (theta, phi) = ((f64::from(row) + 0.5) * step, (f64::from(column) + 0.5) * step);
                let w = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()).as_vec3();
                f64::from(lights.background_pdf(0, &anywhere, w).get()) * theta.sin()
            };
            let sum: f64 = (0..ROWS).map(|row| (0..2 * ROWS).map(|column| density(row, column)).sum::<f64>()).sum();
            sum * step * TAU / f64::from(2 * ROWS)
        })
    })
}

fn dark_maps() -> Row {
    Row::new("L10", "samples of a black environment map", "none").never("8 × 4", 1_000_000, |tries| {
        let lights = alone(map([8, 4], |_| 0.0));
        Failures::count(tries, |random| {
            let sample = lights.sample(&LightSampleContext::at(Vec3::ZERO), 0.5, random.square());
            sample.map(|sample| format!("{sample:?}"))
        })
    })
}

/// Numbers in [0, 1)² that fill it evenly: the first coordinate is regular, the second has its binary digits reversed.
fn points(count: u32) -> impl Iterator<Item = Vec2> {
    (0..count).map(move |i| Vec2::new((i as f32 + 0.5) / count as f32, unit_f32(i.reverse_bits())))
}

/// A surface at the origin whose normal is +y.
fn upwards() -> LightSampleContext {
    LightSampleContext { ng: Vec3::Y, ns: Vec3::Y, ..LightSampleContext::at(Vec3::ZERO) }
}

/// Mean of weight × cosine over samples of the only lamp.
fn irradiance(lights: &Lights) -> f64 {
    const SAMPLES: u32 = 1 << 14;
    let samples = points(SAMPLES).filter_map(|u| lights.sample(&upwards(), 0.5, u));
    let (sum, count) =
        samples.fold((0.0, 0.0), |(sum, count), sample| (sum + f64::from(sample.weight().average()) * f64::from(sample.wi.y), count + 1.0));
    // The few samples of the flat part of a map bring nothing, and take some of the others' places.
    if count > f64::from(SAMPLES - 10) { sum / count } else { f64::NAN }
}

/// W16. E = π L sin² α for the half angle α.
pub(super) fn sun() -> Row {
    let row = Row::new("W16", "irradiance of a sun of radiance 1 overhead", "1e-4: the points of the mean");
    let disks = [(0.2665, 6.7966656e-5), (30.0, 0.25 * PI), (90.0, PI), (1e-4, PI * (PI * 1e-4 / 180.0f64).powi(2))];
    disks.into_iter().fold(row, |row, (half_angle, exact)| {
        row.number(format!("half angle {half_angle}°"), exact, 1e-4 * exact, move || {
            irradiance(&Lights::new(
                vec![Light::Sun(Sun::new(Vec3::NEG_Y, Rgb::WHITE, half_angle))],
                Arc::from(Vec::new()),
                (Vec3::ZERO, 1.0),
            ))
        })
    })
}

/// W17. E = 10⁶ · 2π/1024 · π/512 · sin θ cos θ. A map that was half a pixel too high would be off by 1.5 % near the top.
pub(super) fn bright_pixel() -> Row {
    let row = Row::new("W17", "irradiance of one pixel of 10^6 in an environment map, 1024 × 512", "1e-4: cosines within the pixel");
    let row = row.peers("half a texel higher, as in pbrt-v3: -1.5 % in row 32 (#62)");
    [(128, 18.824303968), (64, 13.392468015), (32, 7.310462821)].into_iter().fold(row, |row, (at, exact)| {
        row.number(format!("row {at}"), exact, 1e-4 * exact, move || {
            irradiance(&alone(map([1024, 512], |k| if k == at * 1024 + 700 { 1e6 } else { 0.0 })))
        })
    })
}
