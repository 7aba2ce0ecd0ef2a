//! How often the interval of the number of samples that a smaller error takes contains the number that it then takes.
//!
//! The true number is where the mean relMSE of some long renders falls below the target. Their relMSE is that of their own error bars,
//! whose coverage is the subject of another table. Nothing depends on the clock.

use std::time::Duration;

use pt::measure::{ErrorHistory, ErrorTarget, Forecast, Scope, StopCondition};
use pt::sampler::Kind;
use rayon::prelude::*;

use super::share::{Share, median};
use super::subject::Subject;
use super::{SAMPLERS, after, small, taken};

pub const SCENES: [&str; 9] =
    ["cornell-box", "mirror-balls", "statue", "triangle-stacks", "matter", "postcard", "glass-panel", "metals", "lanterns"];
/// Samples per pixel of the pilots.
const PILOTS: [u64; 4] = [16, 32, 64, 128];
const TARGETS: [f64; 3] = [0.03, 0.01, 0.003];
/// Number of long renders of a scene, and the time that each may take. What they do not reach in that time is not part of the table.
const LONG: u64 = 2;
const LONGEST: Duration = Duration::from_secs(20);
/// Range in which the median of predicted over true numbers should be.
const RANGE: [f64; 2] = [0.85, 1.18];

pub fn print(scenes: &[&str], seeds: u64) -> pt::Result<()> {
    println!("| scene | sampler | error | true spp | pilot of 16 spp: holds, median predicted / true | 32 | 64 | 128 |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut all, mut medians) = (Share::default(), Share::default());
    for name in scenes {
        let subject = small(name)?;
        for kind in SAMPLERS {
            let curve = mean_curve(&subject, kind);
            let pilots = PILOTS.map(|pilot| (pilot, histories(&subject, kind, pilot, seeds)));
            for target in TARGETS {
                let Some(truth) = crossing(&curve, target) else { continue };
                let cell = |(pilot, histories): &(u64, Vec<ErrorHistory>)| {
                    if truth <= *pilot as f64 {
                        return "–".into();
                    }
                    // Pilots without a stated error predict nothing.
                    let forecasts: Vec<Forecast> = histories.iter().filter_map(|history| history.samples_for(target, 0.95)).collect();
                    let mut share = Share::default();
                    forecasts.iter().for_each(|forecast| share.count((forecast.low..=forecast.high).contains(&truth)));
                    all.add(share);
                    let median = median(forecasts.iter().map(|forecast| forecast.value / truth).collect());
                    // A few pictures that state an error say nothing about the median.
                    if share.of >= 20 {
                        medians.count((RANGE[0]..=RANGE[1]).contains(&median));
                    }
                    format!("{share}, {median:.2}")
                };
                let cells = pilots.iter().map(cell).collect::<Vec<String>>().join(" | ");
                println!("| {name} | {kind:?} | {} % | {truth:.0} | {cells} |", 100.0 * target);
            }
        }
    }
    println!("\nThe interval holds in {all} cases: {}. The median is within {RANGE:?} in {medians} cells.\n", all.percent());
    Ok(())
}

/// Histories of pilots of so many samples per pixel.
fn histories(subject: &Subject, kind: Kind, pilot: u64, seeds: u64) -> Vec<ErrorHistory> {
    (0..seeds).into_par_iter().map(|seed| taken(subject, kind, 2, seed, &after(pilot)).1).collect()
}

/// Samples per pixel and mean relMSE of the long renders, as far as all of them got.
fn mean_curve(subject: &Subject, kind: Kind) -> Vec<(u64, f64)> {
    // A little below the smallest target, so that the curve crosses it.
    let target = ErrorTarget { error: 0.95 * TARGETS[TARGETS.len() - 1], confidence: 0.5, scope: Scope::Picture };
    let until = StopCondition { samples: u32::MAX.into(), time: Some(LONGEST), target: Some(target) };
    let histories: Vec<_> = (0..LONG).map(|seed| taken(subject, kind, 2, 1000 + seed, &until).1).collect();
    let at = |samples: u64| -> Option<(u64, f64)> {
        let error = |history: &ErrorHistory| history.checkpoints.iter().find(|c| c.samples == samples)?.error;
        let squares: Vec<f64> = histories.iter().map(|history| Some(error(history)?.value.powi(2))).collect::<Option<_>>()?;
        Some((samples, squares.iter().sum::<f64>() / squares.len() as f64))
    };
    histories[0].checkpoints.iter().filter_map(|c| at(c.samples)).collect()
}

/// Number of samples at which the curve falls to the target, interpolated by a power law.
pub fn crossing(curve: &[(u64, f64)], target: f64) -> Option<f64> {
    let goal = 2.0 * target.ln();
    let points: Vec<(f64, f64)> = curve.iter().map(|(n, relmse)| ((*n as f64).ln(), relmse.ln())).collect();
    let pair = points.windows(2).find(|pair| pair[0].1 > goal && pair[1].1 <= goal)?;
    let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
    Some((pair[0].0 + share * (pair[1].0 - pair[0].0)).exp())
}
