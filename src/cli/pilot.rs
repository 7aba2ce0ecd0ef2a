//! What accuracy costs, before it is paid for: the price list.

use std::sync::Arc;
use std::time::Duration;

use super::load::Loaded;
use crate::error::Result;
use crate::film::{FilmSpec, MomentFilm};
use crate::integrator::{Entry, Integrator};
use crate::measure::words;
use crate::measure::{Course, Until, Watcher, follow};
use crate::render::{Render, Settings};
use crate::scene::Scene;

/// Renders for so long with each integrator, throws the pictures away, and returns the list.
pub fn price_list(
    scene: &Arc<dyn Scene>,
    spec: &FilmSpec,
    settings: &Settings,
    who: &[(Entry, Arc<dyn Integrator>)],
    time: Duration,
    confidence: f64,
    watcher: &dyn Watcher,
) -> String {
    let spec = &spec.clone().without_layers();
    let rows = who.iter().map(|(entry, integrator)| {
        let mut film = MomentFilm::new(spec.clone());
        let mut render = Render::new(scene.clone(), &**integrator, spec, settings);
        let until = Until { samples: u32::MAX.into(), time: Some(time), target: None };
        (entry.name, follow(&mut render, &mut film, &until, watcher))
    });
    print(&rows.collect::<Vec<_>>(), confidence)
}

/// The list, of each integrator by its course so far.
pub fn print(rows: &[(&str, Course)], confidence: f64) -> String {
    let cell = |course: &Course, target: f64| course.price(target, confidence).map_or("–".into(), |price| words::price(&price));
    let mut table =
        vec![["".to_owned()].into_iter().chain(words::TARGETS.map(|t| format!("{} %", words::per_cent(t)))).collect::<Vec<_>>()];
    table.extend(
        rows.iter().map(|(name, course)| [(*name).to_owned()].into_iter().chain(words::TARGETS.map(|t| cell(course, t))).collect()),
    );
    let width = |c: usize| table.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
    let line = |row: &Vec<String>| {
        let cells = row.iter().enumerate().map(|(c, text)| format!("{text}{}", " ".repeat(width(c) - text.chars().count())));
        cells.collect::<Vec<_>>().join("   ").trim_end().to_owned()
    };
    let mut text = format!("what a relative error costs in time ({} % intervals):\n", words::per_cent(confidence));
    text.extend(table.iter().map(|row| line(row) + "\n"));
    for (name, course) in rows {
        text += &match course.last().and_then(|last| last.error) {
            Some(error) if !error.is_established() => {
                format!("{name}: cannot be established (heavy tail: a few pixels hold all the noise)\n")
            }
            Some(error) if error.is_vague() => format!("{name}: still too noisy to tell: a longer pilot may (--pilot)\n"),
            _ => String::new(),
        };
    }
    text.trim_end().to_owned()
}

/// The integrators named, or the one that renders.
pub fn whom(loaded: &Loaded, names: &[String], tables: &[&[Entry]]) -> Result<Vec<(Entry, Arc<dyn Integrator>)>> {
    if names.is_empty() {
        return Ok(vec![(loaded.entry, loaded.integrator.clone())]);
    }
    names.iter().map(|name| loaded.choose(tables, name)).collect()
}
