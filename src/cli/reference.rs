//! `pt reference`: a picture to measure others by, with its own error stated, kept and made better when more is asked.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use serde_json::json;

use super::account::{attributes, summarise};
use super::load::{Loaded, load};
use super::outputs::{Takes, check_outputs};
use super::progress::Progress;
use super::{INCONCLUSIVE, args, note, render, signals};
use crate::describe::Identity;
use crate::error::{Error, Result};
use crate::film::{FilmSpec, MomentFilm};
use crate::integrator::{self, Entry, Integrator};
use crate::measure::{Course, Outcome, Target, Until, Watcher, follow_on, words};
use crate::output::attributes::of_camera;
use crate::output::{self, Tonemap};
use crate::part::{self, About, Stored};
use crate::render::{Render, Report, SHORT_WAVE, Settings};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;

/// Where nothing else is asked for.
const TIME: Duration = Duration::from_secs(60);
/// So many scramblings tell an error by a standard deviation of 1/√14.
const SCRAMBLINGS: u32 = 8;

/// How references of a scene are rendered.
pub struct Judge {
    pub entry: Entry,
    integrator: Arc<dyn Integrator>,
    sampler: SamplerSpec,
    pub spec: FilmSpec,
    about: About,
}

/// A reference as far as it is.
pub struct Kept {
    pub film: MomentFilm,
    pub report: Report,
    pub course: Course,
}

impl Judge {
    /// - `name`: of the integrator; the most trusted one where none is named
    ///
    /// # Errors
    /// `Usage` for an unknown name, `Invalid` for options of the scene that it refuses.
    pub fn new(loaded: &Loaded, name: Option<&str>, tables: &[&[Entry]]) -> Result<Judge> {
        let (entry, integrator) = loaded.choose(tables, name.unwrap_or(integrator::DEFAULT))?;
        // Other random numbers than those of a picture of the scene's own seed.
        let seed = loaded.built.sampler.seed.wrapping_sub(1);
        let sampler = SamplerSpec { kind: Kind::Sobol, seed, spp: 0, scramblings: SCRAMBLINGS };
        let identity = Identity::new(&loaded.description, &loaded.built.contents, &entry)?;
        let identity = identity.with("sampler", json!({ "type": "sobol", "seed": seed, "scramblings": SCRAMBLINGS }));
        let spec = loaded.built.film.clone().without_layers();
        let about = About::new(identity, &spec, sampler.spread(), of_camera(&loaded.built.world, &spec));
        Ok(Judge { entry, integrator, sampler, about, spec })
    }

    /// Where it is kept.
    pub fn path(&self, cache: &Path) -> PathBuf {
        cache.join(format!("{}.ptc", self.about.identity.hash()))
    }

    /// What is kept; `None` where nothing is, or nothing of use, which is said.
    pub fn kept(&self, path: &Path) -> Option<Kept> {
        path.exists().then_some(())?;
        let usable = || -> Result<Kept> {
            let stored = Stored::open(path)?;
            if let Some(difference) = stored.about.difference(&self.about) {
                return Err(Error::Usage(format!("{}: {difference}", path.display())));
            }
            let sum = part::merge(vec![stored])?;
            let is_whole = sum.whole().is_ok();
            let film = sum.films.into_iter().next().filter(|_| is_whole);
            let film = film.ok_or_else(|| Error::Usage(format!("{}: has gaps", path.display())))?;
            Ok(Kept { film, report: sum.report, course: sum.course })
        };
        usable().map_err(|refusal| note(&format!("note: the kept reference is of no use: {refusal}"))).ok()
    }

    /// From nothing, or from what is kept, on.
    pub fn rendered(&self, scene: &Arc<dyn Scene>, kept: Option<Kept>, until: &Until, watcher: &dyn Watcher) -> Kept {
        let nothing = || Kept { film: MomentFilm::new(self.spec.clone()), report: Report::default(), course: Course::default() };
        let Kept { mut film, report, course } = kept.unwrap_or_else(nothing);
        let settings = Settings { wave_time: Some(SHORT_WAVE), ..Settings::new(self.sampler) };
        let render = Render::new(scene.clone(), &*self.integrator, &self.spec, &settings);
        let mut render = render.resumed(film.samples(), report);
        let course = follow_on(course, &mut render, &mut film, until, watcher);
        Kept { film, report: render.report().clone(), course }
    }

    /// # Errors
    /// `Io`.
    pub fn keep(&self, path: &Path, kept: &Kept) -> Result<()> {
        let folder = output::folder(path);
        std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        part::write(path, &self.about, &[&kept.film], &kept.report, &kept.course)
    }
}

/// Where references are kept: in the folder that is named, or where programs of this user keep such things.
///
/// # Errors
/// `Usage` where there is no telling.
pub fn cache(named: Option<&Path>) -> Result<PathBuf> {
    let of = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || of("XDG_CACHE_HOME").or_else(|| Some(of("HOME")?.join(".cache"))).map(|folder| folder.join("pt"));
    let unknown = || Error::Usage("nowhere to keep references: say --cache FOLDER or set PT_CACHE".into());
    named.map(Path::to_owned).or_else(usual).ok_or_else(unknown)
}

pub fn reference(args: &args::Reference, tables: &[&[Entry]]) -> Result<ExitCode> {
    let resized = args.size.map(render::resized).unwrap_or_default();
    let loaded = load(&args.scene, &resized, None, tables)?;
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    check_outputs(&args.output, Takes::Pictures, &[args.scene.path()?], "is the scene file")?;
    let judge = Judge::new(&loaded, args.integrator.as_deref(), tables)?;
    let path = judge.path(&cache(args.cache.as_deref())?);
    signals::catch()?;
    render::pool(args.work.threads)?.install(|| made(args, loaded, &judge, &path))
}

fn made(args: &args::Reference, loaded: Loaded, judge: &Judge, path: &Path) -> Result<ExitCode> {
    let scene: Arc<dyn Scene> = Arc::new(loaded.built.world);
    let is_open = args.error.is_none() && args.spp.is_none();
    let time = args.time.or(is_open.then_some(TIME));
    let target = args.error.map(|error| Target { error, confidence: args.confidence });
    let kept = judge.kept(path);
    let before = kept.as_ref().map_or(Report::default(), |kept| kept.report.clone());
    // A reference is never made worse than it is.
    let samples = args.spp.map_or(u32::MAX.into(), u64::from).max(before.samples);
    let until = Until { samples, time, target };
    let progress = Progress::new(args.work.progress, &judge.spec, samples, time).resumed(&before);
    let kept = judge.rendered(&scene, kept, &until, &progress);
    progress.finish();
    if kept.report.samples > before.samples {
        judge.keep(path, &kept)?;
    }
    let error = kept.course.last().and_then(|last| last.error);
    let attributes = attributes(&judge.about, &kept.film, error, args.confidence, None);
    if kept.report.samples > 0 {
        let image = kept.film.image();
        args.output.iter().try_for_each(|path| output::write(path, &image, &attributes, &Tonemap::default()))?;
    }
    let files = args.output.iter().map(PathBuf::as_path).chain([path]);
    let samples = format!("{} spp, {} of them kept", kept.report.samples, before.samples);
    summarise(&judge.about, &samples, &kept.report, &kept.course, args.confidence, files);
    if let Some(signal) = signals::caught() {
        return Err(Error::Interrupted(signal));
    }
    let outcome = target.map(|target| (target, target.outcome(&kept.course)));
    outcome.iter().for_each(|(target, outcome)| note(&words::outcome(target, *outcome)));
    Ok(if outcome.is_some_and(|(_, outcome)| outcome != Outcome::Met) { ExitCode::from(INCONCLUSIVE) } else { ExitCode::SUCCESS })
}
