//! Facts about a picture, as attributes of its file and as the closing line.

use std::path::Path;

use crate::film::{Film, MomentFilm};
use crate::measure::{BiasEstimate, ErrorHistory, RelativeError, format};
use crate::output::{Attributes, Value};
use crate::part::About;
use crate::render::RenderReport;

use super::{note, print_stderr, signals};

/// Attributes of a picture. They are functions of scene and settings only.
///
/// - `clamped`: bias of clamping
pub fn attributes(
    about: &About,
    film: &MomentFilm,
    error: Option<RelativeError>,
    confidence: f64,
    clamped: Option<&BiasEstimate>,
) -> Attributes {
    let fact = |pointer: &str| about.identity.fact(pointer).unwrap_or_default();
    let mut pairs = vec![
        ("pt/version", fact("/version")),
        ("pt/integrator", fact("/integrator/type")),
        ("pt/sampler", fact("/sampler/type")),
        ("pt/seed", fact("/sampler/seed")),
        ("pt/scramblings", about.error_estimator.sequences().to_string()),
        ("pt/spp", film.mean_samples().to_string()),
        ("pt/confidence", confidence.to_string()),
        ("pt/standardErrorFreedom", film.freedom().to_string()),
        ("pt/sceneHash", about.identity.hash().to_string()),
    ];
    if let Some(error) = error {
        let [low, high] = error.interval(confidence);
        pairs.extend(
            [("pt/relativeError", error.value), ("pt/relativeErrorLow", low), ("pt/relativeErrorHigh", high)]
                .map(|(k, v)| (k, v.to_string())),
        );
    }
    if let Some(BiasEstimate { setting, share, .. }) = clamped {
        pairs.extend([("pt/bias", setting.clone()), ("pt/biasRemoved", share.to_string())]);
    }
    let samples = ("samplesPerPixel".to_owned(), Value::Integer(film.mean_samples().round() as i32));
    let own = pairs.into_iter().map(|(name, value)| (name.to_owned(), value.into()));
    own.chain([samples]).chain(about.view.iter().cloned()).collect()
}

/// Prints the closing line: `512×512 · nee · 64 spp · 3.1 s · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s ·
/// x.exr`
///
/// - `samples`: `64 spp`, or a range of samples
/// - `history`: history of the error; without checkpoints no error is printed
pub fn print_summary<'p>(
    about: &About,
    samples: &str,
    report: &RenderReport,
    history: &ErrorHistory,
    confidence: f64,
    files: impl Iterator<Item = &'p Path>,
) {
    let size = about.crop.size();
    let files = files.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let time = format::duration(report.elapsed.as_secs_f64());
    let integrator = about.identity.fact("/integrator/type").unwrap_or_default();
    let what = format!("{}×{} · {integrator} · {samples} · {time}", size.x, size.y);
    match (report.samples, report.cancelled) {
        (0, _) => {
            let why = if signals::caught().is_some() { "interrupted" } else { "out of time" };
            print_stderr(&format!("{what} · {why} before each pixel had a sample: nothing written"));
        }
        (_, true) => note(&format!("{what} · interrupted{} · {files}", accuracy(history, confidence))),
        (_, false) => note(&format!("{what}{} · {files}", accuracy(history, confidence))),
    }
    if let Some(first) = report.first_invalid.first() {
        let (x, y) = first.pixel;
        note(&format!("warning: {} invalid samples counted as black; the first: --pixel {x},{y} --sample {}", report.invalid, first.index));
    }
}

/// Number of samples: `64 spp`, or `64.3 spp (8 to 512)`.
pub fn samples(film: &MomentFilm) -> String {
    let (mean, allocation) = (film.mean_samples(), &film.spec().allocation);
    let [fewest, most] = allocation.range().map(|samples| samples * film.samples());
    if allocation.is_even() { format!("{mean} spp") } else { format!("{mean:.1} spp ({fewest} to {most})") }
}

/// Error as a part of the closing line: ` · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s`, as far as it is
/// known.
fn accuracy(history: &ErrorHistory, confidence: f64) -> String {
    match history.last().and_then(|last| last.error) {
        None => String::new(),
        Some(error) if !error.is_established() => " · relative error cannot be established (heavy tail)".into(),
        Some(error) => {
            let price = format::next_price(history, confidence).map_or(String::new(), |price| format!(" · {price}"));
            format!(" · relative error {}{price}", format::error(&error, confidence))
        }
    }
}
