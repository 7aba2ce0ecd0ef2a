//! Price list: what accuracy costs, estimated by a short pilot render.

use std::sync::Arc;
use std::time::Duration;

use super::load::Loaded;
use crate::error::Result;
use crate::film::{FilmSpec, MomentFilm};
use crate::integrator::{Entry, Integrator};
use crate::measure::format;
use crate::measure::{ErrorHistory, ErrorObserver, Refusal, StopCondition, render_until};
use crate::render::{Render, Settings};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;

/// Integrator of the list.
pub struct PricedIntegrator {
    /// Table row of the integrator.
    pub entry: Entry,
    /// The integrator.
    pub integrator: Arc<dyn Integrator>,
    /// Sampler with which it would render.
    pub sampler: SamplerSpec,
}

/// Renders for a time with each integrator, discards the pictures, and returns the list.
pub fn price_list(
    scene: &Arc<dyn Scene>,
    spec: &FilmSpec,
    settings: &Settings,
    who: &[PricedIntegrator],
    time: Duration,
    confidence: f64,
    observer: &dyn ErrorObserver,
) -> String {
    let spec = &spec.clone().without_layers();
    let rows = who.iter().map(|PricedIntegrator { entry, integrator, sampler }| {
        let mut film = MomentFilm::new(spec.clone());
        let mut render = Render::new(scene.clone(), &**integrator, spec, &Settings { sampler: *sampler, ..settings.clone() });
        let until = StopCondition { samples: u32::MAX.into(), time: Some(time), target: None, patience: None };
        (entry.name, render_until(&mut render, &mut film, &until, observer))
    });
    print(&rows.collect::<Vec<_>>(), confidence)
}

/// Text of the list, from the history of each integrator: a line for each error, so that it fits on a terminal.
///
/// ```text
/// what a relative error costs in time (95 % intervals):
///   nee   10 %    0.8 s (0.75 s–0.86 s)
///         3 %     9.1 s (8.4 s–9.8 s)
/// ```
fn print(rows: &[(&str, ErrorHistory)], confidence: f64) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut text = format!("what a relative error costs in time ({} % intervals):\n", format::per_cent(confidence));
    for (name, history) in rows {
        if let Some(refusal) = history.last().and_then(|last| last.error?.refusal()) {
            let advice = if refusal == Refusal::TooNoisy { "; a longer --pilot may help" } else { "" };
            text += &format!("  {name:width$}   cannot be established: {refusal}{advice}\n");
            continue;
        }
        if history.last().is_none_or(|last| last.error.is_none()) {
            text += &format!("  {name:width$}   no error is told: too few samples, or no light\n");
            continue;
        }
        for (k, target) in format::TARGETS.into_iter().enumerate() {
            let name = if k == 0 { name } else { "" };
            let price = history.price(target, confidence).map_or("–".into(), |price| format::price(&price));
            text += &format!("  {name:width$}   {:7} {price}\n", format!("{} %", format::per_cent(target)));
        }
    }
    text.trim_end().to_owned()
}

/// Integrators of these names, or the one that renders.
pub fn selected_integrators(loaded: &Loaded, names: &[String], tables: &[&[Entry]]) -> Result<Vec<PricedIntegrator>> {
    let priced = |(entry, integrator): (Entry, Arc<dyn Integrator>)| PricedIntegrator {
        sampler: loaded.sampler_for(&*integrator),
        entry,
        integrator,
    };
    if names.is_empty() {
        return Ok(vec![priced((loaded.entry, loaded.integrator.clone()))]);
    }
    names.iter().map(|name| loaded.choose(tables, name).map(priced)).collect()
}
