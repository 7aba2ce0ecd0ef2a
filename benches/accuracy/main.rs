//! Accuracy of error bars and of predicted costs: the tables of docs/accuracy.md.
//!
//! `cargo bench --bench accuracy [-- TABLES] [SEEDS] [SCENES] [FILE.csv]`: the default is all tables, 100 seeds and the scenes of each
//! table. Most have three samplers.
//!
//! - coverage: how often the stated 95 % interval contains the true relative error
//! - large: the same for pictures of 512 × 512 pixels, whose intervals are narrow
//! - pixels: how many pixels are as far from the truth as their standard errors say
//! - curves: how the error of long renders falls, as CSV. It takes longest, and only when it is named
//! - prices: how often the interval of the number of samples that a smaller error takes contains the number that it then takes, which comes
//!   from FILE.csv, the output of `curves`, or from long renders
//! - targets: how often the true error is below a target that was met, and what was spent to know it
//! - auto: what the choice by `--integrator auto --sampler auto` costs beside the best one
//! - adaptive: relMSE, and time × relMSE, of adaptive samples over those of as many uniform ones

mod adaptive;
mod auto;
mod coverage;
mod curves;
mod pixels;
mod prices;
mod share;
#[path = "../subject/mod.rs"]
mod subject;
mod targets;

use pt::film::{FilmSpec, Image, MomentFilm};
use pt::measure::{Distance, ErrorHistory, StopCondition, render_until};
use pt::render::{Render, Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use subject::Subject;

/// What the command line asks of a table.
struct Request<'a> {
    scenes: &'a [&'a str],
    seeds: u64,
    /// File of error curves, as `curves` prints them.
    curves: Option<&'a str>,
}

/// A table: its name, its scenes, and the function that prints it for some of them.
type Table = (&'static str, &'static [&'static str], fn(&Request) -> pt::Result<()>);

const TABLES: [Table; 8] = [
    ("coverage", &coverage::SCENES, coverage::print),
    ("large", &coverage::LARGE_SCENES, coverage::print_large),
    ("pixels", &pixels::SCENES, pixels::print),
    ("curves", &curves::SCENES, curves::print),
    ("prices", &curves::SCENES, prices::print),
    ("targets", &targets::SCENES, targets::print),
    ("adaptive", &adaptive::SCENES, adaptive::print),
    ("auto", &auto::SCENES, auto::print),
];

const SAMPLERS: [Kind; 3] = [Kind::Independent, Kind::Halton, Kind::Sobol];
/// Number of samples of a reference picture.
const REFERENCE: u64 = 1 << 14;

fn main() -> pt::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let has = |name: &str| words.iter().any(|word| word == name);
    let seeds: u64 = words.iter().filter_map(|word| word.parse().ok()).next().unwrap_or(100);
    let curves = words.iter().map(String::as_str).find(|word| word.ends_with(".csv"));
    let is_table = |word: &str| TABLES.iter().any(|(name, ..)| *name == word);
    let is_scene = |word: &&str| !(is_table(word) || word.ends_with(".csv") || word.parse::<u64>().is_ok());
    let named: Vec<&str> = words.iter().map(String::as_str).filter(is_scene).collect();
    let any = words.iter().any(|word| is_table(word));
    // Without names all tables but `curves`, which takes longest and is input for `prices`.
    for (_, scenes, print) in TABLES.iter().filter(|(name, ..)| if any { has(name) } else { *name != "curves" }) {
        print(&Request { scenes: if named.is_empty() { scenes } else { &named }, seeds, curves })?;
    }
    Ok(())
}

/// A scene in a small size, on which many renders take little time.
fn small(name: &str) -> pt::Result<Subject> {
    Subject::load(name, &[("/film/width", "48"), ("/film/height", "36")])
}

/// Stop condition of a number of samples, without a time limit or a target error.
const fn after(samples: u64) -> StopCondition {
    StopCondition { samples, time: None, target: None, patience: None }
}

/// Number of rounds with about so many samples per pixel. A round of uneven samples has several on average.
fn rounds(samples: u64, spec: &FilmSpec) -> u64 {
    ((samples as f64 / spec.allocation.mean()).round() as u64).max(1)
}

/// Picture of a seed, and the history of its error.
fn taken(subject: &Subject, kind: Kind, scramblings: u32, seed: u64, until: &StopCondition) -> (MomentFilm, ErrorHistory) {
    taken_with(subject, &subject.spec, kind, scramblings, seed, until)
}

/// Picture of a seed, and the history of its error.
///
/// - `spec`: the film, whose allocation may differ from that of the subject
fn taken_with(
    subject: &Subject,
    spec: &FilmSpec,
    kind: Kind,
    scramblings: u32,
    seed: u64,
    until: &StopCondition,
) -> (MomentFilm, ErrorHistory) {
    let settings = Settings::new(SamplerSpec { kind, seed, spp: until.samples, scramblings });
    let mut film = MomentFilm::new(spec.clone());
    let mut render = Render::new(subject.scene.clone(), &*subject.integrator, spec, &settings);
    let history = render_until(&mut render, &mut film, until, &Silent);
    (film, history)
}

/// Reference picture, with random numbers that no other render has.
fn reference(subject: &Subject, samples: u64) -> Image {
    taken(subject, Kind::Sobol, 8, u64::MAX, &after(samples)).0.image()
}

/// True relMSE of a film.
fn relmse(film: &MomentFilm, reference: &Image) -> f64 {
    Distance::between(&film.image(), reference).expect("a reference").relmse.max(0.0)
}
