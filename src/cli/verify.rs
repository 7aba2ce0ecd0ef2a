//! `pt verify SCENE A B`: tests whether two methods, or a method and a picture, converge to the same picture.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use super::load::SceneArgs;
use super::load::{Loaded, load};
use super::parse::{duration as parse_duration, share, size};
use super::progress::Progress;
use super::progress::WorkArgs;
use super::{INCONCLUSIVE, note, print_stdout, render, signals};
use crate::error::{Error, Result};
use crate::film::FilmSpec;
use crate::integrator::{Entry, Integrator};
use crate::measure::StopCondition;
use crate::measure::agreement::Conclusion;
use crate::measure::format::{duration, per_cent};
use crate::measure::verify::{self, RenderedSide, Side, Verification};
use crate::output::{self, Attributes, Tonemap};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;

#[derive(clap::Args, Debug)]
pub struct VerifyArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Two integrators, or an integrator and an EXR with error bars.
    #[arg(value_name = "SIDE", num_args = 2)]
    pub sides: Vec<String>,
    /// Samples per pixel of each rendered side. Default: the scene's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Render time of each rendered side.
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    pub time: Option<Duration>,
    /// Risk of calling two sides different that are the same.
    #[arg(long, value_name = "SHARE", default_value = "1%", value_parser = share)]
    pub alpha: f64,
    /// Output file for the p-values, pixel by pixel.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Size of the pictures.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub work: WorkArgs,
}

/// Confidence of the stated errors; only the error itself is printed.
const CONFIDENCE: f64 = 0.95;

/// Runs the command.
pub fn verify(args: &VerifyArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    // clap requires no argument after one that it does not require, and the scene is one.
    if args.sides.is_empty() {
        return Err(Error::Usage("expected a scene and two sides, as in pt verify scene.json nee path".into()));
    }
    let resized = args.size.map(render::resized).unwrap_or_default();
    let loaded = load(&args.scene, &resized, None, tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    if let Some(path) = &args.output {
        output::check_folder(path)?;
    }
    signals::catch()?;
    render::pool(args.work.threads)?.install(|| compare_sides(args, loaded, tables))
}

fn compare_sides(args: &VerifyArgs, loaded: Loaded, tables: &[&[Entry]]) -> Result<ExitCode> {
    let methods = args.sides.iter().map(|name| parse_side(name, &loaded, tables)).collect::<Result<Vec<_>>>()?;
    let Loaded { world, film, sampler, .. } = loaded;
    let film = film.without_layers();
    let effects = world.effects();
    let scene: Arc<dyn Scene> = world;
    let mut sides = vec![];
    for (method, k) in methods.into_iter().zip(0..) {
        sides.push(match method {
            Method::Picture(side) => side,
            Method::Integrator(entry, integrator) => {
                if let Some(lacks) = entry.lacks(effects) {
                    note(&format!("note: {} does not simulate what this scene calls for: {lacks}", entry.name));
                }
                render_side(args, &scene, &film, (entry.name, &*integrator), (sampler, k))?
            }
        });
    }
    let [a, b] = sides.try_into().map_err(|_| Error::Usage("expected two sides".into()))?;
    report(args, &a, &b, &verify::verify(&a, &b, args.alpha)?)
}

enum Method {
    Integrator(Entry, Arc<dyn Integrator>),
    Picture(Side),
}

/// Method of a name: an integrator of the tables, or a picture with error bars.
fn parse_side(name: &str, loaded: &Loaded, tables: &[&[Entry]]) -> Result<Method> {
    if Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        return Side::read(Path::new(name), &loaded.film).map(Method::Picture);
    }
    loaded.choose(tables, name).map(|(entry, integrator)| Method::Integrator(entry, integrator))
}

fn render_side(
    args: &VerifyArgs,
    scene: &Arc<dyn Scene>,
    film: &FilmSpec,
    method: (&str, &dyn Integrator),
    (sampler, k): (SamplerSpec, u64),
) -> Result<Side> {
    let samples = args.spp.map_or(if args.time.is_some() { u32::MAX.into() } else { sampler.spp }, u64::from);
    let until = StopCondition { samples, time: args.time, target: None, patience: None };
    let progress = Progress::new(args.work.progress, film, samples, args.time);
    let rendered = Side::render(scene, film, method, (sampler, k), &until, &progress);
    progress.finish();
    if let Some(signal) = signals::caught() {
        return Err(Error::Interrupted(signal));
    }
    let error = rendered.history.last().and_then(|last| last.error);
    let told = match error.map(|error| error.stated(CONFIDENCE)) {
        Some(Ok(error)) => format!(", relative error {} %", per_cent(error.value)),
        Some(Err(refusal)) => format!(", relative error cannot be established ({refusal})"),
        None => String::new(),
    };
    let RenderedSide { side, samples, report, .. } = rendered;
    note(&format!("{}: {samples} spp in {}{told}", method.0, duration(report.elapsed.as_secs_f64())));
    side.ok_or_else(|| Error::Usage(format!("{} (--spp, --time)", Side::too_few(samples))))
}

/// Prints the results of the tests and the smallest bias that they would detect. Returns the exit code: 0 the same, 1 different, 7
/// inconclusive.
fn report(args: &VerifyArgs, a: &Side, b: &Side, found: &Verification) -> Result<ExitCode> {
    if let Some(path) = &args.output {
        let p = verify::p_value_picture(a, b)?;
        output::write(path, &p, &Attributes::new(), &Tonemap::default())?;
    }
    let agreement = &found.agreement;
    let is_heavy = agreement.heavy.contains(&true);
    let tests = match is_heavy {
        true => format!("  whole image, as far as a few samples more or less can explain: {}\n", agreement.rare),
        false => agreement.to_string().split("; ").map(|line| format!("  {line}\n")).collect::<String>(),
    };
    let shown = |seen: f64| format!("a difference of {} % of the whole picture's light would have shown\n", per_cent(seen));
    let power = found.smallest_bias.map_or(String::new(), shown);
    let unsure: Vec<&str> =
        [a, b].into_iter().zip(agreement.heavy).filter(|(_, heavy)| *heavy).map(|(side, _)| side.name.as_str()).collect();
    let (word, code) = match agreement.conclusion() {
        Conclusion::Inconclusive => ("inconclusive", ExitCode::from(INCONCLUSIVE)),
        Conclusion::Same => ("the same picture, as far as one can tell", ExitCode::SUCCESS),
        Conclusion::Different => ("different pictures", ExitCode::FAILURE),
    };
    let why = match is_heavy {
        false => String::new(),
        true => format!("heavy tail: a few samples hold all the noise of {}\n", unsure.join(" and ")),
    };
    print_stdout(&format!("{} and {}: {word}\n{tests}{why}{power}", a.name, b.name))?;
    Ok(code)
}
