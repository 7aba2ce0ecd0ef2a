//! `pt sample material SCENE#NAME`: tests a material of a scene at one incidence, and draws pictures of it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::{UVec2, Vec3};

use super::SampleArgs;
use super::directions::{figures, tests};
use crate::bsdf::Bsdf;
use crate::build::Source;
use crate::cli::print_stdout;
use crate::describe;
use crate::error::{Error, Result};
use crate::film::{Channel, Image};
use crate::import::{Imported, import};
use crate::math::Ray;
use crate::output::{self, Tonemap, png};
use crate::primitive::Hit;
use crate::proof::{Case, Division, FINE, Options, at};
use crate::reader::unknown;
use crate::scene::Scene;
use crate::world::World;

/// Runs the command.
pub fn material(scene: &str, args: &SampleArgs) -> Result<ExitCode> {
    let usage = || Error::Usage(format!("{scene}: expected a scene and a material of it, such as scene.json#glass"));
    let (path, name) = scene.rsplit_once('#').ok_or_else(usage)?;
    let world = sphere_of(Path::new(path), name, args.allow_outside)?;
    let bsdf = of_sphere(&world)?;
    let [theta, phi] = args.wo.map(f64::to_radians);
    let options = Options { samples: args.samples, seed: args.seed, incidences: vec![at(theta.cos(), phi)], ..Options::default() };
    let case = Case::new(&bsdf, &options);
    let report = case.report();
    print_stdout(&format!("{}\n{report}", summary(&case, args)))?;
    pictures(&case.sampled[0].divisions[0], case.sampled[0].smooth, &stem(name, args))?;
    Ok(ExitCode::from(u8::from(!report.accepts())))
}

/// World of one sphere with the material of that name.
fn sphere_of(path: &Path, name: &str, allow_outside: bool) -> Result<World> {
    let Imported { mut root, file, files, .. } = import(path, allow_outside)?;
    let described = describe::read(&root, &file)?;
    if !described.materials.contains_key(name) {
        let known: Vec<&str> = described.materials.keys().map(String::as_str).collect();
        return Err(Error::Usage(format!("{file}#{name}: {}", unknown("material", name, &known))));
    }
    let sphere = serde_json::json!([{ "type": "sphere", "material": name }]);
    for (pointer, value) in [("/shapes", sphere.to_string()), ("/lights", "[]".into())] {
        root.set(pointer, &value)?;
    }
    let source = Source { root: &root, file: &file, files: &files };
    Ok(crate::build::build(&describe::read(&root, &file)?, source)?.world)
}

/// Material at a point of a world that is one unit sphere.
pub fn of_sphere(world: &World) -> Result<Bsdf<'_>> {
    let ray = Ray::new(Vec3::new(0.3, 0.2, 3.0) - world.origin().as_vec3(), Vec3::NEG_Z);
    // The shape is intersected, not the world: at a hole of a surface the material there is wanted.
    let met = world.shapes()[0].intersect(0, &ray).ok_or_else(|| Error::Internal("a ray missed the unit sphere".into()))?;
    Ok(world.surface(&ray, &Hit { instance: None, shape: 0, primitive: 0, uv: met.uv, t: met.t }).bsdf)
}

/// Text with the most important figures of a proof and its samples.
fn summary(case: &Case, args: &SampleArgs) -> String {
    let sampled = &case.sampled[0];
    let [theta, phi] = args.wo;
    let share = |count: u64| 100.0 * count as f64 / sampled.samples as f64;
    let [r, g, b] = sampled.albedo.map(|mean| format!("{:.5} ± {:.5}", mean.value, mean.standard_error()));
    format!(
        "wo             θ = {theta}°, φ = {phi}°\n\
         samples        {}\n\
         ∫ pdf          {:.5}\n\
         valid samples  {:.3} % ({:.3} % with a density, {:.3} % delta)\n\
         chi² p         {}\n\
         furnace albedo {r} (red), {g} (green), {b} (blue)\n",
        sampled.samples,
        sampled.mass,
        share(sampled.samples - sampled.failed),
        share(sampled.smooth),
        share(sampled.samples - sampled.failed - sampled.smooth),
        figures(&tests(sampled))
    )
}

/// Start of the pictures' names: `-o`, or the material's name as a file name.
fn stem(name: &str, args: &SampleArgs) -> PathBuf {
    let as_file = || name.replace(['/', '\\'], "_").into();
    args.output.clone().unwrap_or_else(as_file)
}

/// Pixels per bin, along each side.
const ZOOM: usize = 4;

/// Writes pictures of the density, its estimate from the samples, and their difference: samples too many (red) or too few (blue).
///
/// From left to right φ = 0 … 360°; from top to bottom z = 1 … −1, so that equal areas are equal solid angles. All have the same
/// scale: the largest value of both.
fn pictures(fine: &Division, samples: u64, stem: &Path) -> Result<()> {
    let sampled: Vec<f64> = fine.counts.iter().map(|&count| count as f64 / samples.max(1) as f64).collect();
    let mass: f64 = fine.shares.iter().sum();
    let shares: Vec<f64> = fine.shares.iter().map(|share| if mass > 0.0 { share / mass } else { 0.0 }).collect();
    let largest = shares.iter().chain(&sampled).fold(0.0, |a: f64, &b| a.max(b));
    let part = |x: f64| if largest > 0.0 { x / largest } else { 0.0 };
    let pictures: [(&str, Vec<[f64; 3]>); 3] = [
        ("pdf", shares.iter().map(|&x| heat(part(x))).collect()),
        ("sampled", sampled.iter().map(|&x| heat(part(x))).collect()),
        ("difference", sampled.iter().zip(&shares).map(|(a, b)| diverging(part(a - b))).collect()),
    ];
    for (name, colors) in pictures {
        let mut path = stem.as_os_str().to_owned();
        path.push(format!("-{name}.png"));
        output::replace(Path::new(&path), &png::encode(&enlarged(&colors), &Tonemap::default())?)?;
    }
    Ok(())
}

fn enlarged(colors: &[[f64; 3]]) -> Image {
    let [rows, columns] = FINE;
    let size = UVec2::new((columns * ZOOM) as u32, (rows * ZOOM) as u32);
    let pixel = |y: usize, x: usize| colors[(rows - 1 - y / ZOOM) * columns + x / ZOOM];
    let all = || (0..rows * ZOOM).flat_map(|y| (0..columns * ZOOM).map(move |x| (y, x)));
    let channel = |(c, name): (usize, &str)| Channel { name: name.into(), values: all().map(|(y, x)| pixel(y, x)[c] as f32).collect() };
    Image { full_size: size, origin: UVec2::ZERO, size, channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
}

/// Colour from black over red and yellow to white, in linear Rec. 709, with increasing brightness.
fn heat(x: f64) -> [f64; 3] {
    [0.0, 1.0, 2.0].map(|from| (3.0 * x - from).clamp(0.0, 1.0))
}

/// Colour that is blue below 0, white at 0 and red above.
fn diverging(x: f64) -> [f64; 3] {
    let (more, less) = (1.0 - x.clamp(0.0, 1.0), 1.0 + x.clamp(-1.0, 0.0));
    [less, more.min(less), more]
}
