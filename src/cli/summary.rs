//! The closing line of a render.

use std::path::Path;

use super::{note, print_stderr, signals};
use crate::film::MomentFilm;
use crate::measure::format::{self, per_cent};
use crate::measure::{ErrorHistory, Refusal, Scope, tile_errors, worst_tile};
use crate::part::About;
use crate::render::RenderReport;
use crate::summary::{accuracy, rendered};

pub use crate::summary::{Accuracy, attributes, part_samples, samples};

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

/// What the pixels that a target asks for have in the end; nothing for the whole picture, whose error is in the closing line.
///
/// ```text
/// region 10,20,10,20 · relative error 0.93 % (95 %: 0.9–0.97) · 0.3 % would take about 14 s (12 s–16 s)
/// 95 % of the 300 tiles · relative error at most 1.9 % (95 % sure)
/// the worst tile, --crop 48,64,0,16 · relative error 4.1 % (95 %: 3.5–4.9)
/// ```
///
/// - `history`: history of the error of these pixels
pub fn scope_lines(film: &MomentFilm, scope: &Scope, history: &ErrorHistory, confidence: f64) -> Vec<String> {
    match scope {
        Scope::Picture => vec![],
        Scope::Region(crop) => {
            let told = match Accuracy::of(&film.cropped(*crop), history, confidence) {
                Accuracy::Unknown => " · black so far: no relative error".into(),
                stated => accuracy(&stated, history, confidence),
            };
            vec![format!("region {crop}{told}")]
        }
        Scope::Tiles { share } => {
            let Some(tiles) = tile_errors(film) else { return vec![] };
            let refused = |refusal: Refusal| format!("cannot be established ({})", refusal.words().0);
            let bound = scope.error(film).map(|error| error.below(confidence));
            let most = bound.map(|bound| {
                let bound = bound.map(|bound| format!("at most {} % ({} % sure)", per_cent(bound), per_cent(confidence)));
                let (share, bound) = (format::exact_per_cent(*share), bound.unwrap_or_else(refused));
                format!("{share} % of the {} tiles · relative error {bound}", tiles.len())
            });
            let worst = worst_tile(&tiles, confidence).map(|tile| {
                let error = tile.error.stated(confidence).map(|error| format::error(&error, confidence)).unwrap_or_else(refused);
                format!("the worst tile, --crop {} · relative error {error}", tile.crop)
            });
            most.into_iter().chain(worst).collect()
        }
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
