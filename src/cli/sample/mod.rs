//! `pt sample`: points of every warp and sampler, scattering of a material, as numbers and as pictures; and the test
//! files of the courses of dirt and darts.

mod coursework;
mod directions;
mod globe;
mod marks;
mod material;
mod points;

use std::path::Path;
use std::process::ExitCode;

use glam::Vec3;

use super::parse::whole;
use super::print_stdout;
use crate::error::{Error, Result};
use crate::load::sampler_named;
use crate::output;
use crate::reader::unknown;
use crate::sampler::Kind;
use points::{Parameters, WARPS};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct SampleArgs {
    /// A warp or a sampler, or `material`, or a file of tests (.json) as the courses of dirt and darts have them.
    #[arg(value_name = "WARP")]
    pub what: Option<String>,
    /// With `material`: the scene file and the name of the material.
    #[arg(value_name = "SCENE#NAME")]
    pub scene: Option<String>,
    /// Number of points.
    #[arg(short = 'n', long, default_value_t = 1000, value_parser = whole(1_u32, 10_000_000), allow_negative_numbers = true)]
    pub count: u32,
    /// Output file: .csv, .png or .svg. Default: CSV to stdout. With `material` and with tests: the start of the pictures' names.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Sampler of the random numbers for a warp: see `pt list samplers`.
    #[arg(long, value_name = "NAME")]
    pub sampler: Option<String>,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub seed: u64,
    /// With cosine-power: the exponent n.
    #[arg(long, value_name = "N", default_value = "20", value_parser = exponent)]
    pub exponent: f32,
    /// With a cone: its half angle, in degrees.
    #[arg(long, value_name = "DEGREES", default_value = "30", value_parser = cone)]
    pub angle: f64,
    /// With spherical-triangle and spherical-rectangle: three corners as seen from the origin, such as '1,0,0 0,1,0 0,0,1'. The
    /// right angle of a rectangle is at the first.
    #[arg(long, value_name = "A B C", default_value = "-1,-1,0.7 1,-1,0.7 -1,1,0.7", value_parser = corners, allow_hyphen_values = true)]
    pub corners: [[f32; 3]; 3],
    /// With visible normals: the roughness α of the facets, along x and along y, or one for both.
    #[arg(long, value_name = "X[,Y]", default_value = "0.5", value_parser = alpha, allow_hyphen_values = true)]
    pub alpha: [f32; 2],
    /// With `material` and with visible normals: the angle from the normal (beyond 90 it is below the surface) and the azimuth, in
    /// degrees.
    #[arg(long, value_name = "THETA,PHI", default_value = "30,0", value_parser = angles, allow_hyphen_values = true)]
    pub wo: [f64; 2],
    /// Instead of points: test whether the directions of a warp follow their density. Exit code 1 if they do not.
    #[arg(long, conflicts_with = "output")]
    pub chi2: bool,
    /// With `material` or tests: let the scene name meshes and pictures that lie outside of its own folder.
    #[arg(long)]
    pub allow_outside: bool,
    /// With `material` or --chi2: the number of sampled directions.
    #[arg(long, default_value_t = 1_000_000, value_parser = whole(2_u64, 1_000_000_000), allow_negative_numbers = true)]
    pub samples: u64,
}

fn exponent(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|n: &f32| (0.0..=1e9).contains(n)).ok_or("expected a number from 0 to 1e9".to_owned())
}

fn cone(text: &str) -> std::result::Result<f64, String> {
    text.parse().ok().filter(|angle: &f64| *angle > 0.0 && *angle <= 180.0).ok_or("expected an angle above 0 and at most 180".to_owned())
}

fn corners(text: &str) -> std::result::Result<[[f32; 3]; 3], String> {
    let numbers =
        |point: &str| -> Option<Vec<f32>> { point.split(',').map(|part| part.parse().ok().filter(|x: &f32| x.is_finite())).collect() };
    let point = |point: &str| numbers(point).and_then(|coordinates| coordinates.try_into().ok());
    let parsed: Option<Vec<[f32; 3]>> = text.split_whitespace().map(point).collect();
    parsed.and_then(|points| points.try_into().ok()).ok_or("expected three points such as '1,0,0 0,1,0 0,0,1'".to_owned())
}

fn alpha(text: &str) -> std::result::Result<[f32; 2], String> {
    let (x, y) = text.split_once(',').unwrap_or((text, text));
    let parsed = [x, y].map(|part| part.trim().parse().ok().filter(|alpha| (0.0..=100.0).contains(alpha)));
    Option::zip(parsed[0], parsed[1])
        .map(|(x, y)| [x, y])
        .ok_or("expected one or two numbers from 0 to 100 such as 0.5 or 0.1,0.5".to_owned())
}

fn angles(text: &str) -> std::result::Result<[f64; 2], String> {
    let parsed = text.split_once(',').and_then(|(theta, phi)| Some([theta.trim().parse().ok()?, phi.trim().parse().ok()?]));
    let inside = |[theta, phi]: &[f64; 2]| (0.0..=180.0).contains(theta) && phi.is_finite();
    parsed.filter(inside).ok_or("expected two angles in degrees such as 60,0; the first from 0 to 180".to_owned())
}

/// Runs the command. The exit code is 1 if the samples are wrong.
pub fn sample(args: &SampleArgs) -> Result<ExitCode> {
    match (args.what.as_deref(), args.scene.as_deref()) {
        (None, _) => print_stdout(&list()).map(|()| ExitCode::SUCCESS),
        (Some("material"), Some(scene)) => material::material(scene, args),
        (Some("material"), None) => Err(Error::Usage("expected a scene and a material of it, such as scene.json#glass".into())),
        (Some(file), None) if is_file(file) => coursework::tests(Path::new(file), args),
        (Some(name), None) => draw(name, args),
        (Some(_), Some(more)) => Err(Error::Usage(format!("unexpected {more:?}: only `pt sample material` takes a scene"))),
    }
}

/// Returns whether the argument is a file, not a name.
fn is_file(what: &str) -> bool {
    extension(Path::new(what)) == Some("json") || what.contains(['/', '\\'])
}

fn list() -> String {
    let mut text = "warps: where points of the square go\n".to_owned();
    for warp in WARPS {
        text += &format!("  {:<19} {}\n", warp.name, warp.about);
    }
    text += "samplers: the square itself\n";
    for (_, name, about) in Kind::ALL {
        text += &format!("  {name:<19} {about}\n");
    }
    text + "\n  pt sample WARP [-n 1000] [-o points.csv|.png|.svg]\n  pt sample WARP --chi2\n  pt sample material scene.json#NAME --wo 60,0\n  pt sample tests.json [-o PREFIX]\n"
}

/// Prints the points of a warp or sampler as CSV, or writes them to a file by its extension. With `--chi2` it tests them instead.
fn draw(name: &str, args: &SampleArgs) -> Result<ExitCode> {
    let known = || WARPS.iter().map(|warp| warp.name).chain(Kind::ALL.iter().map(|row| row.1)).chain(["material"]).collect::<Vec<_>>();
    let warp = WARPS.iter().find(|warp| warp.name == name).or(Kind::named(name).map(|_| &points::SQUARE));
    let warp = warp.ok_or_else(|| Error::Usage(unknown("warp or sampler", name, &known())))?;
    let sampler = match (&args.sampler, Kind::named(name)) {
        (Some(given), _) => sampler_named(given)?,
        (None, own) => own.unwrap_or_default(),
    };
    let parameters = Parameters {
        exponent: args.exponent,
        one_minus_cos: one_minus_cos(args.angle),
        corners: args.corners.map(Vec3::from),
        alpha: args.alpha.into(),
        wo: args.wo,
    };
    if args.chi2 {
        return directions::print_tests(warp, &parameters, args);
    }
    let drawn = points::draw(warp, &parameters, sampler, args.seed, args.count)?;
    let Some(path) = &args.output else { return print_stdout(&points::csv(&drawn, warp)).map(|()| ExitCode::SUCCESS) };
    let bytes = match extension(path) {
        Some("csv") => points::csv(&drawn, warp).into_bytes(),
        Some("png") => marks::png(&marks::marks(&drawn, warp.domain), warp.domain)?,
        Some("svg") => marks::svg(&marks::marks(&drawn, warp.domain), warp.domain).into_bytes(),
        _ => return Err(Error::Usage(format!("{}: expected a name that ends in .csv, .png or .svg", path.display()))),
    };
    output::replace(path, &bytes).map(|()| ExitCode::SUCCESS)
}

fn extension(path: &Path) -> Option<&str> {
    path.extension()?.to_str()
}

/// 1 − cos α as 2 sin²(α/2), which is exact for narrow cones.
fn one_minus_cos(degrees: f64) -> f32 {
    (2.0 * (0.5 * degrees.to_radians()).sin().powi(2)) as f32
}
