//! How often the true error is below a target that was met, and how many samples were spent to know it.

use pt::film::Image;
use pt::measure::{ErrorTarget, Outcome, Scope, StopCondition};
use pt::sampler::Kind;
use rayon::prelude::*;

use super::curves::crossing;
use super::share::{Share, median};
use super::subject::Subject;
use super::{REFERENCE, Request, SAMPLERS, after, reference, relmse, small, taken};

pub const SCENES: [&str; 5] = ["cornell-box", "mirror-balls", "statue", "triangle-stacks", "matter"];
const TARGET: ErrorTarget = ErrorTarget { error: 0.05, confidence: 0.95, scope: Scope::Picture };

pub fn print(request: &Request) -> pt::Result<()> {
    let mut all = Share::default();
    println!("| scene | sampler | met and true | spp spent, median | spp needed | ratio |\n|---|---|---|---|---|---|");
    for name in request.scenes {
        let subject = small(name)?;
        let reference = reference(&subject, 2 * REFERENCE);
        for kind in SAMPLERS {
            let (share, spent, needed) = counted(&subject, kind, &reference, request.seeds);
            println!("| {name} | {kind:?} | {share} | {spent:.0} | {needed:.0} | {:.2} |", spent / needed);
            all.add(share);
        }
    }
    println!("\nThe true error is below a target of 5 % in {all} renders that met it: {}.\n", all.percent());
    Ok(())
}

/// How often the error of a met target is true, the median number of samples spent, and the number at which the mean relMSE falls below
/// the target.
fn counted(subject: &Subject, kind: Kind, reference: &Image, seeds: u64) -> (Share, f64, f64) {
    let until = StopCondition { samples: u32::MAX.into(), time: None, target: Some(TARGET), patience: None };
    let look = |seed: u64| {
        let (film, history) = taken(subject, kind, 2, seed, &until);
        let is_met = TARGET.outcome(&history) == Outcome::Met;
        is_met.then(|| (film.samples(), relmse(&film, reference).sqrt() <= TARGET.error))
    };
    let looks: Vec<(u64, bool)> = (0..seeds).into_par_iter().filter_map(look).collect();
    let mut share = Share::default();
    looks.iter().for_each(|(_, is_true)| share.count(*is_true));
    let spent = median(looks.iter().map(|(samples, _)| *samples as f64).collect());
    let mean = |samples: u64| {
        let squares = (0..seeds.min(16)).into_par_iter().map(|seed| relmse(&taken(subject, kind, 2, seed, &after(samples)).0, reference));
        (samples as f64, squares.sum::<f64>() / seeds.min(16) as f64)
    };
    let curve: Vec<(f64, f64)> = (3..16).map(|level| mean(1 << level)).take_while_inclusive(TARGET.error.powi(2)).collect();
    (share, spent, crossing(&curve, TARGET.error).unwrap_or(f64::NAN))
}

/// Points of a falling curve up to the first below a limit.
trait TakeWhileInclusive: Iterator<Item = (f64, f64)> + Sized {
    fn take_while_inclusive(self, limit: f64) -> impl Iterator<Item = (f64, f64)> {
        let mut is_done = false;
        self.map_while(move |point| {
            let before = is_done;
            is_done = point.1 <= limit;
            (!before).then_some(point)
        })
    }
}

impl<I: Iterator<Item = (f64, f64)>> TakeWhileInclusive for I {}
