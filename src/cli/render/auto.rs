//! `--integrator auto` and `--sampler auto`: a short pilot of each one that simulates what the scene calls for, and the choice of the one
//! that reaches an error soonest.
//!
//! The pilot renders a small picture of the same view. Its noise is not that of the picture asked for, but the ratio of the times that
//! two methods take to the same error is nearly the same. The choice depends on the clock, so that two runs may choose differently where
//! two methods cost about the same; the picture that is then rendered is the one that the chosen names give.

use std::time::{Duration, Instant};

use super::args::{AUTO, RenderArgs};
use crate::cli::load::Loaded;
use crate::cli::note;
use crate::cli::pilot::PricedIntegrator;
use crate::error::{Error, Result};
use crate::film::MomentFilm;
use crate::integrator::{DEFAULT, Entry};
use crate::measure::format;
use crate::measure::{ErrorHistory, Forecast, StopCondition, resume_until};
use crate::render::{Render, Settings, Silent};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;

/// Times for which a candidate is rendered, each together with the ones before it. Candidates that are surely dearer than another one after the
/// first or the second are not rendered further, so that a clear choice takes little time.
const TIMES: [Duration; 3] = [Duration::from_millis(100), Duration::from_millis(200), Duration::from_millis(400)];

/// Pixels of the pilot's picture, about.
const PIXELS: f32 = 3072.0;

/// Confidence of prices, and with which a candidate must be cheaper than the default to replace it.
const CONFIDENCE: f64 = 0.95;

/// Factor by which the time of a sample may differ from one moment of a machine to another.
const CLOCK: f64 = 1.1;

/// Upper over lower end of an interval from which on only the lower end is printed: the value is then uncertain by a factor of ten.
const TELLING: f64 = 100.0;

/// Factor by which a price may be wrong where the error of the pilot cannot be stated, as rare bright samples make the noise or are missing.
const UNSURE: f64 = 10.0;

/// Error at which the candidates are compared, unless `--target` states one.
const ERROR: f64 = 0.01;

/// Samplers to choose from. `stratified` must know its number of samples, and a pilot has another one.
const SAMPLERS: [Kind; 3] = [Kind::Independent, Kind::Halton, Kind::Sobol];

/// What a pilot chooses.
#[derive(Clone, Copy, PartialEq)]
enum Choice {
    Integrator,
    Sampler,
}

impl Choice {
    fn flag(self) -> &'static str {
        match self {
            Choice::Integrator => "--integrator",
            Choice::Sampler => "--sampler",
        }
    }
}

/// Replaces integrator and sampler by those that the pilot chooses, if the arguments ask for it, and notes the reason.
///
/// # Errors
/// `Usage` together with options that need the same choice in several runs.
pub fn choose(args: &RenderArgs, loaded: Loaded, tables: &[&[Entry]]) -> Result<Loaded> {
    let asks = |given: &Option<String>| given.as_deref() == Some(AUTO);
    let (integrators, samplers) = (asks(&args.integrator), asks(&args.sampler));
    if !integrators && !samplers {
        return Ok(loaded);
    }
    let together = [("--shard", args.shard.is_some()), ("--samples", args.samples.is_some()), ("--resume", args.resume.is_some())];
    if let Some((flag, _)) = together.into_iter().find(|(_, is_given)| *is_given) {
        let message = "another run may choose otherwise, and parts of different methods do not fit together: name the method";
        return Err(Error::Usage(format!("{AUTO} with {flag}: {message}")));
    }
    let mut loaded = loaded;
    let mut known = None;
    if integrators {
        let start = Instant::now();
        let candidates = integrator_candidates(args, &loaded, tables)?.into_iter().map(|candidate| Pilot::new(args, &loaded, candidate));
        let chosen = choice(args, candidates.collect(), Choice::Integrator, start)?;
        loaded.select(chosen.candidate.entry, chosen.candidate.integrator.clone());
        known = Some(chosen);
    }
    if samplers {
        let (start, own) = (Instant::now(), loaded.sampler);
        let kinds = SAMPLERS.into_iter().filter(|kind| *kind != own.kind).map(|kind| SamplerSpec { kind, ..own });
        let candidate = |sampler| PricedIntegrator { entry: loaded.entry, integrator: loaded.integrator.clone(), sampler };
        let pilot = |sampler| Pilot::new(args, &loaded, candidate(sampler));
        // The chosen integrator has been tried with its own sampler.
        let candidates = std::iter::once(known.unwrap_or_else(|| pilot(own))).chain(kinds.map(pilot)).collect();
        let chosen = choice(args, candidates, Choice::Sampler, start)?;
        loaded.select_sampler(chosen.candidate.sampler.kind)?;
    }
    Ok(loaded)
}

/// All integrators that lack no effect of the scene and work with the options: first the one that would render otherwise, then the
/// default. If there are none, the one that would render otherwise.
fn integrator_candidates(args: &RenderArgs, loaded: &Loaded, tables: &[&[Entry]]) -> Result<Vec<PricedIntegrator>> {
    let effects = loaded.world.effects();
    let mut entries: Vec<&Entry> = tables.iter().copied().flatten().filter(|entry| entry.lacks(effects).is_none()).collect();
    entries.sort_by_key(|entry| (entry.name != loaded.entry.name, entry.name != DEFAULT));
    let is_scoped = args.region.is_some() || args.tiles.is_some();
    let needs_own_samples = args.adaptive || args.clamp.is_some() || args.worst.is_some() || is_scoped;
    let mut list = vec![];
    for entry in entries {
        let (entry, integrator) = loaded.choose(tables, entry.name)?;
        if !(needs_own_samples && integrator.splats()) {
            list.push(PricedIntegrator { sampler: loaded.sampler_for(&*integrator), entry, integrator });
        }
    }
    if list.is_empty() {
        list.push(PricedIntegrator { entry: loaded.entry, integrator: loaded.integrator.clone(), sampler: loaded.sampler });
    }
    Ok(list)
}

/// A candidate and the small picture that it has rendered so far.
struct Pilot {
    candidate: PricedIntegrator,
    render: Render,
    film: MomentFilm,
    history: ErrorHistory,
}

impl Pilot {
    fn new(args: &RenderArgs, loaded: &Loaded, candidate: PricedIntegrator) -> Pilot {
        let spec = loaded.film.with_pixels(PIXELS);
        let settings = Settings { clamp: args.clamp, ..Settings::new(candidate.sampler) };
        let render = Render::new(loaded.world.clone(), &*candidate.integrator, &spec, &settings);
        Pilot { candidate, render, film: MomentFilm::new(spec), history: ErrorHistory::default() }
    }

    /// Renders until a time has passed in all.
    fn run(&mut self, time: Duration) {
        let until = StopCondition { samples: u32::MAX.into(), time: Some(time), target: None, patience: None };
        self.history = resume_until(std::mem::take(&mut self.history), &mut self.render, &mut self.film, &until, &Silent);
    }
}

/// Renders with each candidate, the first of which is the default, and returns the one to use.
///
/// - `start`: when the work on these candidates began
fn choice(args: &RenderArgs, mut pilots: Vec<Pilot>, what: Choice, start: Instant) -> Result<Pilot> {
    let error = args.target.unwrap_or(ERROR);
    let name = |pilot: &Pilot| match what {
        Choice::Integrator => pilot.candidate.entry.name,
        Choice::Sampler => pilot.candidate.sampler.kind.name(),
    };
    let mut priced: Vec<Priced> = pilots.iter().map(|pilot| Priced { name: name(pilot), prices: vec![] }).collect();
    for (stage, time) in TIMES.into_iter().enumerate() {
        let open: Vec<usize> = (0..pilots.len()).filter(|k| !priced[*k].is_surely_dearer(&priced)).collect();
        if stage > 0 && open.len() < 2 {
            break;
        }
        for k in open {
            pilots[k].run(time);
            priced[k].prices.push(Price::of(&pilots[k].history, error, what));
        }
    }
    let chosen = best(what, &priced);
    note(&format!(
        "note: {} {AUTO}: {} (pilot of {})",
        what.flag(),
        reason(what, &priced, chosen),
        format::duration(start.elapsed().as_secs_f64())
    ));
    pilots.into_iter().nth(chosen).ok_or_else(|| Error::Internal("the pilot has no candidate".into()))
}

/// Time to the error, from the picture of a pilot.
#[derive(Clone, Copy)]
struct Price {
    /// `None` if the pilot found no light.
    time: Option<Forecast>,
    /// Whether the error of the pilot can be stated. Otherwise the time may be wrong by the factor [`UNSURE`].
    is_sure: bool,
}

impl Price {
    fn of(history: &ErrorHistory, error: f64, what: Choice) -> Price {
        let last = history.last().and_then(|last| Some((last.seconds, last.error?.value)));
        // The error falls with the square root of the time.
        let scaled = |Forecast { value, low, high }, found: f64| {
            let [value, low, high] = [value, low, high].map(|seconds: f64| seconds * (found / error).powi(2));
            Forecast { value, low, high }
        };
        let sure = match what {
            // All integrators have the same sampler. By what law their errors fall after the pilot is uncertain, but about the same for all, so that
            // the ratio of two prices is known best at the errors that the pilots reached.
            Choice::Integrator => last.and_then(|(_, found)| Some(scaled(history.price(found, CONFIDENCE)?, found))),
            Choice::Sampler => history.price(error, CONFIDENCE),
        };
        let time = sure.or_else(|| {
            let (seconds, found) = last?;
            Some(scaled(Forecast { value: seconds, low: seconds / UNSURE, high: seconds * UNSURE }, found))
        });
        // No picture takes less than a sample of each pixel.
        let least = history.last().map_or(0.0, |last| last.seconds / last.samples as f64);
        let at_least = |Forecast { value, low, high }| Forecast {
            value: f64::max(value, least),
            low: f64::max(low, least / CLOCK),
            high: f64::max(high, least * CLOCK),
        };
        Price { time: time.map(at_least), is_sure: sure.is_some() }
    }
}

/// A candidate and its prices, after each of [`TIMES`] for which it was rendered.
struct Priced {
    name: &'static str,
    prices: Vec<Price>,
}

/// Price of a candidate over that of another.
struct Ratio {
    /// The ratio, with the interval that both uncertainties give.
    value: Forecast,
    /// Whether both prices are sure.
    is_sure: bool,
}

impl Priced {
    fn last(&self) -> Price {
        self.prices.last().copied().unwrap_or(Price { time: None, is_sure: false })
    }

    /// Ratio of this price to another, after the longest time for which both were rendered, since errors may fall faster at first.
    fn ratio(&self, other: &Priced) -> Option<Ratio> {
        let stage = self.prices.len().min(other.prices.len()).checked_sub(1)?;
        let (own, other) = (self.prices[stage], other.prices[stage]);
        let spread = |time: Forecast| 0.5 * (time.high / time.low).ln();
        let (time, other_time) = (own.time?, other.time?);
        let (value, factor) = (time.value / other_time.value, spread(time).hypot(spread(other_time)).exp());
        Some(Ratio { value: Forecast { value, low: value / factor, high: value * factor }, is_sure: own.is_sure && other.is_sure })
    }

    /// Whether another candidate is cheaper by more than both uncertainties.
    fn is_surely_dearer(&self, all: &[Priced]) -> bool {
        all.iter().any(|other| self.ratio(other).is_some_and(|ratio| ratio.is_sure && ratio.value.low > 1.0))
    }
}

/// Index of the candidate that is cheapest with all uncertainty against it, if it is then cheaper than the first, and of the first
/// otherwise.
///
/// - `what`: samplers serve one method: where the noise of one is uneven, the others have not met its rare bright samples yet, and none
///   is trusted
fn best(what: Choice, priced: &[Priced]) -> usize {
    let Some(default) = priced.first() else { return 0 };
    if what == Choice::Sampler && priced.iter().any(|candidate| !candidate.last().is_sure) {
        return 0;
    }
    let at_most = |candidate: &Priced| match candidate.ratio(default) {
        Some(ratio) => ratio.value.high,
        // Any light is better than none.
        None if default.last().time.is_none() && candidate.last().time.is_some() => 0.0,
        None => f64::INFINITY,
    };
    let others = (1..priced.len()).map(|k| (k, at_most(&priced[k])));
    others.filter(|(_, at_most)| *at_most < 1.0).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k)
}

/// The choice and what the others would take, in words.
fn reason(what: Choice, priced: &[Priced], chosen: usize) -> String {
    let name = priced[chosen].name;
    let other = |other: &Priced| match other.ratio(&priced[chosen]) {
        Some(Ratio { value: Forecast { value, low, high }, is_sure: true }) if high / low < TELLING => {
            let [value, low, high] = [value, low, high].map(format::two_digits);
            format!("{} {value} times as long ({low}–{high})", other.name)
        }
        Some(Ratio { value, .. }) if value.low > 1.0 => format!("{} at least {} times as long", other.name, format::two_digits(value.low)),
        Some(_) => format!("{} cannot be told", other.name),
        None => format!("{} found no light", other.name),
    };
    let others: Vec<String> = priced.iter().filter(|priced| priced.name != name).map(other).collect();
    let last = priced[chosen].last();
    let is_uneven = priced.iter().any(|candidate| !candidate.last().is_sure);
    match last.time {
        _ if others.is_empty() => format!("{name}, the only one that simulates what the scene calls for"),
        None => format!("{name}, the default, since no pilot tells an error"),
        Some(_) if what == Choice::Sampler && is_uneven => {
            format!("{name}, the default, since the noise is too uneven to compare samplers")
        }
        Some(_) if last.is_sure => format!("{name}; to the same error, {}", others.join(", ")),
        Some(_) => format!("{name}, though its noise is too uneven for a sure price; {}", others.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::film::{Crop, FilmSpec};

    fn price(value: f64, factor: f64) -> Price {
        Price { time: Some(Forecast { value, low: value / factor, high: value * factor }), is_sure: true }
    }

    fn priced(name: &'static str, value: f64, factor: f64) -> Priced {
        Priced { name, prices: vec![price(value, factor)] }
    }

    fn unsure(name: &'static str, value: f64) -> Priced {
        Priced { name, prices: vec![Price { is_sure: false, ..price(value, UNSURE) }] }
    }

    fn black(name: &'static str) -> Priced {
        Priced { name, prices: vec![Price { time: None, is_sure: false }] }
    }

    /// The default stays unless another is cheaper by more than both uncertainties: 1.5 to the power √2, 1.77.
    #[test]
    fn the_default_stays_where_the_pilot_cannot_tell() {
        let nee = || priced("nee", 9.0, 1.5);
        assert_eq!(best(Choice::Integrator, &[nee(), priced("path", 9.0 / 1.7, 1.5)]), 0);
        assert_eq!(best(Choice::Integrator, &[nee(), priced("path", 9.0 / 1.8, 1.5)]), 1);
        assert_eq!(best(Choice::Integrator, &[nee(), priced("path", 3.0, 1.5), priced("light", 2.0, 1.5)]), 2);
        assert_eq!(best(Choice::Integrator, &[nee(), black("light")]), 0);
        assert_eq!(best(Choice::Integrator, &[black("nee"), black("light")]), 0);
        assert_eq!(best(Choice::Integrator, &[black("nee"), priced("light", 1e9, 1.5)]), 1);
        assert_eq!(best(Choice::Integrator, &[nee()]), 0);
    }

    /// A candidate is not rendered further only where both prices are sure and their uncertainties cannot explain the difference.
    #[test]
    fn surely_dearer_candidates_are_not_rendered_further() {
        let nee = || priced("nee", 9.0, 1.5);
        let is_out = |candidate: Priced, other: Priced| candidate.is_surely_dearer(&[nee(), other]);
        assert!(!is_out(priced("path", 9.0 * 1.7, 1.5), black("light")));
        assert!(is_out(priced("path", 9.0 * 1.8, 1.5), black("light")));
        assert!(is_out(nee(), priced("path", 9.0 / 1.8, 1.5)), "the default as well");
        assert!(!is_out(nee(), unsure("path", 1e-3)), "unsure prices decide nothing");
        assert!(!is_out(unsure("path", 1e9), black("light")) && !is_out(black("path"), black("light")));
        assert!(!Priced { name: "new", prices: vec![] }.is_surely_dearer(&[nee()]));
    }

    /// Prices are compared after the time for which both candidates were rendered, whatever one of them costs later.
    #[test]
    fn prices_of_the_same_time_are_compared() {
        let short = priced("path", 20.0, 1.0);
        let long = Priced { name: "nee", prices: vec![price(10.0, 1.0), price(5.0, 1.0)] };
        assert_eq!(short.ratio(&long).expect("a ratio").value.value, 2.0);
        assert_eq!(long.ratio(&short).expect("a ratio").value.value, 0.5);
    }

    /// A price without the rare bright samples is too low: it keeps the default, and replaces it only if it is lower by far.
    #[test]
    fn unsure_prices_are_doubted() {
        assert_eq!(best(Choice::Integrator, &[unsure("nee", 0.1), priced("path", 9.0, 1.5)]), 0);
        assert_eq!(best(Choice::Integrator, &[priced("path", 9.0, 1.5), unsure("nee", 9.0 / 10.3)]), 0);
        assert_eq!(best(Choice::Integrator, &[priced("path", 9.0, 1.5), unsure("nee", 9.0 / 10.4)]), 1);
        assert_eq!(best(Choice::Sampler, &[unsure("sobol", 100.0), priced("halton", 9.0, 1.5)]), 0);
        assert_eq!(best(Choice::Sampler, &[priced("sobol", 100.0, 1.5), priced("halton", 9.0, 1.5)]), 1);
        assert_eq!(best(Choice::Integrator, &[unsure("path", 100.0), priced("nee", 9.0, 1.5), unsure("light", 5.0)]), 1);
    }

    #[test]
    fn the_reason_names_all_candidates() {
        let list = [
            priced("nee", 9.0, 1.0),
            priced("path", 90.0, 1.5),
            unsure("card", 450.0),
            unsure("whitted", 18.0),
            black("light"),
            priced("far", 1.0, 1e3),
        ];
        let others = "path 10 times as long (6.7–15), card at least 5 times as long, whitted cannot be told, light found no light, \
                      far cannot be told";
        let reason_of = |list: &[Priced]| reason(Choice::Integrator, list, 0);
        assert_eq!(reason_of(&list), format!("nee; to the same error, {others}"));
        assert_eq!(reason_of(&list[..1]), "nee, the only one that simulates what the scene calls for");
        assert_eq!(reason_of(&[black("nee"), black("path")]), "nee, the default, since no pilot tells an error");
        let said = reason_of(&[unsure("nee", 9.0), priced("path", 990.0, 1.0)]);
        assert_eq!(said, "nee, though its noise is too uneven for a sure price; path at least 11 times as long");
        let samplers = |list: &[Priced]| reason(Choice::Sampler, list, 0);
        let said = samplers(&[priced("sobol", 9.0, 1.5), unsure("halton", 900.0)]);
        assert_eq!(said, "sobol, the default, since the noise is too uneven to compare samplers");
        assert_eq!(samplers(&[black("sobol"), black("halton")]), "sobol, the default, since no pilot tells an error");
    }

    /// The pilot's picture has the shape of the picture and of its crop, and is never larger.
    #[test]
    fn the_pilot_is_small_and_shows_the_same() {
        for (size, crop) in [([1920, 1080], [0, 0, 1920, 1080]), ([20, 10], [0, 0, 20, 10]), ([4000, 10], [3000, 9, 3001, 10])] {
            let [x0, y0, x1, y1] = crop;
            let film = FilmSpec { crop: Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) }, ..FilmSpec::new(size[0], size[1]) };
            let pilot = film.with_pixels(PIXELS);
            let (count, before) = (pilot.crop.size().element_product(), film.crop.size().element_product());
            assert!(count > 0 && count <= before && (before < 3072 || count.abs_diff(3072) < 100), "{size:?}: {count}");
            assert!((pilot.aspect() / film.aspect() - 1.0).abs() < 0.02, "{size:?}");
            assert!(pilot.crop.max.cmple(pilot.size).all(), "{size:?}");
        }
    }
}
