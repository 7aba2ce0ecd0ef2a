//! The closing line of a render.

use std::path::Path;

use super::{note, print_stderr, signals};
use crate::measure::ErrorHistory;
use crate::part::About;
use crate::render::RenderReport;
use crate::summary::{accuracy, rendered};

pub use crate::summary::{Accuracy, attributes, samples};

/// The closing line: `512×512 · nee · 64 spp · 3.1 s · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s
/// (12 s–16 s) · x.exr`
///
/// - `samples`: `64 spp`, or a range of samples
/// - `accuracy`: what is stated about the error
/// - `history`: history of the error, from which the price of a smaller one is extrapolated
pub fn closing_line<'p>(
    about: &About,
    samples: &str,
    report: &RenderReport,
    (stated, history): (&Accuracy, &ErrorHistory),
    confidence: f64,
    files: impl Iterator<Item = &'p Path>,
) -> String {
    let files = files.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let what = rendered(about, samples, report);
    match (report.samples, report.cancelled) {
        (0, _) => {
            let why = if signals::caught().is_some() { "interrupted" } else { "out of time" };
            format!("{what} · {why} before each pixel had a sample: nothing written")
        }
        (_, true) => format!("{what} · interrupted{} · {files}", accuracy(stated, history, confidence)),
        (_, false) => format!("{what}{} · {files}", accuracy(stated, history, confidence)),
    }
}

/// Prints the [closing line](closing_line), and a warning about invalid samples.
pub fn print_summary<'p>(
    about: &About,
    samples: &str,
    report: &RenderReport,
    stated: (&Accuracy, &ErrorHistory),
    confidence: f64,
    files: impl Iterator<Item = &'p Path>,
) {
    let line = closing_line(about, samples, report, stated, confidence, files);
    // That nothing is written is an answer, not a note.
    if report.samples == 0 {
        print_stderr(&line)
    } else {
        note(&line)
    }
    if let Some(first) = report.first_invalid.first() {
        let (x, y) = first.pixel;
        note(&format!("warning: {} invalid samples counted as black; the first: --pixel {x},{y} --sample {}", report.invalid, first.index));
    }
}
