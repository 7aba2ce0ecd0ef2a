//! `pt reference`: computes a reference picture with its own error stated, and caches it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use super::load::SceneArgs;
use super::load::{Loaded, load};
use super::outputs::{OutputKinds, check_outputs};
use super::parse::{duration, share, size, whole};
use super::progress::Progress;
use super::progress::WorkArgs;
use super::summary::{Accuracy, attributes, print_summary};
use super::{INCONCLUSIVE, note, render, signals};
use crate::compare::{CachedReference, ReferenceRenderer};
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::measure::{ErrorTarget, Outcome, Scope, StopCondition, format};
use crate::output::{self, Tonemap};
use crate::part::{self, Stored};
use crate::render::RenderReport;
use crate::scene::Scene;

#[derive(clap::Args, Debug)]
pub struct ReferenceArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Render until the relative error is at most this, such as 0.3%. Exit code 7 if it is not reached.
    #[arg(long, value_name = "ERROR", value_parser = share)]
    pub error: Option<f64>,
    /// Samples per pixel.
    #[arg(long, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// Render time, with what was spent before. Default, without --error and --spp: 60s.
    #[arg(long, value_name = "DURATION", value_parser = duration, allow_negative_numbers = true)]
    pub time: Option<Duration>,
    /// Integrator of the reference. Default: nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Additional output file: .exr, .hdr, .png, .ppm, .pfm. May be repeated.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Folder of cached references. Default: pt in the user's folder for caches.
    #[arg(long, value_name = "FOLDER", env = "PT_CACHE")]
    pub cache: Option<PathBuf>,
    /// Confidence of errors.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    /// Size of the picture.
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub work: WorkArgs,
}

/// Default render time.
const TIME: Duration = Duration::from_secs(60);
impl ReferenceRenderer {
    /// Path of the cached reference.
    pub fn path(&self, cache: &Path) -> PathBuf {
        cache.join(format!("{}.ptc", self.about.identity.hash()))
    }

    /// Reads the cached reference; `None` if there is none, or if it is unusable, which is noted.
    pub fn read(&self, path: &Path) -> Option<CachedReference> {
        path.exists().then_some(())?;
        let usable = || -> Result<CachedReference> {
            let stored = Stored::open(path)?;
            if let Some(difference) = stored.about.difference(&self.about) {
                return Err(Error::Usage(format!("{}: {difference}", path.display())));
            }
            let sum = part::merge(vec![stored])?;
            let is_whole = sum.whole().is_ok();
            if !is_whole {
                return Err(Error::Usage(format!("{}: has gaps", path.display())));
            }
            Ok(CachedReference { film: sum.film, report: sum.report, history: sum.history })
        };
        usable().map_err(|refusal| note(&format!("note: the kept reference is of no use: {refusal}"))).ok()
    }

    /// Writes a reference to the cache.
    ///
    /// # Errors
    /// `Io`.
    pub fn write(&self, path: &Path, cached: &CachedReference) -> Result<()> {
        let folder = output::folder(path);
        std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        part::write(path, &self.about, &cached.film, &cached.report, &cached.history)
    }
}

/// Folder of cached references: the named one, or one in the user's folder for caches.
///
/// # Errors
/// `Usage` if neither is known.
pub fn cache(named: Option<&Path>) -> Result<PathBuf> {
    let of = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || of("XDG_CACHE_HOME").or_else(|| Some(of("HOME")?.join(".cache"))).map(|folder| folder.join("pt"));
    let unknown = || Error::Usage("nowhere to keep references: say --cache FOLDER or set PT_CACHE".into());
    named.map(Path::to_owned).or_else(usual).ok_or_else(unknown)
}

/// Runs the command.
pub fn reference(args: &ReferenceArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    let resized = args.size.map(render::resized).unwrap_or_default();
    let loaded = load(&args.scene, &resized, None, tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    check_outputs(&args.output, OutputKinds::Pictures, &[args.scene.path()?], "is the scene file")?;
    let renderer = ReferenceRenderer::new(&loaded, args.integrator.as_deref(), tables)?;
    let path = renderer.path(&cache(args.cache.as_deref())?);
    signals::catch()?;
    render::pool(args.work.threads)?.install(|| render_reference(args, loaded, &renderer, &path))
}

fn render_reference(args: &ReferenceArgs, loaded: Loaded, renderer: &ReferenceRenderer, path: &Path) -> Result<ExitCode> {
    let scene: Arc<dyn Scene> = loaded.world;
    let is_open = args.error.is_none() && args.spp.is_none();
    let time = args.time.or(is_open.then_some(TIME));
    let target = args.error.map(|error| ErrorTarget { error, confidence: args.confidence, scope: Scope::Picture });
    let cached = renderer.read(path);
    let before = cached.as_ref().map_or(RenderReport::default(), |cached| cached.report.clone());
    // A cached reference is never replaced by one with fewer samples.
    let samples = args.spp.map_or(u32::MAX.into(), u64::from).max(before.samples);
    let until = StopCondition { samples, time, target, patience: None };
    let progress = Progress::new(args.work.progress, &renderer.spec, samples, time).resumed(&before);
    let cached = renderer.render(&scene, cached, &until, &progress);
    progress.finish();
    if cached.report.samples > before.samples {
        renderer.write(path, &cached)?;
    }
    let accuracy = Accuracy::of(&cached.film, &cached.history, args.confidence);
    let attributes = attributes(&renderer.about, &cached.film, &accuracy, args.confidence, None);
    if cached.report.samples > 0 {
        let image = cached.film.image();
        args.output.iter().try_for_each(|path| output::write(path, &image, &attributes, &Tonemap::default()))?;
    }
    let files = args.output.iter().map(PathBuf::as_path).chain([path]);
    let samples = format!("{} spp, {} of them kept", cached.report.samples, before.samples);
    print_summary(&renderer.about, &samples, &cached.report, (&accuracy, &cached.history), args.confidence, files);
    if let Some(signal) = signals::caught() {
        return Err(Error::Interrupted(signal));
    }
    let outcome = target.map(|target| (target, target.outcome(&cached.history)));
    outcome.iter().for_each(|(target, outcome)| note(&format::outcome(target, *outcome)));
    Ok(if outcome.is_some_and(|(_, outcome)| outcome != Outcome::Met) { ExitCode::from(INCONCLUSIVE) } else { ExitCode::SUCCESS })
}
