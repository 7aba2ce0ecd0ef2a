//! How often the interval of the number of samples that a smaller error takes contains the number that it then takes.
//!
//! The true number is where the mean relMSE of some long renders falls below the target. Their relMSE is that of their own error bars,
//! whose coverage is the subject of another table. Nothing depends on the clock.

use std::time::Duration;

use pt::film::FilmSpec;
use pt::measure::adaptive::pilot_allocation;
use pt::measure::{ErrorHistory, ErrorTarget, Forecast, Scope, StopCondition};
use pt::render::{Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use rayon::prelude::*;

use super::share::{Share, chance_of_failures, median};
use super::subject::Subject;
use super::{SAMPLERS, after, small, taken_with};

pub const SCENES: [&str; 9] =
    ["cornell-box", "mirror-balls", "statue", "triangle-stacks", "matter", "postcard", "glass-panel", "metals", "lanterns"];
/// Samples per pixel of the pilots.
const PILOTS: [u64; 4] = [16, 32, 64, 128];
const TARGETS: [f64; 3] = [0.03, 0.01, 0.003];
/// Seed of the first long render, which no pilot has.
const FIRST_LONG: u64 = 1000;
/// Number of long renders of a scene, and the time that each may take: five minutes, which are ten of CPU time on two cores. What they do not
/// reach in that time is not part of the table.
const LONG: u64 = 2;
const LONGEST: Duration = Duration::from_secs(300);
/// Range in which the median of predicted over true numbers should be.
const RANGE: [f64; 2] = [0.85, 1.18];
/// Probability that any cell is called too wrong although all intervals are right, if the true number were known exactly. It comes from
/// [`LONG`] renders, whose error all pilots of a cell share, so that the true probability is somewhat greater.
const RISK: f64 = 0.01;

/// How the samples of a picture are taken.
#[derive(Clone, Copy)]
enum Sampling {
    /// The same number of samples in each pixel.
    Even(Kind),
    /// More samples in noisy pixels, as `--adaptive` takes them, with the default sampler.
    Adaptive,
}

const SAMPLINGS: [Sampling; 4] =
    [Sampling::Even(SAMPLERS[0]), Sampling::Even(SAMPLERS[1]), Sampling::Even(SAMPLERS[2]), Sampling::Adaptive];

pub fn print(scenes: &[&str], seeds: u64) -> pt::Result<()> {
    println!("| scene | sampler | error | true spp | pilot of 16 spp: holds, median predicted / true | 32 | 64 | 128 |");
    println!("|---|---|---|---|---|---|---|---|");
    let mut tally = Tally::default();
    for name in scenes {
        let subject = small(name)?;
        for sampling in SAMPLINGS {
            let Some(curve) = mean_curve(&subject, sampling) else {
                println!("| {name} | {sampling} | | uneven samples do not pay | – | – | – | – |");
                continue;
            };
            let pilots = PILOTS.map(|spp| (spp, pilots(&subject, sampling, spp, seeds)));
            for target in TARGETS {
                let Some(truth) = crossing(&curve, target) else { continue };
                let row = format!("{name} | {sampling} | {} %", 100.0 * target);
                let cells =
                    pilots.iter().map(|(spp, pilots)| tally.cell(&row, *spp, pilots, target, truth)).collect::<Vec<_>>().join(" | ");
                println!("| {row} | {truth:.0} | {cells} |");
            }
        }
    }
    tally.print();
    Ok(())
}

/// What the cells of the table say together.
#[derive(Default)]
struct Tally {
    /// The cells, and how many of their intervals hold.
    shares: Vec<(String, Share)>,
    /// Cells whose median is within [`RANGE`].
    medians: Share,
}

impl Tally {
    /// Text of a cell, whose shares are counted.
    fn cell(&mut self, row: &str, spp: u64, pilots: &[Pilot], target: f64, truth: f64) -> String {
        if truth <= spp as f64 {
            return "–".into();
        }
        // Pilots without a stated error predict nothing.
        let forecasts: Vec<Forecast> = pilots.iter().filter_map(|pilot| pilot.samples_for(target)).collect();
        let mut share = Share::default();
        forecasts.iter().for_each(|forecast| share.count((forecast.low..=forecast.high).contains(&truth)));
        self.shares.push((format!("{row} | {spp} spp"), share));
        let median = median(forecasts.iter().map(|forecast| forecast.value / truth).collect());
        // A few pictures that state an error say nothing about the median.
        if share.of >= 20 {
            self.medians.count((RANGE[0]..=RANGE[1]).contains(&median));
        }
        format!("{share}, {median:.2}")
    }

    fn print(&self) {
        let mut all = Share::default();
        self.shares.iter().for_each(|(_, share)| all.add(*share));
        let is_too_wrong = |share: Share| chance_of_failures(share.of - share.held, share.of) < RISK / self.shares.len() as f64;
        let names: Vec<&str> = self.shares.iter().filter(|(_, share)| is_too_wrong(*share)).map(|(name, _)| name.as_str()).collect();
        let names = if names.is_empty() { "none".into() } else { names.join("; ") };
        println!("\nThe interval holds in {all} cases: {}.", all.percent());
        println!("Cells with more wrong intervals than 5 % and chance explain: {names}.");
        println!("The median is within {RANGE:?} in {} cells.\n", self.medians);
    }
}

/// History of a short render.
struct Pilot {
    history: ErrorHistory,
    /// Samples per pixel of a round, on average.
    round: f64,
}

impl Pilot {
    /// Samples per pixel, on average, that an error takes.
    fn samples_for(&self, target: f64) -> Option<Forecast> {
        let rounds = self.history.samples_for(target, 0.95)?;
        Some(Forecast { value: self.round * rounds.value, low: self.round * rounds.low, high: self.round * rounds.high })
    }
}

/// Film of a sampling, whose allocation depends on the seed of its pilot; `None` if uneven samples do not pay.
fn film(subject: &Subject, sampling: Sampling, seed: u64) -> Option<(Kind, FilmSpec)> {
    let mut spec = subject.spec.clone();
    let kind = match sampling {
        Sampling::Even(kind) => kind,
        Sampling::Adaptive => {
            let kind = SAMPLERS[2];
            let settings = Settings::new(SamplerSpec { kind, seed, spp: u32::MAX.into(), scramblings: 2 });
            (spec.allocation, _) = pilot_allocation(&subject.scene, &*subject.integrator, &spec, &settings, u32::MAX.into(), &Silent);
            if spec.allocation.is_even() {
                return None;
            }
            kind
        }
    };
    Some((kind, spec))
}

/// Pilots of about so many samples per pixel. Those of an adaptive render that takes even samples are not among them.
fn pilots(subject: &Subject, sampling: Sampling, spp: u64, seeds: u64) -> Vec<Pilot> {
    let pilot = |seed: u64| {
        let (kind, spec) = film(subject, sampling, seed)?;
        let round = spec.allocation.mean();
        let rounds = ((spp as f64 / round).round() as u64).max(1);
        Some(Pilot { history: taken_with(subject, &spec, kind, 2, seed, &after(rounds)).1, round })
    };
    (0..seeds).into_par_iter().filter_map(pilot).collect()
}

/// Samples per pixel and mean relMSE of the long renders, as far as all of them got; `None` if uneven samples do not pay.
fn mean_curve(subject: &Subject, sampling: Sampling) -> Option<Vec<(f64, f64)>> {
    // A little below the smallest target, so that the curve crosses it.
    let target = ErrorTarget { error: 0.95 * TARGETS[TARGETS.len() - 1], confidence: 0.5, scope: Scope::Picture };
    let until = StopCondition { samples: u32::MAX.into(), time: Some(LONGEST), target: Some(target) };
    let (kind, spec) = film(subject, sampling, FIRST_LONG)?;
    let long = |seed: u64| taken_with(subject, &spec, kind, 2, FIRST_LONG + seed, &until).1;
    let histories: Vec<_> = (0..LONG).map(long).collect();
    let at = |samples: u64| -> Option<(f64, f64)> {
        let error = |history: &ErrorHistory| history.checkpoints.iter().find(|c| c.samples == samples)?.error;
        let squares: Vec<f64> = histories.iter().map(|history| Some(error(history)?.value.powi(2))).collect::<Option<_>>()?;
        Some((spec.allocation.mean() * samples as f64, squares.iter().sum::<f64>() / squares.len() as f64))
    };
    Some(histories[0].checkpoints.iter().filter_map(|c| at(c.samples)).collect())
}

/// Number of samples at which the curve falls to the target, interpolated by a power law.
pub fn crossing(curve: &[(f64, f64)], target: f64) -> Option<f64> {
    let goal = 2.0 * target.ln();
    let points: Vec<(f64, f64)> = curve.iter().map(|(n, relmse)| (n.ln(), relmse.ln())).collect();
    let pair = points.windows(2).find(|pair| pair[0].1 > goal && pair[1].1 <= goal)?;
    let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
    Some((pair[0].0 + share * (pair[1].0 - pair[0].0)).exp())
}

impl std::fmt::Display for Sampling {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Sampling::Even(kind) => write!(f, "{kind:?}"),
            Sampling::Adaptive => write!(f, "Sobol, adaptive"),
        }
    }
}
