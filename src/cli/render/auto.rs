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
use crate::measure::{ErrorHistory, Forecast, StopCondition, render_until};
use crate::render::{Render, Settings, Silent};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;

/// Render time of each candidate.
const TIME: Duration = Duration::from_millis(400);

/// Pixels of the pilot's picture, about.
const PIXELS: f32 = 3072.0;

/// Confidence of prices, and with which a candidate must be cheaper than the default to replace it.
const CONFIDENCE: f64 = 0.95;

/// Factor by which the time of a sample may differ from one moment of a machine to another.
const CLOCK: f64 = 1.1;

/// Ratio of the ends of an interval from which on it tells nothing.
const TELLING: f64 = 1e4;

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
    if integrators {
        let candidates = integrator_candidates(args, &loaded, tables)?;
        let chosen = pilot(args, &loaded, candidates, |candidate| candidate.entry.name, Choice::Integrator)?;
        loaded.select(chosen.entry, chosen.integrator);
    }
    if samplers {
        let own = loaded.sampler;
        let others = SAMPLERS.into_iter().filter(|kind| *kind != own.kind).map(|kind| SamplerSpec { kind, ..own });
        let candidate = |sampler| PricedIntegrator { entry: loaded.entry, integrator: loaded.integrator.clone(), sampler };
        let candidates = std::iter::once(own).chain(others).map(candidate).collect();
        let chosen = pilot(args, &loaded, candidates, |candidate| candidate.sampler.kind.name(), Choice::Sampler)?;
        loaded.select_sampler(chosen.sampler.kind)?;
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

/// Renders with each candidate and returns the one to use; the first is the default.
fn pilot(
    args: &RenderArgs,
    loaded: &Loaded,
    candidates: Vec<PricedIntegrator>,
    name: impl Fn(&PricedIntegrator) -> &'static str,
    what: Choice,
) -> Result<PricedIntegrator> {
    let start = Instant::now();
    let spec = loaded.film.with_pixels(PIXELS);
    let error = args.target.unwrap_or(ERROR);
    let price = |candidate: &PricedIntegrator| {
        let settings = Settings { clamp: args.clamp, ..Settings::new(candidate.sampler) };
        let mut film = MomentFilm::new(spec.clone());
        let mut render = Render::new(loaded.world.clone(), &*candidate.integrator, &spec, &settings);
        let until = StopCondition { samples: u32::MAX.into(), time: Some(TIME), target: None };
        let history = render_until(&mut render, &mut film, &until, &Silent);
        Priced::of(name(candidate), &history, error)
    };
    let priced: Vec<Priced> = candidates.iter().map(price).collect();
    let chosen = best(what, &priced);
    note(&format!(
        "note: {} {AUTO}: {} (pilot of {})",
        what.flag(),
        reason(&priced, chosen),
        format::duration(start.elapsed().as_secs_f64())
    ));
    candidates.into_iter().nth(chosen).ok_or_else(|| Error::Internal("the pilot has no candidate".into()))
}

/// A candidate and the time that it takes to the error.
struct Priced {
    name: &'static str,
    /// `None` if the pilot found no light.
    price: Option<Forecast>,
    /// Whether the error of the pilot can be stated. Otherwise the price may be wrong by the factor [`UNSURE`].
    is_sure: bool,
}

impl Priced {
    /// Time to an error, from the history of a pilot.
    fn of(name: &'static str, history: &ErrorHistory, error: f64) -> Priced {
        let sure = history.price(error, CONFIDENCE);
        let price = sure.or_else(|| {
            let last = history.last()?;
            let found = last.error?;
            // The error falls with the square root of the time.
            let value = last.seconds * (found.value / error).powi(2);
            Some(Forecast { value, low: value / UNSURE, high: value * UNSURE })
        });
        // No picture takes less than a sample of each pixel.
        let least = history.last().map_or(0.0, |last| last.seconds / last.samples as f64);
        let at_least = |Forecast { value, low, high }| Forecast {
            value: f64::max(value, least),
            low: f64::max(low, least / CLOCK),
            high: f64::max(high, least * CLOCK),
        };
        Priced { name, price: price.map(at_least), is_sure: sure.is_some() }
    }

    /// Ratio of this price to another, with the interval that both uncertainties give.
    fn ratio(&self, other: &Priced) -> Option<Forecast> {
        let (own, other) = (self.price?, other.price?);
        let spread = |price: Forecast| 0.5 * (price.high / price.low).ln();
        let (value, factor) = (own.value / other.value, spread(own).hypot(spread(other)).exp());
        Some(Forecast { value, low: value / factor, high: value * factor })
    }
}

/// Index of the candidate that is cheapest with all uncertainty against it, if it is then cheaper than the first, and of the first
/// otherwise.
///
/// - `what`: samplers serve one method: where the noise of one is uneven, the others have not met its rare bright samples yet, and none
///   is trusted
fn best(what: Choice, priced: &[Priced]) -> usize {
    let Some(default) = priced.first() else { return 0 };
    if what == Choice::Sampler && priced.iter().any(|candidate| !candidate.is_sure) {
        return 0;
    }
    let at_most = |candidate: &Priced| match candidate.ratio(default) {
        Some(ratio) => ratio.high,
        // Any light is better than none.
        None if default.price.is_none() && candidate.price.is_some() => 0.0,
        None => f64::INFINITY,
    };
    let others = (1..priced.len()).map(|k| (k, at_most(&priced[k])));
    others.filter(|(_, at_most)| *at_most < 1.0).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k)
}

/// The choice and what the others would take, in words.
fn reason(priced: &[Priced], chosen: usize) -> String {
    let name = priced[chosen].name;
    let other = |other: &Priced| match other.ratio(&priced[chosen]) {
        Some(Forecast { value, low, high }) if high / low < TELLING => {
            let [value, low, high] = [value, low, high].map(format::two_digits);
            let least = if other.is_sure { "" } else { "at least " };
            format!("{} {least}{value} times as long ({low}–{high})", other.name)
        }
        Some(_) => format!("{} cannot be told", other.name),
        None => format!("{} found no light", other.name),
    };
    let others: Vec<String> = priced.iter().filter(|priced| priced.name != name).map(other).collect();
    match (priced[chosen].price, priced[chosen].is_sure) {
        _ if others.is_empty() => format!("{name}, the only one that simulates what the scene calls for"),
        (Some(_), true) => format!("{name}; to the same error, {}", others.join(", ")),
        (Some(_), false) => format!("{name}, though its noise is too uneven for a sure price; {}", others.join(", ")),
        (None, _) => format!("{name}, the default, since no pilot tells an error"),
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::film::{Crop, FilmSpec};

    fn priced(name: &'static str, value: f64, factor: f64) -> Priced {
        Priced { name, price: Some(Forecast { value, low: value / factor, high: value * factor }), is_sure: true }
    }

    fn unsure(name: &'static str, value: f64) -> Priced {
        Priced { is_sure: false, ..priced(name, value, UNSURE) }
    }

    fn black(name: &'static str) -> Priced {
        Priced { name, price: None, is_sure: false }
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
        let list = [priced("nee", 9.0, 1.0), priced("path", 90.0, 1.5), unsure("card", 18.0), black("light"), priced("far", 1.0, 1e3)];
        let others = "path 10 times as long (6.7–15), card at least 2 times as long (0.2–20), light found no light, far cannot be told";
        assert_eq!(reason(&list, 0), format!("nee; to the same error, {others}"));
        assert_eq!(reason(&list[..1], 0), "nee, the only one that simulates what the scene calls for");
        assert_eq!(reason(&[black("nee"), black("path")], 0), "nee, the default, since no pilot tells an error");
        let said = reason(&[unsure("nee", 9.0), priced("path", 90.0, 1.0)], 0);
        assert_eq!(said, "nee, though its noise is too uneven for a sure price; path 10 times as long (1–100)");
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
