//! `pt compare SCENE`: measures what accuracy costs in time, for several methods.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

mod live;
mod origin;
mod picture;
mod replay;
mod scenes;

use super::load::SceneArgs;
use super::load::{Loaded, load};
use super::messages::fitted;
use super::parse::{duration as parse_duration, share, size};
use super::progress::Progress;
use super::progress::{ProgressForm, WorkArgs};
use super::quote::quoted;
use super::reference;
use super::watch::PageAddress;
use super::{note, print_stdout, render, signals};
use crate::compare::{
    self, Budget, Comparison, GivenPicture, Method, MethodConfig, Provenance, Reference, ReferenceRenderer, conclusions, configs, report,
};
use crate::error::{Error, Fault, Result};
use crate::film::{FilmSpec, Image};
use crate::integrator::Entry;
use crate::measure::format::{duration, per_cent};
use crate::measure::{Metric, StopCondition};
use crate::output::{self, Attributes, exr};
use crate::scene::Scene;
use live::{Growing, LiveReport, Told};
use scenes::{OtherScene, contestants, load_others};

#[derive(clap::Args, Debug)]
pub struct CompareArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Further versions of the scene, with other materials or settings: every method renders them, too, and is measured against the
    /// reference of SCENE. Options and -D hold for all scenes, and so does the size of the first.
    #[arg(value_name = "OTHER")]
    pub others: Vec<PathBuf>,
    /// Integrators to compare.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "path,nee,whitted")]
    pub integrators: Vec<String>,
    /// Samplers to compare. Default: the scene's.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub samplers: Vec<String>,
    /// Precisions in which paths are followed: `f32,f64` adds a slow method that follows the paths of `path` in double precision, for
    /// scenes that `pt precision` knows.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',', default_value = "f32")]
    pub precision: Vec<Precision>,
    /// Folder of the report. Default: SCENE-report here.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Samples per pixel of each replicate, at most; without --time exactly.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Render time of each method, and of a reference that is computed. Default: 8s; with --spp alone the methods have no limit.
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    pub time: Option<Duration>,
    /// Number of independent renders of each method.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(2..=256))]
    pub replicates: u32,
    /// Reference picture, an EXR of the same pixels. Default: one is computed.
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Folder in which `pt reference` caches references: one of this scene and size is used, and improved if it took less than
    /// --reference-time.
    #[arg(long, value_name = "FOLDER", env = "PT_CACHE")]
    pub cache: Option<PathBuf>,
    /// Integrator of a reference that is computed. Default: nee.
    #[arg(long, value_name = "NAME", conflicts_with = "reference")]
    pub reference_integrator: Option<String>,
    /// Render time of a reference that is computed. Default: as long as each method.
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, conflicts_with = "reference")]
    pub reference_time: Option<Duration>,
    /// Size of the pictures. Default: the scene's, at most 65536 pixels.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Confidence of intervals.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    /// Additional error measure: see `pt list metrics`. May be repeated.
    #[arg(short, long, value_name = "NAME")]
    pub metric: Vec<String>,
    /// Write data for the JERI viewer too.
    #[arg(long)]
    pub jeri: bool,
    /// Picture of another renderer as a contestant, with the time that it took: an EXR of the same pixels. May be repeated; pictures
    /// of one name and about one time are repeats, which give error bars.
    #[arg(long, value_name = "NAME=FILE@DURATION", value_parser = picture::parse)]
    pub picture: Vec<picture::PictureArg>,
    /// Repeat a comparison from its convergence.json, with as many samples and the report's reference, and say what changed beyond
    /// chance. Nothing is written; exit code 1 if an error changed.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["path", "others", "overrides", "integrators", "samplers", "precision", "output", "spp", "time", "replicates", "reference", "reference_integrator", "reference_time", "size", "confidence", "metric", "picture", "jeri", "sky", "ground", "view", "up", "allow_outside"]
    )]
    pub replay: Option<PathBuf>,
    /// Show the report in a browser while it grows, with a button that ends the comparison after the checkpoint under way. The address of
    /// the page is printed; 127.0.0.1:0 is any free port of this machine. Only in a build with --features serve.
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "replay")]
    pub serve: Option<String>,
    /// With --serve: an address that other machines reach. Who has the printed address with its token may watch, and end the comparison.
    #[arg(long, requires = "serve", conflicts_with = "replay")]
    pub serve_any: bool,
    #[command(flatten)]
    pub work: WorkArgs,
}

/// Precision of a method's numbers.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Single: 24 bits.
    F32,
    /// Double: 53 bits.
    F64,
}

/// Default number of pixels, and default time of each method and of the reference.
const PIXELS: u32 = 1 << 16;
const TIME: Duration = Duration::from_secs(8);

/// Samples per pixel of a replicate that only time limits.
const UNLIMITED: u64 = 1 << 30;

/// Runs the command.
pub fn compare(args: &CompareArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    if let Some(file) = &args.replay {
        return replay::replay(file, &args.work, tables);
    }
    let address = args.serve.as_ref().map(|text| PageAddress::new(text, args.serve_any)).transpose()?;
    let loaded = load_resized(args, tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    args.metric.iter().try_for_each(|name| Metric::parse(name).map(drop))?;
    let others = load_others(args, &loaded, tables)?;
    let configs = contestants(args, &loaded, &others, tables)?;
    let given = args.reference.as_deref().map(|path| read_reference(path, &loaded.film)).transpose()?;
    let pictures = picture::read(&args.picture, &configs, &loaded.film)?;
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}-report", loaded.stem)));
    std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
    signals::catch()?;
    let live = address.and_then(|address| LiveReport::start(&address, &loaded.stem));
    render::pool(args.work.threads)?.install(|| measure(args, loaded, &others, (configs, pictures), given, (&folder, live), tables))
}

/// Loads the scene, in a smaller size unless one is requested: the decrease of the error does not depend on the size.
fn load_resized(args: &CompareArgs, tables: &[&[Entry]]) -> Result<Loaded> {
    if let Some(size) = args.size {
        return load(&args.scene, &render::resized(size), None, tables);
    }
    let loaded = load(&args.scene, &[], None, tables)?;
    let [width, height] = loaded.film.size.to_array();
    if loaded.film.crop.pixel_count() <= PIXELS.into() {
        return Ok(loaded);
    }
    let scale = (f64::from(PIXELS) / (f64::from(width) * f64::from(height))).sqrt();
    let smaller = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    note(&format!("compared at {}×{} pixels instead of {width}×{height}; --size asks for more", smaller[0], smaller[1]));
    load(&args.scene, &render::resized(smaller), None, tables)
}

/// Reads a reference: it must have the same pixels and only finite values.
fn read_reference(path: &Path, film: &FilmSpec) -> Result<Reference> {
    let (image, attributes) = read_picture(path, film, "reference")?;
    Ok(Reference::from_file(image, path.display().to_string(), attributes))
}

/// Reads a picture with the scene's pixels and only finite values.
///
/// - `role`: what it is, for messages
fn read_picture(path: &Path, film: &FilmSpec, role: &str) -> Result<(Image, Attributes)> {
    let (image, attributes) = exr::read(path)?;
    let refused = |text: String| Error::invalid(Fault::new(text).in_file(path));
    output::same_pixels(path, &image, film)?;
    if let Some(missing) = ["R", "G", "B"].into_iter().find(|name| image.channel(name).is_none()) {
        return Err(refused(format!("the {role} has no channel {missing}")));
    }
    let broken = image.pixels().flatten().filter(|value| !value.is_finite()).count();
    if broken > 0 {
        return Err(refused(format!("the {role} has {broken} values that are not finite")));
    }
    Ok((image, attributes))
}

fn measure(
    args: &CompareArgs,
    loaded: Loaded,
    others: &[OtherScene],
    (configs, pictures): (Vec<MethodConfig>, Vec<GivenPicture>),
    given: Option<Reference>,
    (folder, live): (&Path, Option<LiveReport>),
    tables: &[&[Entry]],
) -> Result<ExitCode> {
    let spec = loaded.film.clone().without_layers();
    let renderer = ReferenceRenderer::new(&loaded, args.reference_integrator.as_deref(), tables)?;
    let cached = reference::cache(args.cache.as_deref()).ok().map(|cache| renderer.path(&cache)).filter(|path| path.exists());
    let stem = loaded.stem.clone();
    let mut provenance = origin::provenance(args, &loaded, others)?;
    let scene: Arc<dyn Scene> = loaded.world;
    let time = args.time.unwrap_or(TIME);
    let interrupted = || Error::Interrupted(signals::caught().unwrap_or_default());
    let reference = match given {
        Some(reference) => reference,
        None => {
            let time = args.reference_time.unwrap_or(time);
            compute_reference(args, &scene, &renderer, cached, time, live.as_ref())?.ok_or_else(interrupted)?
        }
    };
    if reference.image.pixels().flatten().all(|value| value == 0.0) {
        return Err(Error::invalid(Fault::new(format!("{} is black: there is nothing to compare", reference.origin)).in_file(&stem)));
    }
    let budget = Budget {
        replicates: args.replicates,
        samples: args.spp.map_or(UNLIMITED, u64::from),
        // With a limit of samples alone, time is not limited.
        time: if args.spp.is_some() && args.time.is_none() { None } else { Some(time) },
        metrics: args.metric.iter().map(|name| Metric::parse(name)).collect::<Result<_>>()?,
    };
    let unlike = || Error::Internal("a picture cannot be compared with the reference".into());
    let pictures = compare::given(pictures, &budget.metrics, &reference, args.confidence).ok_or_else(unlike)?;
    provenance.reference_hash = output::hash(&reference.image).to_string();
    let commands = origin::commands(args, &provenance, &reference.image, folder)?;
    let comparison = |mut methods: Vec<Method>| {
        methods.extend_from_slice(&pictures);
        let conclusions = conclusions(&methods, &reference, args.confidence, &commands);
        let (reference, metrics, provenance) = (reference.clone(), budget.metrics.clone(), provenance.clone());
        Comparison { scene: stem.clone(), reference, methods, metrics, confidence: args.confidence, conclusions, provenance }
    };
    let count = configs.len() as u32;
    // The last checkpoint has the largest power of two that is asked for.
    let rounds = (1u64 << budget.samples.ilog2()).saturating_mul(u64::from(args.replicates * count)).min(u32::MAX.into());
    let progress = Progress::new(args.work.progress, &spec, rounds, budget.time.map(|time| time * count));
    let told = Told { progress: &progress, doing: "Comparing", live: live.as_ref() };
    let growing = Growing { live: live.as_ref(), comparison };
    let methods = compare::run(&configs, &budget, &reference, args.confidence, &told, &growing).ok_or_else(interrupted)?;
    progress.finish();
    let comparison = (growing.comparison)(methods);
    let Reference { image, attributes, .. } = &comparison.reference;
    output::write(&folder.join("reference.exr"), image, attributes, &output::Tonemap::default())?;
    compare::report::write(&comparison, folder, args.jeri)?;
    live.into_iter().for_each(|live| live.finish(&comparison, format!("The report is {}.", folder.join("index.html").display())));
    remark_coarse_reference(args, &comparison)?;
    print_stdout(&fitted(&summary(&comparison, folder)))?;
    Ok(ExitCode::SUCCESS)
}

/// Computes a reference: from the cached one if it exists, which is improved, and by rendering otherwise.
fn compute_reference(
    args: &CompareArgs,
    scene: &Arc<dyn Scene>,
    renderer: &ReferenceRenderer,
    cached: Option<PathBuf>,
    time: Duration,
    live: Option<&LiveReport>,
) -> Result<Option<Reference>> {
    let progress = Progress::new(ProgressForm::None, &renderer.spec, u32::MAX.into(), Some(time));
    let before = cached.as_ref().and_then(|path| renderer.read(path));
    let (known, origin) =
        (before.as_ref().map_or(0, |cached| cached.report.samples), if before.is_some() { "the kept reference" } else { "a reference" });
    let until = StopCondition { samples: u32::MAX.into(), time: Some(time), target: None, patience: None };
    let told = Told { progress: &progress, doing: "Rendering the reference", live };
    let made = renderer.render(scene, before, &until, &told);
    if let Some(path) = cached.filter(|_| known > 0 && made.report.samples > known) {
        renderer.write(&path, &made)?;
    }
    if made.report.cancelled {
        return Ok(None);
    }
    Ok(Some(renderer.reference(&made, origin, args.confidence)))
}

/// Notes if the reference is too coarse: its error must be known, and its variance should be at most a tenth of that of the best method.
fn remark_coarse_reference(args: &CompareArgs, comparison: &Comparison) -> Result<()> {
    let Some(own) = comparison.reference.error else {
        note(&format!("note: {} does not state its own error: times for errors below it are wrong", comparison.reference.origin));
        return Ok(());
    };
    if let Some(refusal) = own.refusal() {
        let advice = "another --reference-integrator or a longer --reference-time may help";
        note(&format!("note: the reference's own error cannot be established ({refusal}), so no time is stated; {advice}"));
        return Ok(());
    }
    let last = |method: &compare::Method| method.curve.last().map(|last| (last.relmse.0, method.name.clone()));
    let best = comparison.methods.iter().filter_map(last).filter(|(relmse, _)| *relmse > 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((relmse, name)) = best.filter(|(relmse, _)| 10.0 * own.value * own.value > *relmse) {
        let command = reference_command(args, &comparison.reference, (relmse / 10.0).sqrt())?;
        note(&format!("note: the reference's variance is more than a tenth of that of {name}; one that is better:\n  {command}"));
    }
    Ok(())
}

/// Command that computes a reference with an error, which the same comparison without `--reference` then finds in the cache.
fn reference_command(args: &CompareArgs, reference: &Reference, error: f64) -> Result<String> {
    let mut words = vec!["pt".to_owned(), "reference".to_owned(), args.scene.path()?.display().to_string()];
    let mut flag = |name: &str, value: Option<String>| words.extend(value.into_iter().flat_map(|value| [name.to_owned(), value]));
    args.scene.overrides.iter().for_each(|text| flag("-D", Some(text.clone())));
    flag("--integrator", args.reference_integrator.clone());
    flag("--cache", args.cache.as_ref().map(|path| path.display().to_string()));
    let [width, height] = reference.image.full_size.to_array();
    flag("--size", Some(format!("{width}x{height}")));
    // An error of 100 % and above is no goal.
    flag("--error", Some(format!("{}%", per_cent(error.min(0.5)))));
    words.extend(args.scene.flags());
    Ok(words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
}

fn summary(comparison: &Comparison, folder: &Path) -> String {
    let mut text = format!("against {}, {}\n", comparison.reference.origin, comparison.reference.own_error(comparison.confidence));
    for method in &comparison.methods {
        let Some(last) = method.curve.last() else { continue };
        let samples = method.spp(last.samples).map_or(String::new(), |samples| format!("{samples} spp · "));
        let error = match report::last_error(comparison, method) {
            Ok(point) => {
                let slope = method.slope.map_or(String::new(), |slope| format!(" · slope {}", report::slope(slope)));
                format!("error {} %{slope}", per_cent(point.error))
            }
            Err(reason) => format!("error {reason}"),
        };
        text += &format!("{}: {samples}{} · {error}\n", method.name, duration(last.seconds));
    }
    comparison.conclusions.iter().for_each(|conclusion| text += &format!("{}\n", conclusion.text));
    text + &format!("{}\n", folder.join("index.html").display())
}
