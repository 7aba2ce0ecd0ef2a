//! Which samples a run of pt takes, where it goes on from, and where its results go.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::args;
use super::load::Loaded;
use super::note;
use super::outputs::{Takes, check_outputs, is_part};
use crate::error::{Error, Fault, Result};
use crate::film::MomentFilm;
use crate::measure::{Course, Target, Until};
use crate::output::attributes::of_camera;
use crate::part::{self, About, Part, Stored};
use crate::render::Report;
use crate::sampler::{Kind, SamplerSpec};

pub struct Plan {
    /// Samples of every pixel.
    pub samples: Range<u64>,
    /// Whether these are a part of the picture, by `--shard` or `--samples`.
    pub is_part: bool,
    pub about: About,
    pub pictures: Vec<PathBuf>,
    pub parts: Vec<PathBuf>,
    /// Where the state goes from time to time, and at the end.
    pub checkpoint: Option<PathBuf>,
    resume: Option<PathBuf>,
}

/// What is there before the first sample of this run.
pub struct Start {
    pub film: MomentFilm,
    /// Index of the sample that comes next.
    pub next: u64,
    pub report: Report,
    pub course: Course,
}

impl Plan {
    /// # Errors
    /// `Usage` for samples that are not there and for outputs that cannot be written; `Io`.
    pub fn new(args: &args::Render, loaded: &Loaded) -> Result<Plan> {
        let samples = samples(args, &loaded.built.sampler)?;
        let is_part = args.shard.is_some() || args.samples.is_some();
        let outputs = match (&args.output[..], is_part) {
            ([], true) => vec![format!("{}.{}-{}.ptc", loaded.stem, samples.start, samples.end).into()],
            ([], false) => {
                let stem = if args.clock_name { by_the_clock() } else { loaded.stem.clone() };
                vec![format!("{stem}.exr").into(), format!("{stem}.png").into()]
            }
            (given, _) => given.to_vec(),
        };
        let takes = if is_part { Takes::Parts } else { Takes::Both };
        check_outputs(&outputs, takes, &[args.scene.path()?], "is the scene file")?;
        let state = || outputs.iter().find(|path| self::is_part(path)).cloned().unwrap_or_else(|| outputs[0].with_extension("ptc"));
        let checkpoint = args.checkpoint.map(|_| state());
        if let Some(path) = &checkpoint {
            check_outputs(std::slice::from_ref(path), Takes::Parts, &[args.scene.path()?], "is the scene file")?;
        }
        let resume = match &args.resume {
            Some(None) if !state().exists() => {
                note(&format!("{}: not there, so this starts at the beginning", state().display()));
                None
            }
            Some(given) => Some(given.clone().unwrap_or_else(state)),
            None => None,
        };
        if let Some(path) = outputs.iter().find(|path| self::is_part(path)) {
            let lost = if args.adaptive { Some("how many samples each pixel has") } else { args.clamp.map(|_| "what clamping took") };
            if let Some(lost) = lost {
                return Err(Error::Usage(format!("{}: a part does not keep {lost}", path.display())));
            }
        }
        let built = &loaded.built;
        let about = About::new(loaded.identity()?, &built.film, built.sampler.spread(), of_camera(&built.world, &built.film));
        let (parts, pictures) = outputs.into_iter().partition(|path| self::is_part(path));
        Ok(Plan { samples, is_part, about, pictures, parts, checkpoint, resume })
    }

    /// When the render ends: where only a time or an accuracy is asked for, the samples that the scene plans are no limit.
    pub fn until(&self, args: &args::Render) -> Until {
        let free = (args.time.is_some() || args.target.is_some()) && args.spp().is_none();
        let samples = if free { u32::MAX.into() } else { self.samples.end };
        Until { samples, time: args.time, target: args.target.map(|error| Target { error, confidence: args.confidence }) }
    }

    /// Nothing, or what `--resume` found.
    ///
    /// # Errors
    /// `Invalid` for a state that is not of this picture, or not of its first samples; `Usage` for one that is beyond what is asked.
    pub fn start(&self, film: MomentFilm, until: &Until) -> Result<Start> {
        let nothing = |film| Start { film, next: self.samples.start, report: Report::default(), course: Course::default() };
        let Some(path) = &self.resume else { return Ok(nothing(film)) };
        let stored = Stored::open(path)?;
        let refused = |message: String| Error::invalid(Fault::new(message).in_file(path));
        if let Some(difference) = stored.about.difference(&self.about) {
            return Err(refused(format!("not of this picture: {difference}")));
        }
        let found = stored.ranges();
        let [run] = &found[..] else { return Err(refused(format!("has gaps: it holds samples {}", ranges(&found)))) };
        if run.start != self.samples.start {
            return Err(refused(format!("begins at sample {}, expected {}", run.start, self.samples.start)));
        }
        if run.end > until.samples {
            let (path, end, asked) = (path.display(), run.end, until.samples);
            return Err(Error::Usage(format!("{path} holds {end} samples per pixel, more than the {asked} that are asked for")));
        }
        let next = run.end;
        let Part { films, report, course, .. } = part::merge(vec![stored])?;
        let film = films.into_iter().next().unwrap_or(film);
        Ok(Start { film, next, report, course })
    }

    /// Writes the sums of all samples so far, wherever they are to go.
    ///
    /// # Errors
    /// `Io`.
    pub fn write_parts(&self, film: &MomentFilm, report: &Report, course: &Course) -> Result<()> {
        let also = self.checkpoint.iter().filter(|path| !self.parts.contains(path));
        let write = |path: &PathBuf| part::write(path, &self.about, &[film], report, course);
        // All are tried, so that one that fails does not take the others with it.
        self.parts.iter().chain(also).map(write).collect::<Vec<_>>().into_iter().collect()
    }

    /// All files that the run leaves behind.
    pub fn written(&self) -> impl Iterator<Item = &Path> {
        self.pictures.iter().chain(&self.parts).map(PathBuf::as_path)
    }
}

/// As the clock on the wall shows it: `26_11_21-09_05_00`.
fn by_the_clock() -> String {
    jiff::Zoned::now().strftime("%y_%m_%d-%H_%M_%S").to_string()
}

/// `0..16, 32..64`
pub fn ranges(runs: &[Range<u64>]) -> String {
    runs.iter().map(|run| format!("{}..{}", run.start, run.end)).collect::<Vec<_>>().join(", ")
}

fn samples(args: &args::Render, sampler: &SamplerSpec) -> Result<Range<u64>> {
    let spp = sampler.spp;
    if let Some(args::Shard { index, count }) = args.shard {
        if u64::from(count) > spp {
            return Err(Error::Usage(format!("--shard {index}/{count}: there are only {spp} samples per pixel to share out")));
        }
        let at = |i: u32| (u128::from(spp) * u128::from(i) / u128::from(count)) as u64;
        return Ok(at(index - 1)..at(index));
    }
    let samples = args.samples.clone().unwrap_or(0..spp);
    if samples.end > spp && sampler.kind == Kind::Stratified {
        let (start, end) = (samples.start, samples.end);
        return Err(Error::Usage(format!("--samples {start}..{end}: stratified spreads {spp} samples (--spp) and has no more")));
    }
    Ok(samples)
}
