//! Facts about a picture, as attributes of its file and as the closing line.

use crate::film::{Film, MomentFilm};
use crate::measure::format::per_cent;
use crate::measure::{BiasEstimate, ErrorHistory, ErrorInterval, MostPixels, Refusal, format};
use crate::output::attributes::{REFUSED, SAMPLES};
use crate::output::{Attributes, Value};
use crate::part::About;
use crate::render::RenderReport;
use crate::sampler::ErrorEstimator;

/// What is stated about the error of a picture, in its file and in the closing line alike.
pub enum Accuracy {
    /// Nothing: there is no light, or the samples are a part of a picture.
    Unknown,
    /// The samples tell no error, for this reason.
    Untold(String),
    /// The error of the whole picture.
    Stated(ErrorInterval),
    /// Reason why the error of the whole picture cannot be stated, and a bound of that of most pixels if there is one.
    Refused(Refusal, Option<MostPixels>),
}

impl Accuracy {
    /// What can be stated after the last checkpoint.
    pub fn of(film: &MomentFilm, history: &ErrorHistory, confidence: f64) -> Accuracy {
        let Some(last) = history.last() else { return Accuracy::Unknown };
        match last.error.map(|error| error.stated(confidence)) {
            None if film.freedom() > 0.0 => Accuracy::Unknown,
            None => Accuracy::Untold(too_few_samples(film)),
            Some(Ok(error)) => Accuracy::Stated(error),
            Some(Err(refusal)) => Accuracy::Refused(refusal, MostPixels::of(film)),
        }
    }

    /// Attributes of the file.
    fn attributes(&self, confidence: f64) -> Vec<(&'static str, String)> {
        match self {
            Accuracy::Unknown | Accuracy::Untold(_) => vec![],
            Accuracy::Stated(error) => vec![
                ("pt/relativeError", error.value.to_string()),
                ("pt/relativeErrorLow", error.low.to_string()),
                ("pt/relativeErrorHigh", error.high.to_string()),
            ],
            Accuracy::Refused(refusal, most) => {
                let bound = |most: &MostPixels| {
                    [("pt/mostPixels", most.share.to_string()), ("pt/mostPixelsErrorAtLeast", most.at_least(confidence).to_string())]
                };
                [(REFUSED, refusal.to_string())].into_iter().chain(most.iter().flat_map(bound)).collect()
            }
        }
    }
}

/// Reason why a film tells no error.
fn too_few_samples(film: &MomentFilm) -> String {
    let needed = match film.error_estimator() {
        Some(ErrorEstimator::Scramblings(1)) => return "that takes two scramblings or more (--scramblings)".into(),
        Some(ErrorEstimator::Scramblings(k)) => 2 * k,
        Some(ErrorEstimator::Samples) | None => 2,
    };
    match film.spec().allocation.is_even() {
        true => format!("that takes {needed} samples per pixel"),
        false => format!("that takes {needed} samples in each pixel"),
    }
}

/// Attributes of a picture. They are functions of scene and settings only.
///
/// - `clamped`: bias of clamping
pub fn attributes(about: &About, film: &MomentFilm, accuracy: &Accuracy, confidence: f64, clamped: Option<&BiasEstimate>) -> Attributes {
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
    pairs.extend(accuracy.attributes(confidence));
    if let Some(BiasEstimate { setting, share, .. }) = clamped {
        pairs.extend([("pt/bias", setting.clone()), ("pt/biasRemoved", share.to_string())]);
    }
    let set = film.sample_set();
    if !set.missing(film.range().end).is_empty() {
        pairs.push((SAMPLES, set.to_string()));
    }
    let samples = ("samplesPerPixel".to_owned(), Value::Integer(film.mean_samples().round() as i32));
    let own = pairs.into_iter().map(|(name, value)| (name.to_owned(), value.into()));
    own.chain([samples]).chain(about.view.iter().cloned()).collect()
}

/// Start of the closing line: `512×512 · nee · 64 spp · 3.1 s`.
///
/// - `samples`: `64 spp`, or a range of samples
pub fn rendered(about: &About, samples: &str, report: &RenderReport) -> String {
    let size = about.crop.size();
    let time = format::duration(report.elapsed.as_secs_f64());
    let integrator = about.identity.fact("/integrator/type").unwrap_or_default();
    format!("{}×{} · {integrator} · {samples} · {time}", size.x, size.y)
}

/// Number of samples: `64 spp`, or `64.3 spp (8 to 512)`.
pub fn samples(film: &MomentFilm) -> String {
    let (mean, allocation) = (film.mean_samples(), &film.spec().allocation);
    let [fewest, most] = allocation.range().map(|samples| samples * film.samples());
    if allocation.is_even() { format!("{mean} spp") } else { format!("{mean:.1} spp ({fewest} to {most})") }
}

/// Which samples there are: `samples 0..16`, or `rounds 0..4` where a pixel takes one or more samples in each round.
pub fn part_samples(film: &MomentFilm) -> String {
    format!("{} {}", film.spec().allocation.unit(), film.sample_set())
}

/// Error as a part of the closing line, as far as it is known:
///
/// ```text
///  · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s (12 s–16 s)
///  · relative error cannot be established (heavy tail); for 99.9 % of the pixels at least 2.9 %; 2 pixels hold 52 % of the noise
/// ```
pub fn accuracy(accuracy: &Accuracy, history: &ErrorHistory, confidence: f64) -> String {
    match accuracy {
        Accuracy::Unknown => String::new(),
        Accuracy::Untold(why) => format!(" · no error is told: {why}"),
        Accuracy::Stated(error) => {
            let price = format::next_price(history, confidence).map_or(String::new(), |price| format!(" · {price}"));
            format!(" · relative error {}{price}", format::error(error, confidence))
        }
        Accuracy::Refused(refusal, most) => {
            let most = most.as_ref().map_or(String::new(), |most| {
                let pixels = if most.noisiest == 1 { "1 pixel holds".into() } else { format!("{} pixels hold", most.noisiest) };
                let (share, error, noise) = (most.share, per_cent(most.at_least(confidence)), per_cent(most.noise));
                format!("; for {} % of the pixels at least {error} %; {pixels} {noise} % of the noise", (1e3 * share).round() / 10.0)
            });
            let (short, _) = refusal.words();
            format!(" · relative error cannot be established ({short}){most}")
        }
    }
}
