//! Parts of a render: any division into parts, merged in any order and paused anywhere, gives the same bits as one render. Other files are
//! refused.

mod bits;
mod files;
mod identity;
mod program;

use std::path::Path;

use pt::describe::Identity;
use pt::film::{Film, FilmSpec, MomentFilm};
use pt::measure::ErrorHistory;
use pt::part::{self, About, Part, Stored};
use pt::render::RenderReport;
use pt::sampler::{ErrorEstimator, SamplerSpec};
use serde_json::json;

/// Properties of a picture, which these tests identify by its sampler.
fn about(film: &FilmSpec, sampler: &SamplerSpec) -> About {
    About::new(Identity::from_facts(json!({ "sampler": format!("{sampler:?}") })), film, sampler.error_estimator(), vec![])
}

/// The bits of every number of a film, with its position.
fn numbers(film: &MomentFilm) -> Vec<(u64, u32, Vec<u64>)> {
    film.blocks().map(|(wave, block)| (wave.first, wave.level, block.numbers().iter().map(|x| x.to_bits()).collect())).collect()
}

fn stored(path: &Path) -> Stored {
    Stored::open(path).unwrap_or_else(|e| panic!("{e}"))
}

fn write(path: &Path, about: &About, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) {
    part::write(path, about, film, report, history).unwrap_or_else(|e| panic!("{e}"));
}

fn merged(parts: Vec<Stored>) -> Part {
    part::merge(parts).unwrap_or_else(|e| panic!("{e}"))
}

/// A small file of one block of 2^level samples, with numbers of all kinds.
fn small(path: &Path, first: u64, level: u32) {
    let film_spec = FilmSpec::new(2, 1);
    let sampler = SamplerSpec { kind: pt::sampler::Kind::Independent, ..SamplerSpec::default() };
    let mut film = MomentFilm::new(film_spec.clone());
    let values = (0..16).map(|i| [0.0, -0.0, 1.0, f64::MIN_POSITIVE, 1e300, 0.1][i % 6]).collect();
    let block = pt::film::PixelSums::from_numbers(ErrorEstimator::Samples.into(), values).expect("two pixels of eight numbers");
    film.add(pt::film::Wave { first, level }, block);
    write(path, &about(&film_spec, &sampler), &film, &RenderReport::default(), &ErrorHistory::default());
}
