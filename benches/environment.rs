//! Time and memory to prepare an environment map of 8192 × 4096 pixels, and the time of a lookup and of a sample, beside those of a
//! constant environment.
//!
//! `cargo bench --bench environment`

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use glam::{Mat3, UVec2, Vec2, Vec3};
use pt::light::{Environment, EnvironmentMap, Light, LightSampleContext, Lights, Mapping};
use pt::math::float::unit_f32;
use pt::math::{Rgb, warp};
use pt::texture::image::Pixels;

const SIZE: UVec2 = UVec2::new(8192, 4096);

/// Number of lookups and of samples.
const COUNT: u32 = 1 << 22;

fn main() {
    let before = megabytes();
    let pixels = pixels();
    let picture = megabytes() - before;
    let start = Instant::now();
    let map = EnvironmentMap::new(Arc::new(pixels), Mapping::LatLong, Rgb::WHITE, Mat3::IDENTITY);
    let seconds = start.elapsed().as_secs_f64();
    let whole = megabytes() - before;
    println!("{SIZE}: ready in {seconds:.2} s, {picture:.0} MB of picture, {whole:.0} MB in all, {:.2} times the picture", whole / picture);
    let lights = |light| Lights::new(vec![light], vec![].into(), (Vec3::ZERO, 1.0));
    let constant = Light::Environment(Environment { radiance: Rgb::WHITE });
    for (name, lights) in [("map", lights(Light::EnvironmentMap(Arc::new(map)))), ("constant", lights(constant))] {
        let lookup = nanoseconds(|u| lights.background(warp::uniform_sphere(u)).map(|(_, light)| light.average()).sum());
        let cx = LightSampleContext { ng: Vec3::Y, ns: Vec3::Y, ..LightSampleContext::at(Vec3::ZERO) };
        let sample = nanoseconds(|u| lights.sample(&cx, 0.5, u).map_or(0.0, |sample| sample.li.average()));
        println!("{name}: {lookup:.0} ns a lookup in a random direction, {sample:.0} ns a sample with its density");
    }
}

/// A picture of noise with a sun.
fn pixels() -> Pixels {
    let value = |i: u32| {
        let sun = if i % SIZE.x < 12 && i / SIZE.x / 12 == 100 { 1e4 } else { 0.0 };
        [0, 1, 2].map(|k| unit_f32(hash(3 * i + k)) + sun)
    };
    Pixels::new(SIZE, (0..SIZE.element_product()).map(value).collect()).expect("as many values as pixels")
}

/// Time of one call, over random points of the square.
fn nanoseconds(of: impl Fn(Vec2) -> f32) -> f64 {
    let start = Instant::now();
    let sum: f32 = (0..COUNT).map(|i| of(Vec2::new(unit_f32(hash(2 * i)), unit_f32(hash(2 * i + 1))))).sum();
    black_box(sum);
    1e9 * start.elapsed().as_secs_f64() / f64::from(COUNT)
}

/// Bits of a number, mixed. Source: Wellons, "Prospecting for Hash Functions" (2018).
fn hash(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Memory that the process has now, where Linux tells it.
fn megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<f64>().ok()).map_or(f64::NAN, |kilobytes| kilobytes / 1000.0)
}
