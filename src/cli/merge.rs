//! `pt merge`: adds parts of a render.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::note;
use super::outputs::{OutputKinds, check_outputs, is_part};
use super::parse::share;
use super::render::plan;
use super::summary::{Accuracy, attributes, print_summary};
use super::tone_mapping::ToneMapping;
use crate::error::{Error, Fault, Result};
use crate::film::MomentFilm;
use crate::measure::{Checkpoint, ErrorHistory, RelativeError};
use crate::output;
use crate::part::{self, Part, Stored};

#[derive(clap::Args, Debug)]
pub struct MergeArgs {
    /// Parts of one picture.
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// Output file: .exr, .hdr, .png, .ppm, .pfm, or .ptc, which may lack samples. May be repeated.
    #[arg(short, long, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
    /// Confidence of errors.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    #[command(flatten)]
    pub tone_mapping: ToneMapping,
}

/// Runs the command.
pub fn merge(args: &MergeArgs) -> Result<ExitCode> {
    let inputs: Vec<&Path> = args.parts.iter().map(PathBuf::as_path).collect();
    check_outputs(&args.output, OutputKinds::Both, &inputs, "is one of the parts")?;
    let (parts, pictures): (Vec<&PathBuf>, Vec<&PathBuf>) = args.output.iter().partition(|path| is_part(path));
    let sum = part::merge(args.parts.iter().map(|path| Stored::open(path)).collect::<Result<_>>()?)?;
    let (samples, (accuracy, history)) = match sum.whole() {
        Ok(film) => (format!("{} spp", film.samples()), write_pictures(args, &pictures, &sum, film)?),
        Err(_) if pictures.is_empty() => (format!("samples {}", plan::ranges(&sum.runs())), (Accuracy::Unknown, ErrorHistory::default())),
        Err(missing) => {
            let (start, end) = (missing.start, missing.end);
            let message = format!("samples {start}..{end} are missing; -o FILE.ptc adds what there is");
            return Err(Error::invalid(Fault::new(message).in_file(words(&inputs))));
        }
    };
    let films: Vec<&MomentFilm> = sum.films.iter().collect();
    parts.iter().try_for_each(|path| part::write(path, &sum.about, &films, &sum.report, &sum.history))?;
    print_summary(&sum.about, &samples, &sum.report, (&accuracy, &history), args.confidence, args.output.iter().map(PathBuf::as_path));
    Ok(ExitCode::SUCCESS)
}

/// Writes the pictures; returns the history of their error.
fn write_pictures(args: &MergeArgs, pictures: &[&PathBuf], sum: &Part, film: &MomentFilm) -> Result<(Accuracy, ErrorHistory)> {
    let history = history(film, sum);
    let accuracy = Accuracy::of(film, &history, args.confidence);
    let attributes = attributes(&sum.about, film, &accuracy, args.confidence, None);
    let image = film.image();
    pictures.iter().try_for_each(|path| output::write(path, &image, &attributes, &args.tone_mapping.tonemap(&image)))?;
    if image.pixels().flatten().all(|value| value == 0.0) {
        note("warning: the image is black");
    }
    Ok((accuracy, history))
}

/// History of the parts, with the error of their sum.
fn history(film: &MomentFilm, sum: &Part) -> ErrorHistory {
    let mut history = sum.history.clone();
    if history.last().is_none_or(|last| last.samples != film.samples()) {
        let seconds = sum.report.elapsed.as_secs_f64();
        history.checkpoints.push(Checkpoint { samples: film.samples(), seconds, error: RelativeError::of(film) });
    }
    history
}

fn words(paths: &[&Path]) -> String {
    match paths {
        [first, _, .., last] => format!("{} … {}", first.display(), last.display()),
        few => few.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "),
    }
}
