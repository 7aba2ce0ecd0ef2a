//! `pt verify SCENE A B`: tests whether two methods, or a method and a picture, converge to the same picture.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use super::load::SceneArgs;
use super::load::{Loaded, load};
use super::parse::{duration as parse_duration, share, size};
use super::progress::Progress;
use super::progress::WorkArgs;
use super::{INCONCLUSIVE, note, print_stdout, render, signals};
use crate::build::Built;
use crate::error::{Error, Fault, Result};
use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::Entry;
use crate::measure::agreement::Conclusion;
use crate::measure::format::{duration, per_cent};
use crate::measure::{Agreement, Refusal, StopCondition, agreement, render_until};
use crate::output::attributes::REFUSED;
use crate::output::{self, Attributes, Tonemap, exr};
use crate::render::{Render, Settings};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;
use std::path::PathBuf;
use std::time::Duration;

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

/// Independent scramblings of each side; the test uses their variance.
const SCRAMBLINGS: u32 = 16;

/// One of the two pictures.
struct Side {
    name: String,
    image: Image,
    /// Number n of independent values behind each mean; its variance has n − 1 degrees of freedom.
    samples: u64,
    /// Whether the picture itself says that a few pixels hold all its noise.
    is_heavy: bool,
}

/// Runs the command.
pub fn verify(args: &VerifyArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    // clap requires no argument after one that it does not require, and the scene is one.
    if args.sides.is_empty() {
        return Err(Error::Usage("expected a scene and two sides, as in pt verify scene.json nee path".into()));
    }
    let resized = args.size.map(render::resized).unwrap_or_default();
    let loaded = load(&args.scene, &resized, None, tables)?;
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    if let Some(path) = &args.output {
        output::check_folder(path)?;
    }
    signals::catch()?;
    render::pool(args.work.threads)?.install(|| compare_sides(args, loaded, tables))
}

fn compare_sides(args: &VerifyArgs, loaded: Loaded, tables: &[&[Entry]]) -> Result<ExitCode> {
    let methods = args.sides.iter().map(|name| parse_side(name, &loaded, tables)).collect::<Result<Vec<_>>>()?;
    let Built { world, film, sampler, .. } = loaded.built;
    let film = film.without_layers();
    let effects = world.effects();
    let scene: Arc<dyn Scene> = Arc::new(world);
    let mut sides = vec![];
    for (k, method) in methods.into_iter().enumerate() {
        sides.push(match method {
            Method::Picture(side) => side,
            Method::Integrator(entry, integrator) => {
                if let Some(lacks) = entry.lacks(effects) {
                    note(&format!("note: {} does not simulate what this scene calls for: {lacks}", entry.name));
                }
                // The random numbers differ from those of the other side, and from those of a picture with the scene's own seed:
                // with shared numbers the sides would agree more than chance allows.
                let sampler = SamplerSpec { seed: sampler.seed.wrapping_add(0x5eed * (k as u64 + 1)), scramblings: SCRAMBLINGS, ..sampler };
                render_side(args, &scene, &film, entry, &*integrator, sampler)?
            }
        });
    }
    let [a, b] = sides.try_into().map_err(|_| Error::Usage("expected two sides".into()))?;
    let mut agreement = agreement(a.as_sampled_image(), b.as_sampled_image(), args.alpha)?;
    [&a, &b].into_iter().zip(&mut agreement.heavy).for_each(|(side, heavy)| *heavy |= side.is_heavy);
    report(args, &a, &b, &agreement)
}

enum Method {
    Integrator(Entry, Arc<dyn crate::integrator::Integrator>),
    Picture(Side),
}

/// Method of a name: an integrator of the tables, or a picture with error bars.
fn parse_side(name: &str, loaded: &Loaded, tables: &[&[Entry]]) -> Result<Method> {
    if Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        return read_side(Path::new(name), &loaded.built.film).map(Method::Picture);
    }
    loaded.choose(tables, name).map(|(entry, integrator)| Method::Integrator(entry, integrator))
}

/// Reads a picture with standard errors, which must have the same pixels.
fn read_side(path: &Path, film: &FilmSpec) -> Result<Side> {
    let (image, attributes) = exr::read(path)?;
    let refused = |text: String| Error::invalid(Fault::new(text).in_file(path));
    render::same_pixels(path, &image, film)?;
    if let Some(missing) = ["R", "G", "B", "StdErr.R", "StdErr.G", "StdErr.B"].into_iter().find(|name| image.channel(name).is_none()) {
        return Err(refused(format!("has no channel {missing}: without standard errors nothing can be concluded")));
    }
    let broken = image.channels.iter().flat_map(|channel| &channel.values).filter(|value| !value.is_finite()).count();
    if broken > 0 {
        return Err(refused(format!("has {broken} values that are no numbers")));
    }
    let freedom =
        attributes.iter().find(|(name, _)| name == "pt/standardErrorFreedom").and_then(|(_, value)| value.to_string().parse::<u64>().ok());
    let freedom = freedom.ok_or_else(|| refused("does not say how sure its standard errors are (pt/standardErrorFreedom)".into()))?;
    // The standard errors of a pixel are shared with those around it, which hides that a few samples make them.
    let is_heavy = attributes.iter().any(|(name, value)| name == REFUSED && value.to_string() == Refusal::HeavyTail.to_string());
    Ok(Side { name: path.display().to_string(), image, samples: freedom + 1, is_heavy })
}

fn render_side(
    args: &VerifyArgs,
    scene: &Arc<dyn Scene>,
    film: &FilmSpec,
    entry: Entry,
    integrator: &dyn crate::integrator::Integrator,
    sampler: SamplerSpec,
) -> Result<Side> {
    let samples = args.spp.map_or(if args.time.is_some() { u32::MAX.into() } else { sampler.spp }, u64::from);
    let until = StopCondition { samples, time: args.time, target: None };
    let mut moments = MomentFilm::new(film.clone());
    let mut render = Render::new(scene.clone(), integrator, film, &Settings::new(SamplerSpec { spp: samples, ..sampler }));
    let progress = Progress::new(args.work.progress, film, samples, args.time);
    let history = render_until(&mut render, &mut moments, &until, &progress);
    progress.finish();
    if let Some(signal) = signals::caught() {
        return Err(Error::Interrupted(signal));
    }
    let error = history.last().and_then(|last| last.error);
    let told = match error.map(|error| error.stated(CONFIDENCE)) {
        Some(Ok(error)) => format!(", relative error {} %", per_cent(error.value)),
        Some(Err(refusal)) => format!(", relative error cannot be established ({refusal})"),
        None => String::new(),
    };
    note(&format!("{}: {} spp in {}{told}", entry.name, moments.samples(), duration(render.report().elapsed.as_secs_f64())));
    let freedom = moments.freedom();
    if freedom == 0.0 {
        let needed = 2 * SCRAMBLINGS;
        return Err(Error::Usage(format!(
            "{} samples per pixel tell no error: at least {needed} are needed (--spp, --time)",
            moments.samples()
        )));
    }
    Ok(Side { name: entry.name.into(), image: moments.image(), samples: freedom as u64 + 1, is_heavy: false })
}

impl Side {
    fn as_sampled_image(&self) -> crate::measure::SampledImage<'_> {
        crate::measure::SampledImage { image: &self.image, samples: self.samples }
    }
}

/// Prints the results of the tests and the smallest bias that they would detect. Returns the exit code: 0 the same, 1 different, 7
/// inconclusive.
fn report(args: &VerifyArgs, a: &Side, b: &Side, agreement: &Agreement) -> Result<ExitCode> {
    if let Some(path) = &args.output {
        let p = crate::measure::agreement::p_values(a.as_sampled_image(), b.as_sampled_image())?;
        output::write(path, &p, &Attributes::new(), &Tonemap::default())?;
    }
    let is_heavy = agreement.heavy.contains(&true);
    let tests = match is_heavy {
        true => format!("  whole image, as far as a few samples more or less can explain: {}\n", agreement.rare),
        false => agreement.to_string().split("; ").map(|line| format!("  {line}\n")).collect::<String>(),
    };
    let seen = crate::measure::agreement::smallest_bias(a.as_sampled_image(), b.as_sampled_image(), args.alpha)?;
    // Where a few samples hold the noise, normal statistics do not tell what would have shown.
    let power = match is_heavy {
        true => String::new(),
        false => format!("a difference of {} % of the whole picture's light would have shown\n", per_cent(seen)),
    };
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
