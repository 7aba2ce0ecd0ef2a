//! The methods of a comparison.

use super::MethodConfig;
use crate::error::Result;
use crate::integrator::Entry;
use crate::load::{Loaded, sampler_named};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene as _;

/// Every integrator with every sampler.
///
/// - `samplers`: names of samplers; empty for that of the scene
///
/// # Errors
/// `Usage` for an unknown name, `Invalid` for options of the scene that an integrator refuses.
pub fn configs(loaded: &Loaded, integrators: &[String], samplers: &[String], tables: &[&[Entry]]) -> Result<Vec<MethodConfig>> {
    let effects = loaded.world.effects();
    let samplers: Vec<Kind> = match samplers {
        [] => vec![loaded.sampler.kind],
        names => names.iter().map(|name| sampler_named(name)).collect::<Result<_>>()?,
    };
    let mut all = vec![];
    for name in integrators {
        let (entry, integrator) = loaded.choose(tables, name)?;
        for kind in &samplers {
            let sampler_name = kind.name();
            let name = if samplers.len() > 1 { format!("{} · {sampler_name}", entry.name) } else { entry.name.to_owned() };
            all.push(MethodConfig {
                name,
                scene: loaded.world.clone(),
                spec: loaded.film.clone().without_layers(),
                scene_file: None,
                integrator_name: entry.name.into(),
                sampler_name: sampler_name.into(),
                integrator: integrator.clone(),
                sampler: SamplerSpec { kind: *kind, ..loaded.sampler },
                most: None,
                lacks: entry.lacks(effects).unwrap_or_default(),
            });
        }
    }
    Ok(all)
}

impl MethodConfig {
    /// The method on one of several scenes.
    ///
    /// - `label`: name of the scene, which is added to that of the method
    /// - `file`: file of the scene, quoted for a shell; `None` for the scene of the comparison
    pub fn on_scene(self, label: &str, file: Option<String>) -> MethodConfig {
        MethodConfig { name: format!("{} · {label}", self.name), scene_file: file, ..self }
    }
}
