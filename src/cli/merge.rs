//! `pt merge`: parts of a render to the whole.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::account::{attributes, summarise};
use super::outputs::{Takes, check_outputs, is_part};
use super::{args, note, plan};
use crate::error::{Error, Fault, Result};
use crate::film::MomentFilm;
use crate::measure::{Checkpoint, Course, RelativeError};
use crate::output;
use crate::part::{self, Part, Stored};

pub fn merge(args: &args::Merge) -> Result<ExitCode> {
    let inputs: Vec<&Path> = args.parts.iter().map(PathBuf::as_path).collect();
    check_outputs(&args.output, Takes::Both, &inputs, "is one of the parts")?;
    let (parts, pictures): (Vec<&PathBuf>, Vec<&PathBuf>) = args.output.iter().partition(|path| is_part(path));
    let sum = part::merge(args.parts.iter().map(|path| Stored::open(path)).collect::<Result<_>>()?)?;
    let (samples, course) = match sum.whole() {
        Ok(film) => (format!("{} spp", film.samples()), develop(args, &pictures, &sum, film)?),
        Err(_) if pictures.is_empty() => (format!("samples {}", plan::ranges(&sum.runs())), Course::default()),
        Err(missing) => {
            let (start, end) = (missing.start, missing.end);
            let message = format!("samples {start}..{end} are missing; -o FILE.ptc adds what there is");
            return Err(Error::invalid(Fault::new(message).in_file(words(&inputs))));
        }
    };
    let films: Vec<&MomentFilm> = sum.films.iter().collect();
    parts.iter().try_for_each(|path| part::write(path, &sum.about, &films, &sum.report, &sum.course))?;
    summarise(&sum.about, &samples, &sum.report, &course, args.confidence, args.output.iter().map(PathBuf::as_path));
    Ok(ExitCode::SUCCESS)
}

/// Writes the pictures; returns what is known of their error.
fn develop(args: &args::Merge, pictures: &[&PathBuf], sum: &Part, film: &MomentFilm) -> Result<Course> {
    let course = course(film, sum);
    let attributes = attributes(&sum.about, film, course.last().and_then(|last| last.error), args.confidence, None);
    let image = film.image();
    pictures.iter().try_for_each(|path| output::write(path, &image, &attributes, &args.develop.tonemap(&image)))?;
    if image.pixels().flatten().all(|value| value == 0.0) {
        note("warning: the image is black");
    }
    Ok(course)
}

/// What the parts saw on their way, and the error of their sum.
fn course(film: &MomentFilm, sum: &Part) -> Course {
    let mut course = sum.course.clone();
    if course.last().is_none_or(|last| last.samples != film.samples()) {
        let seconds = sum.report.elapsed.as_secs_f64();
        course.checkpoints.push(Checkpoint { samples: film.samples(), seconds, error: RelativeError::of(film) });
    }
    course
}

fn words(paths: &[&Path]) -> String {
    match paths {
        [first, _, .., last] => format!("{} … {}", first.display(), last.display()),
        few => few.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "),
    }
}
