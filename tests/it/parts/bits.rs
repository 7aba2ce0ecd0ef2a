//! A render has the same bits however it is divided into parts and interrupted.

use std::sync::Arc;

use proptest::prelude::*;
use pt::film::{FilmSpec, MomentFilm};
use pt::integrators::ALL;
use pt::measure::{ErrorHistory, ErrorObserver, ErrorTarget, Scope, StopCondition, render_until, resume_until};
use pt::render::{Observer, Render, RenderReport, Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

use super::{about, merged, numbers, stored, write};
use crate::random::{Random, cases};
use pt::torture::everything::{Everything, bits};

fn nee() -> Box<dyn pt::integrator::Integrator> {
    pt::integrator::choose(&[ALL], None, Some("nee"), "").expect("it is in the table").1
}

fn film() -> FilmSpec {
    FilmSpec::new(7, 5)
}

/// Renders the samples `from` … `to − 1`, with this number of threads and this edge of tiles.
fn taken(scene: &Arc<dyn Scene>, sampler: SamplerSpec, from: u64, to: u64, threads: usize, tile: u32) -> (MomentFilm, RenderReport) {
    let mut moments = MomentFilm::new(film());
    let settings = Settings { tile, ..Settings::new(sampler) };
    let mut render = Render::new(scene.clone(), &*nee(), &film(), &settings).resumed(from, RenderReport::default());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
    pool.install(|| render.advance(to, &mut moments, &Silent));
    (moments, render.report().clone())
}

proptest! {
    #![proptest_config(cases(60))]

    /// Every number of the film is the same, and so are the picture and all statements about its error.
    #[test]
    fn any_parts_in_any_order_are_the_whole(total in 1u64..150, cuts in 0usize..6, kind in 0usize..4, log_k in 0u32..5, seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let sampler = SamplerSpec { kind: Kind::ALL[kind].0, seed: 5, spp: total, scramblings: 1 << log_k };
        let scene: Arc<dyn Scene> = Everything::default().build();
        let whole = taken(&scene, sampler, 0, total, 1, 16).0;
        let mut ends: Vec<u64> = (0..cuts).map(|_| random.below(total as usize + 1) as u64).chain([0, total]).collect();
        ends.sort_unstable();
        ends.dedup();
        let folder = tempfile::tempdir().expect("a folder");
        let mut paths = vec![];
        for pair in ends.windows(2) {
            let path = folder.path().join(format!("{}.ptc", pair[0]));
            let (film, report) = taken(&scene, sampler, pair[0], pair[1], 1 + random.below(3), 1 + random.below(7) as u32);
            write(&path, &about(&super::bits::film(), &sampler), &film, &report, &ErrorHistory::default());
            paths.insert(random.below(paths.len() + 1), path);
        }
        // Some parts are merged first, and the result is then merged with the others.
        let (some, others) = paths.split_at(random.below(paths.len()));
        let mut all: Vec<_> = others.iter().map(|path| stored(path)).collect();
        if !some.is_empty() {
            let sum = merged(some.iter().map(|path| stored(path)).collect());
            let path = folder.path().join("some.ptc");
            pt::part::write(&path, &sum.about, &sum.film, &sum.report, &sum.history).expect("written");
            all.push(stored(&path));
        }
        let sum = merged(all);
        let found = sum.whole().expect("nothing is missing");
        prop_assert_eq!(numbers(found), numbers(&whole));
        prop_assert_eq!(bits(&found.image()), bits(&whole.image()));
        prop_assert_eq!(sum.report.samples, total);
    }
}

/// Cancels a render after a number of waves.
struct Impatient {
    waves: std::sync::atomic::AtomicU32,
}

impl Observer for Impatient {
    fn wave_done(&self, _: u64, _: &dyn pt::film::Film) {
        self.waves.fetch_sub(1, std::sync::atomic::Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.waves.load(std::sync::atomic::Ordering::Relaxed) == 0
    }
}

impl ErrorObserver for Impatient {}

/// A render with a target error that is stopped after each of its waves, written, read and resumed, stops at the same number of samples,
/// with the same picture and the same checkpoints of its error.
#[test]
fn pausing_at_any_wave_changes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("state.ptc");
    let scene: Arc<dyn Scene> = Everything::default().build();
    let sampler = SamplerSpec { seed: 5, kind: Kind::Sobol, spp: 0, scramblings: 2 };
    // A target error that is reached, one that is not, and no target.
    for (target, samples) in [(Some(0.5), 96), (Some(1e-3), 75), (None, 75)] {
        let until = StopCondition {
            samples,
            time: None,
            patience: None,
            target: target.map(|error| ErrorTarget { error, confidence: 0.95, scope: Scope::Picture }),
        };
        let start = || Render::new(scene.clone(), &*nee(), &film(), &Settings::new(sampler));
        let (mut whole, mut render) = (MomentFilm::new(film()), start());
        let looks = |history: &ErrorHistory| history.checkpoints.iter().map(|c| (c.samples, c.error)).collect::<Vec<_>>();
        let wanted = render_until(&mut render, &mut whole, &until, &Silent);
        for waves in 1.. {
            let (mut moments, mut render) = (MomentFilm::new(film()), start());
            let history = render_until(&mut render, &mut moments, &until, &Impatient { waves: waves.into() });
            if !render.report().cancelled {
                break;
            }
            write(&path, &about(&film(), &sampler), &moments, render.report(), &history);
            let state = merged(vec![stored(&path)]);
            let mut moments = state.film;
            let mut render = start().resumed(moments.range().end, state.report);
            let history = resume_until(state.history, &mut render, &mut moments, &until, &Silent);
            assert_eq!(numbers(&moments), numbers(&whole), "{target:?} after {waves} waves");
            // Without a target the interrupt may have added a checkpoint.
            let (found, wanted) = (looks(&history), looks(&wanted));
            assert_eq!(found.last(), wanted.last(), "{target:?} after {waves} waves");
            assert!(target.is_none() || found == wanted, "{target:?} after {waves} waves: {found:?} for {wanted:?}");
            assert_eq!(render.report().samples, whole.samples());
        }
    }
}
