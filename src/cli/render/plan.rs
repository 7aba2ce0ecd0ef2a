//! Plan of a render: what the command line asks for, checked once before any work.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use glam::UVec2;

use super::args::{RenderArgs, Shard};
use crate::cli::load::Loaded;
use crate::cli::outputs::{OutputKinds, check_outputs, is_part, is_pipe, write_part};
use crate::cli::pilot::{PricedIntegrator, selected_integrators};
use crate::cli::progress::{Progress, ProgressForm};
use crate::cli::quote::quoted;
use crate::cli::stats::TextOrJson;
use crate::cli::tone_mapping::ToneMapping;
use crate::cli::watch::PageAddress;
use crate::cli::{is_quiet, note};
use crate::error::{Error, Fault, Result};
use crate::film::{Crop, FilmSpec, MomentFilm, SampleSet};
use crate::integrator::Entry;
use crate::measure::{ErrorHistory, ErrorTarget, Scope, StopCondition, adaptive};
use crate::output::attributes::{SAMPLES, Value, of_camera};
use crate::output::{self, Format};
use crate::part::{self, About, Job, Part, Stored};
use crate::render::{self, RenderReport, Settings};
use crate::sampler::{ErrorEstimator, SamplerSpec};
use crate::scene::Scene;

/// Plan of a render. Everything after it is made reads the plan, not the arguments.
pub struct RenderPlan {
    /// Samples of every pixel that the run takes; with `--adaptive` rounds of them.
    pub samples: Range<u64>,
    /// Whether these samples are a part of the picture, by `--shard` or `--samples`.
    pub is_part: bool,
    /// Number of the part, if it was given by `--shard`.
    shard: Option<Shard>,
    /// Facts about the picture.
    pub about: About,
    /// Output files for pictures.
    pub pictures: Vec<PathBuf>,
    /// Output files for parts.
    pub parts: Vec<PathBuf>,
    /// File for the state, written from time to time and at the end.
    pub checkpoint: Option<PathBuf>,
    /// Time between checkpoints, if there are any.
    pub checkpoint_interval: Option<Duration>,
    /// Condition at which the render stops.
    pub until: StopCondition,
    /// Whether the numbers of samples of the pixels follow from a pilot.
    pub adaptive: bool,
    /// Limit of the radiance of indirect contributions.
    pub clamp: Option<f32>,
    /// Confidence of errors and targets.
    pub confidence: f64,
    /// Price list to print before the render.
    pub price_list: Option<PriceList>,
    /// Conversion to 8-bit pictures.
    pub tone_mapping: ToneMapping,
    /// Form of the progress.
    pub progress: ProgressForm,
    /// Address of a viewer.
    pub display_server: Option<String>,
    /// Address of the page, if one is served.
    pub page: Option<PageAddress>,
    /// Reports to print after the render.
    pub reports: Reports,
    resume: Option<Resume>,
}

/// A saved state from which the render goes on.
struct Resume {
    path: PathBuf,
    /// Whether the user named the file. Otherwise it need not exist.
    is_given: bool,
}

/// Integrators of the price list, and the render time of each.
pub struct PriceList {
    /// Render time of each integrator.
    pub time: Duration,
    /// Integrators of the list.
    pub integrators: Vec<PricedIntegrator>,
}

/// Reports to print after the render.
pub struct Reports {
    /// Number of outliers to list, if they are requested.
    pub outliers: Option<u32>,
    /// Whether all biases are requested.
    pub bias: bool,
    /// Whether to print more.
    pub is_verbose: bool,
    /// Format of the statistics, if they are requested.
    pub stats: Option<TextOrJson>,
    /// Start of the command that replays a sample of this render.
    pub replay: String,
}

/// State before the first sample of this run.
pub struct Start {
    /// Film with the samples so far.
    pub film: MomentFilm,
    /// Index of the next sample.
    pub next: u64,
    /// Report so far.
    pub report: RenderReport,
    /// History so far.
    pub history: ErrorHistory,
}

impl RenderPlan {
    /// Checks the arguments and makes a plan.
    ///
    /// # Errors
    /// `Usage` for samples that do not exist and for outputs that cannot be written; `Io`.
    pub fn new(args: &RenderArgs, loaded: &Loaded, tables: &[&[Entry]]) -> Result<RenderPlan> {
        let samples = samples(args, &loaded.sampler)?;
        let is_part = args.shard.is_some() || args.samples.is_some();
        let outputs = match (&args.output[..], is_part) {
            // How many rounds an adaptive render has is not known yet.
            ([], true) if let (true, Some(Shard { index, count })) = (args.adaptive, args.shard) => {
                vec![format!("{}.{index}-of-{count}.ptc", loaded.stem).into()]
            }
            ([], true) => vec![format!("{}.{}-{}.ptc", loaded.stem, samples.start, samples.end).into()],
            ([], false) => {
                let stem = if args.clock_name { by_the_clock() } else { loaded.stem.clone() };
                vec![format!("{stem}.exr").into(), format!("{stem}.png").into()]
            }
            (given, _) => given.to_vec(),
        };
        let kinds = if is_part { OutputKinds::Parts } else { OutputKinds::Both };
        check_outputs(&outputs, kinds, &[args.scene.path()?], "is the scene file")?;
        refuse_for_stdout(args, &outputs)?;
        let state = || outputs.iter().find(|path| self::is_part(path)).cloned().unwrap_or_else(|| outputs[0].with_extension("ptc"));
        let checkpoint = args.checkpoint.map(|_| state());
        if let Some(path) = &checkpoint {
            check_outputs(std::slice::from_ref(path), OutputKinds::Parts, &[args.scene.path()?], "is the scene file")?;
        }
        let resume = args.resume.as_ref().map(|given| Resume { path: given.clone().unwrap_or_else(state), is_given: given.is_some() });
        if let Some(path) = outputs.iter().find(|path| self::is_part(path)) {
            if args.adaptive && args.spp().is_none() && (args.time.is_some() || args.target.is_some()) {
                let path = path.display();
                return Err(Error::Usage(format!("{path}: a part of an adaptive render has a planned number of samples (--spp)")));
            }
            let scope = args.region.is_some() || args.tiles.is_some();
            let kept = [(args.clamp.is_some(), "what clamping took"), (scope, "the error of a region or of tiles")];
            let lost = kept.into_iter().find_map(|(is_asked, what)| is_asked.then_some(what));
            if let Some(lost) = lost {
                return Err(Error::Usage(format!("{}: a part does not keep {lost}", path.display())));
            }
        }
        if let Some(flag) =
            [("--target", args.target.is_some()), ("--pilot", args.pilot.is_some())].into_iter().find_map(|(f, g)| g.then_some(f))
            && loaded.sampler.error_estimator() == ErrorEstimator::Scramblings(1)
        {
            return Err(Error::Usage(format!("{flag}: a single scrambling gives no error estimate; use --scramblings 2 or more")));
        }
        let job = Job { command: words(args, loaded)?, samples: loaded.sampler.spp };
        let view = of_camera(&*loaded.world, &loaded.film);
        let about = About { job, ..About::new(loaded.identity()?, &loaded.film, loaded.sampler.error_estimator(), view) };
        let (parts, pictures): (Vec<PathBuf>, Vec<PathBuf>) = outputs.into_iter().partition(|path| self::is_part(path));
        if !loaded.film.layers.is_empty() && !pictures.iter().any(|path| Format::of(path) == Some(Format::Exr)) {
            note("warning: layers are written to .exr files, and none is asked for");
        }
        let integrators = selected_integrators(loaded, &args.integrators, tables)?;
        Ok(RenderPlan {
            until: until(args, samples.end, scope(args, &loaded.film, loaded.integrator.splats())?),
            samples,
            is_part,
            shard: args.shard,
            about,
            pictures,
            parts,
            checkpoint,
            checkpoint_interval: args.checkpoint,
            adaptive: args.adaptive,
            clamp: args.clamp,
            confidence: args.confidence,
            price_list: args.pilot.map(|time| PriceList { time, integrators }),
            tone_mapping: args.tone_mapping,
            progress: args.work.progress,
            display_server: args.display_server.clone(),
            page: args.page()?,
            reports: Reports {
                outliers: args.worst,
                bias: args.ledger,
                is_verbose: args.verbose,
                stats: args.stats,
                replay: replay_command(args, loaded)?,
            },
            resume,
        })
    }

    /// Distributes the samples over the pixels by a pilot, and returns the time that it took. The samples of the plan become rounds of the
    /// film's allocation. All parts of a picture of so many samples have the same pilot, and so the same allocation.
    ///
    /// # Errors
    /// `Usage` for more shards than rounds.
    pub fn allocate_samples(&mut self, loaded: &mut Loaded) -> Result<Duration> {
        let spp = if self.is_part { loaded.sampler.spp } else { self.until.samples };
        let progress = Progress::new(ProgressForm::None, &loaded.film, spp, None);
        let settings = Settings { wave_time: Some(render::SHORT_WAVE), ..Settings::new(loaded.sampler) };
        let world: Arc<dyn Scene> = loaded.world.clone();
        let (allocation, elapsed) = adaptive::pilot_allocation(&world, &*loaded.integrator, &loaded.film, &settings, spp, &progress);
        if allocation.is_even() && !is_quiet() {
            note("note: --adaptive: every pixel gets the same number of samples; uneven numbers would hardly lessen the error");
        }
        let rounds = ((spp as f64 / allocation.mean()).round() as u64).max(1);
        if !self.is_part {
            self.samples = 0..rounds;
        }
        if let Some(shard) = self.shard {
            let Shard { index, count } = shard;
            let few = || Error::Usage(format!("--shard {index}/{count}: there are only {rounds} rounds of samples to share out"));
            self.samples = shard.samples(rounds).ok_or_else(few)?;
        }
        self.until.samples = self.samples.end;
        self.until.patience = self.until.patience.map(|samples| (samples as f64 / allocation.mean()).round() as u64);
        self.about.allocation = allocation.clone();
        self.about.job.samples = rounds;
        loaded.film.allocation = allocation;
        Ok(elapsed)
    }

    /// Empty state, or the state that `--resume` found.
    ///
    /// # Errors
    /// `Invalid` for a state of another picture, or one without its first samples; `Usage` for one with more samples than
    /// requested.
    pub fn start(&self, film: MomentFilm) -> Result<Start> {
        let nothing = |film| Start { film, next: self.samples.start, report: RenderReport::default(), history: ErrorHistory::default() };
        let Some(Resume { path, is_given }) = &self.resume else { return Ok(nothing(film)) };
        if !is_given && !path.exists() {
            note(&format!("{}: not there, so this starts at the beginning", path.display()));
            return Ok(nothing(film));
        }
        // Another process may save to the same file.
        let stored = Stored::hold(path)?;
        let refused = |message: String| Error::invalid(Fault::new(message).in_file(path));
        if let Some(difference) = stored.about.difference(&self.about) {
            return Err(refused(format!("not of this picture: {difference}")));
        }
        let found = SampleSet::of(stored.ranges());
        let [run] = found.ranges() else { return Err(refused(format!("has gaps: it holds samples {found}"))) };
        if run.start != self.samples.start {
            return Err(refused(format!("begins at sample {}, expected {}", run.start, self.samples.start)));
        }
        if run.end > self.until.samples {
            let (path, end, asked) = (path.display(), run.end, self.until.samples);
            return Err(Error::Usage(format!("{path} holds {end} samples per pixel, more than the {asked} that are asked for")));
        }
        let next = run.end;
        let Part { film, report, history, .. } = part::merge(vec![stored])?;
        Ok(Start { film, next, report, history })
    }

    /// Writes the sums of all samples so far to every file that takes them.
    ///
    /// # Errors
    /// `Io`.
    pub fn write_parts(&self, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) -> Result<()> {
        let also = self.checkpoint.iter().filter(|path| !self.parts.contains(path));
        let write = |path: &PathBuf| write_part(path, &self.about, film, report, history);
        // All files are tried, so that a failure does not affect the others.
        self.parts.iter().chain(also).map(write).collect::<Vec<_>>().into_iter().collect()
    }

    /// Whether all pictures are there with all samples, and the first of them is of this scene.
    pub fn is_done(&self) -> bool {
        let is_whole = |path: &PathBuf| {
            let Ok((_, attributes)) = output::read(path) else { return false };
            let has = |name: &str, text: String| attributes.iter().any(|(known, value)| known == name && value.to_string() == text);
            let samples = |value: &Value| value.to_string().parse().is_ok_and(|samples: f64| samples >= self.until.samples as f64);
            let is_finished = attributes.iter().any(|(name, value)| name == "pt/spp" && samples(value));
            // What clamping took is no part of the identity, and neither are missing samples.
            let is_other = attributes.iter().any(|(name, _)| name == "pt/bias" || name == SAMPLES);
            !is_other && has("pt/sceneHash", self.about.identity.hash().to_string()) && is_finished
        };
        let first = self.pictures.iter().find(|path| Format::of(path) == Some(Format::Exr));
        !self.is_part && self.pictures.iter().all(|path| path.exists()) && first.is_some_and(is_whole)
    }

    /// Files that the run writes.
    pub fn written(&self) -> impl Iterator<Item = &Path> {
        self.pictures.iter().chain(&self.parts).map(PathBuf::as_path)
    }
}

/// Refuses options that need the samples of each pixel apart from those of all others.
///
/// # Errors
/// `Usage`.
pub(super) fn refuse_for_splats(args: &RenderArgs, loaded: &Loaded) -> Result<()> {
    let flag = [("--adaptive", args.adaptive), ("--clamp", args.clamp.is_some()), ("--worst", args.worst.is_some())];
    match flag.into_iter().find(|(_, is_given)| loaded.integrator.splats() && *is_given) {
        None => Ok(()),
        Some((flag, _)) => {
            let name = loaded.entry.name;
            Err(Error::Usage(format!("{flag}: not with {name}, whose paths bring light to all pixels and not to their own")))
        }
    }
}

/// Refuses what needs a file, or stdout for itself, where a part goes to stdout.
///
/// # Errors
/// `Usage`.
fn refuse_for_stdout(args: &RenderArgs, outputs: &[PathBuf]) -> Result<()> {
    let flags = [("--checkpoint", args.checkpoint.is_some()), ("--resume", args.resume == Some(None)), ("--stats", args.stats.is_some())];
    match flags.into_iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) if outputs.iter().any(|path| is_pipe(path)) => {
            Err(Error::Usage(format!("{flag}: not with -o -, where the part goes to stdout")))
        }
        _ => Ok(()),
    }
}

/// File name from the local time: `26_11_21-09_05_00`.
fn by_the_clock() -> String {
    jiff::Zoned::now().strftime("%y_%m_%d-%H_%M_%S").to_string()
}

/// Condition at which the render stops.
fn until(args: &RenderArgs, planned: u64, scope: Scope) -> StopCondition {
    let target = args.target.map(|error| ErrorTarget { error, confidence: args.confidence, scope });
    StopCondition::new(args.spp().map(|_| planned), planned, args.time, target)
}

/// Pixels for which the target holds.
///
/// # Errors
/// `Usage` for pixels that are not in the picture or too few, and for paths that bring light to all pixels.
fn scope(args: &RenderArgs, film: &FilmSpec, splats: bool) -> Result<Scope> {
    let scope = match (args.region, args.tiles) {
        (None, None) => return Ok(Scope::Picture),
        (Some([x0, x1, y0, y1]), _) => Scope::Region(Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) }),
        (None, Some(share)) => Scope::Tiles { share },
    };
    match scope.refusal(film.crop, splats, args.confidence) {
        Some(why) => Err(Error::Usage(format!("--{why}"))),
        None => Ok(scope),
    }
}

/// Start of the command that replays a sample.
fn replay_command(args: &RenderArgs, loaded: &Loaded) -> Result<String> {
    Ok(command(&replay_words(args, loaded)?))
}

/// A call of pt with these words, for a shell.
pub fn command(words: &[String]) -> String {
    ["pt".to_owned()].into_iter().chain(words.iter().map(|word| quoted(word))).collect::<Vec<_>>().join(" ")
}

/// Words of the command that renders the picture, after `pt`.
pub fn words(args: &RenderArgs, loaded: &Loaded) -> Result<Vec<String>> {
    let mut words = replay_words(args, loaded)?;
    let mut flag = |name: &str, value: Option<String>| words.extend(value.into_iter().flat_map(|value| [name.to_owned(), value]));
    flag("--crop", args.crop.map(|crop| crop.map(|side| side.to_string()).join(",")));
    flag("--aov", Some(args.aov.join(",")).filter(|names| !names.is_empty()));
    words.extend(args.adaptive.then(|| "--adaptive".to_owned()));
    Ok(words)
}

/// Scene and options that decide the samples.
fn replay_words(args: &RenderArgs, loaded: &Loaded) -> Result<Vec<String>> {
    let mut words = vec![args.scene.path()?.display().to_string()];
    let mut flag = |name: &str, value: Option<String>| words.extend(value.into_iter().flat_map(|value| [name.to_owned(), value]));
    args.scene.overrides.iter().for_each(|text| flag("-D", Some(text.clone())));
    // The names that `auto` has chosen.
    flag("--integrator", args.integrator.as_ref().map(|_| loaded.entry.name.to_owned()));
    flag("--size", args.size.map(|[width, height]| format!("{width}x{height}")));
    flag("--spp", args.spp().map(|spp| spp.to_string()));
    flag("--seed", args.seed.map(|seed| seed.to_string()));
    flag("--sampler", args.sampler.as_ref().map(|_| loaded.sampler.kind.name().to_owned()));
    flag("--scramblings", args.scramblings.map(|k| k.to_string()));
    flag("--clamp", args.clamp.map(|limit| limit.to_string()));
    words.extend(args.scene.flags());
    Ok(words)
}

/// Range of samples that the run takes.
fn samples(args: &RenderArgs, sampler: &SamplerSpec) -> Result<Range<u64>> {
    let spp = sampler.spp;
    if let Some(shard) = args.shard {
        let Shard { index, count } = shard;
        let few = || Error::Usage(format!("--shard {index}/{count}: there are only {spp} samples per pixel to share out"));
        return shard.samples(spp).ok_or_else(few);
    }
    let samples = args.samples.clone().unwrap_or(0..spp);
    if samples.end > sampler.end() {
        let (start, end) = (samples.start, samples.end);
        let name = sampler.kind.name();
        return Err(Error::Usage(format!("--samples {start}..{end}: {name} spreads {spp} samples (--spp) and has no more")));
    }
    Ok(samples)
}
