//! How often the interval of the number of samples that a smaller error takes contains the number that it then takes.
//!
//! The true number is where the mean relMSE of some long renders falls below the target. Nothing but their length depends on the clock.

use pt::measure::{ErrorHistory, Forecast};
use rayon::prelude::*;

use super::curves::{self, SAMPLINGS, Sampling, TARGETS, crossing, film};
use super::share::{Share, chance_of_failures, median};
use super::subject::Subject;
use super::{Request, after, rounds, small, taken_with};

/// Samples per pixel of the pilots.
const PILOTS: [u64; 4] = [16, 32, 64, 128];
/// Range in which the median of predicted over true numbers should be.
const RANGE: [f64; 2] = [0.85, 1.18];
/// Probability that any cell is called too wrong although all intervals are right, if the true number were known exactly. It comes from
/// a few long renders, whose error all pilots of a cell share, so that the true probability is somewhat greater.
const RISK: f64 = 0.01;

pub fn print(request: &Request) -> pt::Result<()> {
    println!("| scene | sampler | error | true spp | pilot of 16 spp: holds, median predicted / true | 32 | 64 | 128 |");
    println!("|---|---|---|---|---|---|---|---|");
    let mut tally = Tally::default();
    for name in request.scenes {
        let subject = small(name)?;
        for sampling in SAMPLINGS {
            let curve = match request.curves {
                Some(file) => curves::read(file, name, sampling),
                None => curves::long(&subject, sampling).unwrap_or_default(),
            };
            // The curve reaches no target, or has no points because uneven samples do not pay.
            if TARGETS.iter().all(|target| crossing(&curve, *target).is_none()) {
                continue;
            }
            let pilots = PILOTS.map(|spp| (spp, pilots(&subject, sampling, spp, request.seeds)));
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
        if forecasts.is_empty() { share.to_string() } else { format!("{share}, {median:.2}") }
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

/// Pilots of about so many samples per pixel. Those of an adaptive render that takes even samples are not among them.
fn pilots(subject: &Subject, sampling: Sampling, spp: u64, seeds: u64) -> Vec<Pilot> {
    let pilot = |seed: u64| {
        let (kind, spec) = film(subject, sampling, seed)?;
        let history = taken_with(subject, &spec, kind, 2, seed, &after(rounds(spp, &spec))).1;
        Some(Pilot { history, round: spec.allocation.mean() })
    };
    (0..seeds).into_par_iter().filter_map(pilot).collect()
}
