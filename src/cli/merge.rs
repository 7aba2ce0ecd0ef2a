//! `pt merge`: adds parts of a render.

use std::io::stdin;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::note;
use super::outputs::{OutputKinds, check_outputs, is_part, is_pipe, write_part};
use super::parse::share;
use super::render::plan;
use super::summary::{Accuracy, attributes, part_samples, print_summary, samples};
use super::tone_mapping::ToneMapping;
use crate::error::{Error, Fault, Result};
use crate::film::{MomentFilm, SampleSet};
use crate::measure::ErrorHistory;
use crate::output;
use crate::part::{self, Job, Part, Stored};

#[derive(clap::Args, Debug)]
pub struct MergeArgs {
    /// Parts of one picture; `-` is one from stdin.
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// Output file: .exr, .hdr, .png, .ppm, .pfm, or .ptc, which may lack samples; `-` is a .ptc on stdout. May be repeated.
    #[arg(short, long, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
    /// Make the picture of the samples that there are, with its error bars, and tell which are missing and what makes them.
    #[arg(long)]
    pub partial: bool,
    /// Confidence of errors.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    #[command(flatten)]
    pub tone_mapping: ToneMapping,
}

/// Runs the command.
pub fn merge(args: &MergeArgs) -> Result<ExitCode> {
    let inputs: Vec<&Path> = args.parts.iter().map(PathBuf::as_path).collect();
    let files: Vec<&Path> = inputs.iter().copied().filter(|path| !is_pipe(path)).collect();
    if inputs.len() > files.len() + 1 {
        return Err(Error::Usage("-: given twice, but stdin is a single part".into()));
    }
    check_outputs(&args.output, OutputKinds::Both, &files, "is one of the parts")?;
    let (parts, pictures): (Vec<&PathBuf>, Vec<&PathBuf>) = args.output.iter().partition(|path| is_part(path));
    let mut stored: Vec<Stored> = vec![];
    for path in inputs.iter() {
        let mut part = read(path)?;
        if let Some(first) = stored.first() {
            part.share_allocation(first);
        }
        stored.push(part);
    }
    let sum = part::merge(stored)?;
    sum.copies.iter().for_each(|path| note(&format!("note: {}: counts once, another part has the same numbers", path.display())));
    let is_picture = args.partial || sum.whole().is_ok();
    let (taken, (accuracy, history)) = match sum.whole() {
        Ok(film) => (samples(film), write_pictures(args, &pictures, &sum, film)?),
        Err(_) if is_picture => {
            let film = &sum.film;
            (format!("{}, {}", samples(film), part_samples(film)), write_pictures(args, &pictures, &sum, film)?)
        }
        Err(_) if pictures.is_empty() => (part_samples(&sum.film), (Accuracy::Unknown, ErrorHistory::default())),
        Err(missing) => {
            let (unit, start, end) = (sum.about.allocation.unit(), missing.start, missing.end);
            let message =
                format!("{unit} {start}..{end} are missing; --partial makes a picture of the others, -o FILE.ptc adds what there is");
            return Err(Error::invalid(Fault::new(message).in_file(words(&inputs))));
        }
    };
    parts.iter().try_for_each(|path| write_part(path, &sum.about, &sum.film, &sum.report, &sum.history))?;
    print_summary(&sum.about, &taken, &sum.report, (&accuracy, &history), args.confidence, args.output.iter().map(PathBuf::as_path));
    if args.partial {
        note_missing(&sum);
    }
    Ok(ExitCode::SUCCESS)
}

/// Opens a part, or takes it from stdin.
fn read(path: &Path) -> Result<Stored> {
    if is_pipe(path) { Stored::receive(&mut stdin().lock(), "stdin") } else { Stored::open(path) }
}

/// Tells which samples are missing, and the commands that make them.
fn note_missing(sum: &Part) {
    let Job { command, samples } = &sum.about.job;
    let words = if command.is_empty() { &["SCENE".to_owned()] } else { &command[..] };
    let make = |gap: &Range<u64>| format!("\n  {} --samples {}..{}", plan::command(words), gap.start, gap.end);
    let gaps = SampleSet::of(sum.film.sample_set().missing(sum.film.range().end.max(*samples)));
    if !gaps.ranges().is_empty() {
        note(&format!(
            "warning: {} {gaps} are missing; to make them:{}",
            sum.about.allocation.unit(),
            gaps.ranges().iter().map(make).collect::<String>()
        ));
    }
}

/// Writes the pictures; returns the history of their error.
fn write_pictures(args: &MergeArgs, pictures: &[&PathBuf], sum: &Part, film: &MomentFilm) -> Result<(Accuracy, ErrorHistory)> {
    let history = sum.error_history();
    let accuracy = Accuracy::of(film, &history, args.confidence);
    let attributes = attributes(&sum.about, film, &accuracy, args.confidence, None);
    let image = film.image();
    pictures.iter().try_for_each(|path| output::write(path, &image, &attributes, &args.tone_mapping.tonemap(&image)))?;
    if image.pixels().flatten().all(|value| value == 0.0) {
        note("warning: the image is black");
    }
    Ok((accuracy, history))
}

fn words(paths: &[&Path]) -> String {
    match paths {
        [first, _, .., last] => format!("{} … {}", first.display(), last.display()),
        few => few.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "),
    }
}
