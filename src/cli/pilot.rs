//! Price list: what accuracy costs, estimated by a short pilot render.

use std::sync::Arc;
use std::time::Duration;

use super::load::Loaded;
use crate::error::Result;
use crate::film::{FilmSpec, MomentFilm};
use crate::integrator::{Entry, Integrator};
use crate::measure::format;
use crate::measure::{ErrorHistory, ErrorObserver, StopCondition, render_until};
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
        let until = StopCondition { samples: u32::MAX.into(), time: Some(time), target: None };
        (entry.name, render_until(&mut render, &mut film, &until, observer))
    });
    print(&rows.collect::<Vec<_>>(), confidence)
}

/// Text of the list, from the history of each integrator.
pub fn print(rows: &[(&str, ErrorHistory)], confidence: f64) -> String {
    let cell = |history: &ErrorHistory, target: f64| history.price(target, confidence).map_or("–".into(), |price| format::price(&price));
    let mut table =
        vec![["".to_owned()].into_iter().chain(format::TARGETS.map(|t| format!("{} %", format::per_cent(t)))).collect::<Vec<_>>()];
    table.extend(
        rows.iter().map(|(name, history)| [(*name).to_owned()].into_iter().chain(format::TARGETS.map(|t| cell(history, t))).collect()),
    );
    let width = |c: usize| table.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
    let line = |row: &Vec<String>| {
        let cells = row.iter().enumerate().map(|(c, text)| format!("{text}{}", " ".repeat(width(c) - text.chars().count())));
        cells.collect::<Vec<_>>().join("   ").trim_end().to_owned()
    };
    let mut text = format!("what a relative error costs in time ({} % intervals):\n", format::per_cent(confidence));
    text.extend(table.iter().map(|row| line(row) + "\n"));
    for (name, history) in rows {
        text += &match history.last().and_then(|last| last.error) {
            Some(error) if !error.is_established() => {
                format!("{name}: cannot be established (heavy tail: a few pixels hold all the noise)\n")
            }
            Some(error) if error.is_vague() => format!("{name}: still too noisy to tell: a longer pilot may (--pilot)\n"),
            _ => String::new(),
        };
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
