//! `pt list`: lists what can be chosen, with one line each.

use super::print_stdout;
use crate::describe;
use crate::error::Result;
use crate::film::Layer;
use crate::import;
use crate::integrator::Entry;
use crate::measure::metric;
use crate::sampler::Kind;
use clap::ValueEnum;

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    Integrators,
    Samplers,
    Shapes,
    Materials,
    Textures,
    Lights,
    Meters,
    Cameras,
    Filters,
    /// Layers beside the picture.
    Aovs,
    Metrics,
    /// Scene files that can be read.
    Dialects,
}

/// Runs the command.
pub fn list(what: Option<Family>, tables: &[&[Entry]]) -> Result<()> {
    const ALL: [Family; 12] = [
        Family::Integrators,
        Family::Samplers,
        Family::Shapes,
        Family::Materials,
        Family::Textures,
        Family::Lights,
        Family::Meters,
        Family::Cameras,
        Family::Filters,
        Family::Aovs,
        Family::Metrics,
        Family::Dialects,
    ];
    let mut text = String::new();
    for family in ALL.into_iter().filter(|family| what.is_none_or(|w| w == *family)) {
        let rows = rows(family, tables);
        let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        if what.is_none() {
            text += &format!("{}\n", format!("{family:?}").to_lowercase());
        }
        for (name, about) in rows {
            text += &format!("  {name:width$}  {about}\n");
        }
    }
    print_stdout(&text)
}

fn rows(family: Family, tables: &[&[Entry]]) -> Vec<(String, String)> {
    let pair = |name: &str, about: &str| (name.to_owned(), about.to_owned());
    match family {
        Family::Integrators => tables.iter().copied().flatten().map(|entry| pair(entry.name, entry.about)).collect(),
        Family::Samplers => Kind::ALL.iter().map(|(_, name, about)| pair(name, about)).collect(),
        Family::Shapes => describe::members("Shape"),
        Family::Materials => describe::members("Material"),
        Family::Textures => describe::members("Texture"),
        Family::Lights => describe::members("Light"),
        Family::Meters => describe::members("Meter"),
        Family::Cameras => describe::members("Camera"),
        Family::Filters => describe::members("Filter"),
        Family::Dialects => import::ALL.iter().map(|dialect| pair(dialect.name, dialect.about)).collect(),
        Family::Aovs => Layer::ALL.iter().map(|(_, name, about)| pair(name, about)).collect(),
        Family::Metrics => metric::ALL.iter().map(|kind| (kind.name.into(), kind.about())).collect(),
    }
}
