//! What a picture says about itself, in its file and in one line.

use std::path::Path;

use crate::film::{Film, MomentFilm};
use crate::measure::{Course, RelativeError, Removed, words};
use crate::output::{Attributes, Value};
use crate::part::About;
use crate::render::Report;

use super::{insist, note, signals};

/// Functions of scene and settings alone.
///
/// - `clamped`: what that took
pub fn attributes(
    about: &About,
    film: &MomentFilm,
    error: Option<RelativeError>,
    confidence: f64,
    clamped: Option<&Removed>,
) -> Attributes {
    let fact = |pointer: &str| about.identity.fact(pointer).unwrap_or_default();
    let mut pairs = vec![
        ("pt/version", fact("/version")),
        ("pt/integrator", fact("/integrator/type")),
        ("pt/sampler", fact("/sampler/type")),
        ("pt/seed", fact("/sampler/seed")),
        ("pt/scramblings", about.spread.sequences().to_string()),
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
    if let Some(Removed { setting, share, .. }) = clamped {
        pairs.extend([("pt/bias", setting.clone()), ("pt/biasRemoved", share.to_string())]);
    }
    let samples = ("samplesPerPixel".to_owned(), Value::Integer(film.mean_samples().round() as i32));
    let own = pairs.into_iter().map(|(name, value)| (name.to_owned(), value.into()));
    own.chain([samples]).chain(about.view.iter().cloned()).collect()
}

/// `512×512 · nee · 64 spp · 3.1 s · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s · x.exr`
///
/// - `samples`: `64 spp`, or which ones they are
/// - `course`: of a picture; without checkpoints nothing is said of an error
pub fn summarise<'p>(
    about: &About,
    samples: &str,
    report: &Report,
    course: &Course,
    confidence: f64,
    files: impl Iterator<Item = &'p Path>,
) {
    let size = about.crop.size();
    let files = files.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let time = words::duration(report.elapsed.as_secs_f64());
    let integrator = about.identity.fact("/integrator/type").unwrap_or_default();
    let what = format!("{}×{} · {integrator} · {samples} · {time}", size.x, size.y);
    match (report.samples, report.cancelled) {
        (0, _) => {
            let why = if signals::caught().is_some() { "interrupted" } else { "out of time" };
            insist(&format!("{what} · {why} before each pixel had a sample: nothing written"));
        }
        (_, true) => note(&format!("{what} · interrupted{} · {files}", accuracy(course, confidence))),
        (_, false) => note(&format!("{what}{} · {files}", accuracy(course, confidence))),
    }
    if let Some(first) = report.first_invalid.first() {
        let (x, y) = first.pixel;
        note(&format!("warning: {} invalid samples counted as black; the first: --pixel {x},{y} --sample {}", report.invalid, first.index));
    }
}

/// `64 spp`, or `64.3 spp (8 to 512)`.
pub fn samples(film: &MomentFilm) -> String {
    let (mean, allocation) = (film.mean_samples(), &film.spec().allocation);
    let [fewest, most] = allocation.range().map(|samples| samples * film.samples());
    if allocation.is_even() { format!("{mean} spp") } else { format!("{mean:.1} spp ({fewest} to {most})") }
}

/// ` · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s`, as far as it is known.
fn accuracy(course: &Course, confidence: f64) -> String {
    match course.last().and_then(|last| last.error) {
        None => String::new(),
        Some(error) if !error.is_established() => " · relative error cannot be established (heavy tail)".into(),
        Some(error) => {
            let price = words::next_price(course, confidence).map_or(String::new(), |price| format!(" · {price}"));
            format!(" · relative error {}{price}", words::error(&error, confidence))
        }
    }
}
