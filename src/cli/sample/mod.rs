//! `pt sample`: points of every warp and sampler, and how a material scatters, as numbers and as pictures; and the tests of courses.

mod course;
mod directions;
mod globe;
mod marks;
mod material;
mod points;

use std::path::Path;
use std::process::ExitCode;

use glam::Vec3;

use super::{args, say};
use crate::error::{Error, Result};
use crate::output;
use crate::reader::unknown;
use crate::sampler::Kind;
use points::{Parameters, WARPS};

/// What to draw; 1 where what was drawn is wrong.
pub fn sample(args: &args::Sample) -> Result<ExitCode> {
    match (args.what.as_deref(), args.scene.as_deref()) {
        (None, _) => say(&list()).map(|()| ExitCode::SUCCESS),
        (Some("material"), Some(scene)) => material::material(scene, args),
        (Some("material"), None) => Err(Error::Usage("expected a scene and a material of it, such as scene.json#glass".into())),
        (Some(file), None) if is_file(file) => course::tests(Path::new(file), args),
        (Some(name), None) => draw(name, args),
        (Some(_), Some(more)) => Err(Error::Usage(format!("unexpected {more:?}: only `pt sample material` takes a scene"))),
    }
}

/// Rather than a name.
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

/// Points of a warp or sampler, or with `--chi2` a judgement of them: CSV to stdout, or to a file by its extension.
fn draw(name: &str, args: &args::Sample) -> Result<ExitCode> {
    let known = || WARPS.iter().map(|warp| warp.name).chain(Kind::ALL.iter().map(|row| row.1)).chain(["material"]).collect::<Vec<_>>();
    let kind = |name: &str| Kind::ALL.iter().find(|row| row.1 == name).map(|row| row.0);
    let warp = WARPS.iter().find(|warp| warp.name == name).or(kind(name).map(|_| &points::SQUARE));
    let warp = warp.ok_or_else(|| Error::Usage(unknown("warp or sampler", name, &known())))?;
    let sampler = match (&args.sampler, kind(name)) {
        (Some(given), _) => {
            kind(given).ok_or_else(|| Error::Usage(unknown("sampler", given, &Kind::ALL.iter().map(|row| row.1).collect::<Vec<_>>())))?
        }
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
        return directions::judge(warp, &parameters, args);
    }
    let drawn = points::draw(warp, &parameters, sampler, args.seed, args.count)?;
    let Some(path) = &args.output else { return say(&points::csv(&drawn, warp)).map(|()| ExitCode::SUCCESS) };
    let bytes = match extension(path) {
        Some("csv") => points::csv(&drawn, warp).into_bytes(),
        Some("png") => marks::png(&marks::marks(&drawn, warp.kin), warp.kin)?,
        Some("svg") => marks::svg(&marks::marks(&drawn, warp.kin), warp.kin).into_bytes(),
        _ => return Err(Error::Usage(format!("{}: expected a name that ends in .csv, .png or .svg", path.display()))),
    };
    output::replace(path, &bytes).map(|()| ExitCode::SUCCESS)
}

fn extension(path: &Path) -> Option<&str> {
    path.extension()?.to_str()
}

/// 2 sin²(α/2), which keeps narrow cones.
fn one_minus_cos(degrees: f64) -> f32 {
    (2.0 * (0.5 * degrees.to_radians()).sin().powi(2)) as f32
}
