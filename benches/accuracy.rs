//! Accuracy of error bars and of predicted render times: the tables of docs/accuracy.md.
//!
//! `cargo bench --bench accuracy [-- coverage|prices|adaptive] [SEEDS] [SCENES]`: the default is all tables, 100 seeds and
//! six scenes. Each has three samplers:
//!
//! - coverage: how often the stated 95 % interval contains the true relative error, and relMSE with two scramblings over relMSE with one,
//!   which is also the ratio of time × relMSE, because a sample takes as long
//! - prices: the time for an error of 1 % as predicted by a short pilot, over the time that it then takes
//! - adaptive: relMSE, and time × relMSE, of 256 adaptive samples per pixel on average over those of 256 uniform ones

mod subject;

use std::time::Duration;

use pt::film::{Image, MomentFilm};
use pt::measure::adaptive::pilot_allocation;
use pt::measure::{Distance, ErrorHistory, RelativeError, StopCondition, render_until};
use pt::render::{Render, Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use rayon::prelude::*;
use subject::Subject;

const SCENES: [&str; 6] = ["cornell-box", "mirror-balls", "mis-plates", "statue", "triangle-stacks", "matter"];
/// Number of samples of the reference picture.
const REFERENCE: u64 = 1 << 14;
const SAMPLERS: [Kind; 3] = [Kind::Independent, Kind::Halton, Kind::Sobol];
/// Samples per pixel at an early and at a late check of the error.
const SAMPLES: [u64; 2] = [64, 256];

/// Stop condition of a number of samples, without a time limit or a target error.
const fn after(samples: u64) -> StopCondition {
    StopCondition { samples, time: None, target: None }
}

fn small(name: &str) -> pt::Result<Subject> {
    Subject::load(name, &[("/film/width", "48"), ("/film/height", "36")])
}

fn taken(subject: &Subject, kind: Kind, scramblings: u32, seed: u64, until: &StopCondition) -> (MomentFilm, ErrorHistory) {
    let settings = Settings::new(SamplerSpec { kind, seed, spp: until.samples, scramblings });
    let mut film = MomentFilm::new(subject.spec.clone());
    let mut render = Render::new(subject.scene.clone(), &*subject.integrator, &subject.spec, &settings);
    let history = render_until(&mut render, &mut film, until, &Silent);
    (film, history)
}

fn main() -> pt::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let tables = ["coverage", "prices", "adaptive"];
    let asked = |name: &str| words.iter().any(|word| word == name) || !words.iter().any(|word| tables.contains(&word.as_str()));
    let scenes: Vec<&str> = SCENES.into_iter().filter(|scene| words.iter().any(|word| word == scene)).collect();
    let scenes = if scenes.is_empty() { &SCENES[..] } else { &scenes };
    let seeds: u64 = words.iter().filter_map(|word| word.parse().ok()).next().unwrap_or(100);
    if asked("coverage") {
        coverage(scenes, seeds)?;
    }
    if asked("prices") {
        prices(scenes)?;
    }
    if asked("adaptive") {
        adaptive(scenes, seeds.min(16))?;
    }
    Ok(())
}

fn coverage(scenes: &[&str], seeds: u64) -> pt::Result<()> {
    let mut total = Count::default();
    println!(
        "| scene | spp | sampler | error | stated / true | not established | interval holds | relMSE of 2 scramblings / 1 |\n|---|---|---|---|---|---|---|---|"
    );
    for name in scenes {
        let subject = small(name)?;
        let (reference, _) = taken(&subject, Kind::Sobol, 8, u64::MAX, &after(REFERENCE));
        let reference = reference.image();
        for samples in SAMPLES {
            for kind in SAMPLERS {
                let count = counted(&subject, kind, samples, &reference, seeds);
                println!("| {name} | {samples} | {kind:?} | {} |", count.row(seeds));
                total.add(&count);
            }
        }
    }
    let [low, high] = total.share_between();
    println!("\nThe interval holds in {} of {} cases: {:.1} % (95 %: {low:.1}-{high:.1}).", total.held, total.established, total.share());
    Ok(())
}

fn counted(subject: &Subject, kind: Kind, samples: u64, reference: &Image, seeds: u64) -> Count {
    let relmse = |film: &MomentFilm| Distance::between(&film.image(), reference).expect("a reference").relmse.max(0.0);
    let look = |seed: u64| {
        let (film, _) = taken(subject, kind, 2, seed, &after(samples));
        let plain = if kind == Kind::Independent { 0.0 } else { relmse(&taken(subject, kind, 1, seed, &after(samples)).0) };
        (RelativeError::of(&film).expect("error bars"), relmse(&film), plain)
    };
    let looks: Vec<_> = (0..seeds).into_par_iter().map(look).collect();
    let mut count = Count::default();
    for (stated, truth, plain) in looks {
        count.take(&stated, truth);
        count.plain_square += plain;
    }
    count
}

/// Comparison of stated and true errors over some seeds.
#[derive(Default)]
struct Count {
    established: u32,
    held: u32,
    stated_square: f64,
    /// Sum over the pictures whose error is established.
    true_square: f64,
    square: f64,
    /// Sum over pictures without error bars.
    plain_square: f64,
}

impl Count {
    fn take(&mut self, stated: &RelativeError, truth: f64) {
        self.square += truth;
        if stated.is_established() {
            let [low, high] = stated.interval(0.95);
            self.held += u32::from((low..=high).contains(&truth.sqrt()));
            self.established += 1;
            self.stated_square += stated.value * stated.value;
            self.true_square += truth;
        }
    }

    fn add(&mut self, other: &Count) {
        self.established += other.established;
        self.held += other.held;
    }

    /// Share of the intervals that contain the true error (%).
    fn share(&self) -> f64 {
        100.0 * f64::from(self.held) / f64::from(self.established)
    }

    /// Wilson's 95 % confidence interval of [`Count::share`] (%).
    fn share_between(&self) -> [f64; 2] {
        let (n, p, z) = (f64::from(self.established), self.share() / 100.0, 1.96);
        let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let reach = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        [middle - reach, middle + reach].map(|share| 100.0 * share)
    }

    fn row(&self, seeds: u64) -> String {
        let error = 100.0 * (self.square / seeds as f64).sqrt();
        let unknown = seeds - u64::from(self.established);
        let known = |text: String| if self.established > 0 { text } else { "–".into() };
        let ratio = known(format!("{:.3}", (self.stated_square / self.true_square).sqrt()));
        let share = known(format!("{:.0} %", self.share()));
        let cost = if self.plain_square > 0.0 { format!("{:.2}", self.square / self.plain_square) } else { "–".into() };
        format!("{error:.1} % | {ratio} | {unknown} | {share} | {cost}")
    }
}

fn adaptive(scenes: &[&str], seeds: u64) -> pt::Result<()> {
    const SAMPLES: u64 = 256;
    println!("| scene | relMSE adaptive / even | time × relMSE adaptive / even | interval holds, adaptive |\n|---|---|---|---|");
    for name in scenes {
        let mut subject = small(name)?;
        let even = subject.spec.clone();
        let (reference, _) = taken(&subject, Kind::Sobol, 8, u64::MAX, &after(64 * SAMPLES));
        let reference = reference.image();
        let relmse = |film: &MomentFilm| Distance::between(&film.image(), &reference).expect("a reference").relmse.max(0.0);
        let (mut errors, mut seconds, mut held, mut established) = ([0.0; 2], [0.0; 2], 0_u32, 0_u32);
        for seed in 0..seeds {
            subject.spec = even.clone();
            let (film, history) = taken(&subject, Kind::Sobol, 2, seed, &after(SAMPLES));
            errors[0] += relmse(&film);
            seconds[0] += history.last().map_or(0.0, |last| last.seconds);
            let settings = Settings::new(SamplerSpec { kind: Kind::Sobol, seed, spp: SAMPLES, scramblings: 2 });
            let (allocation, explored) = pilot_allocation(&subject.scene, &*subject.integrator, &even, &settings, SAMPLES, &Silent);
            subject.spec.allocation = allocation;
            let samples = ((SAMPLES as f64 / subject.spec.allocation.mean()).round() as u64).max(1);
            let (film, history) = taken(&subject, Kind::Sobol, 2, seed, &after(samples));
            errors[1] += relmse(&film);
            seconds[1] += history.last().map_or(0.0, |last| last.seconds) + explored.as_secs_f64();
            if let Some(stated) = RelativeError::of(&film).filter(RelativeError::is_established) {
                let [low, high] = stated.interval(0.95);
                held += u32::from((low..=high).contains(&relmse(&film).sqrt()));
                established += 1;
            }
        }
        let (error, cost) = (errors[1] / errors[0], errors[1] * seconds[1] / (errors[0] * seconds[0]));
        println!("| {name} | {error:.2} | {cost:.2} | {held} of {established} |");
    }
    Ok(())
}

fn prices(scenes: &[&str]) -> pt::Result<()> {
    println!("| scene | sampler | seconds for 1 %: foretold | taken | ratio |\n|---|---|---|---|---|");
    for name in scenes {
        let subject = small(name)?;
        for kind in SAMPLERS {
            println!("| {name} | {kind:?} | {} |", price(&subject, kind));
        }
    }
    Ok(())
}

/// Text of the time that a pilot of two seconds predicts, the time that the render takes, and their ratio.
fn price(subject: &Subject, kind: Kind) -> String {
    const TARGET: f64 = 0.01;
    let pilot = StopCondition { samples: u32::MAX.into(), time: Some(Duration::from_secs(2)), target: None };
    let (_, history) = taken(subject, kind, 2, 1, &pilot);
    let Some(price) = history.price(TARGET, 0.95) else { return "cannot be established | – | –".into() };
    // The render runs for 1.5 times the predicted time, so that the error crosses the target before its end.
    let long = StopCondition { time: Some(Duration::from_secs_f64(1.5 * price.seconds)), ..pilot };
    let (_, history) = taken(subject, kind, 2, 2, &long);
    let taken = history.price(TARGET, 0.95).map(|_| crossing(&history, TARGET));
    let ratio = |taken: f64| format!("{taken:.1} | {:.2}", price.seconds / taken);
    format!("{:.1} | {}", price.seconds, taken.flatten().map_or("not reached | –".into(), ratio))
}

/// Time at which the error fell below the target, interpolated between checkpoints by a power law.
fn crossing(history: &ErrorHistory, target: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> = history.checkpoints.iter().filter_map(|c| c.error.map(|e| (c.seconds.ln(), e.value.ln()))).collect();
    let goal = target.ln();
    let pair = points.windows(2).find(|pair| pair[0].1 > goal && pair[1].1 <= goal)?;
    let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
    Some((pair[0].0 + share * (pair[1].0 - pair[0].0)).exp())
}
