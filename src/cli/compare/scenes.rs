//! Further scenes of a comparison: other versions of the first one, such as other materials or settings, with the same pixels.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{CompareArgs, MethodConfig, Precision, configs};
use crate::cli::load::{Loaded, Override, load};
use crate::cli::note;
use crate::cli::quote::quoted;
use crate::cli::render::resized;
use crate::double::{self, DoublePath};
use crate::error::{Error, Result};
use crate::film::FilmSpec;
use crate::integrator::Entry;

/// A further scene.
pub struct OtherScene {
    /// File of the scene.
    path: PathBuf,
    /// The scene.
    pub loaded: Loaded,
}

/// Loads the further scenes with the overrides of the first and its size.
///
/// # Errors
/// Those of [`load`]; `Usage` for stdin, which is read once.
pub fn load_others(args: &CompareArgs, first: &Loaded, tables: &[&[Entry]]) -> Result<Vec<OtherScene>> {
    let one = |path: &PathBuf| {
        if path.as_path() == Path::new("-") {
            return Err(Error::Usage("expected files for the further scenes; only the first is read from stdin".into()));
        }
        let loaded = load(&args.scene.with_path(path), &same_pixels(&first.film), None, tables)?;
        loaded.warnings.iter().for_each(|warning| note(&format!("warning: {}: {warning}", path.display())));
        Ok(OtherScene { path: path.clone(), loaded })
    };
    args.others.iter().map(one).collect()
}

/// Overrides that give a scene these pixels.
fn same_pixels(film: &FilmSpec) -> Vec<Override> {
    let [min, max] = [film.crop.min, film.crop.max];
    let crop = format!("{:?}", [min.x, max.x, min.y, max.y]);
    let mut list = resized(film.size.to_array());
    list.iter_mut().filter(|change| change.pointer == "/film/crop").for_each(|change| change.value.clone_from(&crop));
    list
}

/// Every method on every scene. With several scenes the names of the methods have those of the scenes.
///
/// # Errors
/// Those of [`configs`] and [`in_precisions`]; `Usage` for a scene that is there twice.
pub fn contestants(args: &CompareArgs, first: &Loaded, others: &[OtherScene], tables: &[&[Entry]]) -> Result<Vec<MethodConfig>> {
    let of = |loaded: &Loaded| in_precisions(args, loaded, configs(loaded, &args.integrators, &args.samplers, tables)?);
    if others.is_empty() {
        return of(first);
    }
    // Scenes of one name in different folders are told apart by their paths.
    let stems = || others.iter().map(|other| &other.loaded.stem).chain([&first.stem]);
    let is_shared = |stem: &String| stems().filter(|name| *name == stem).count() > 1;
    let label = |loaded: &Loaded, path: &Path| if is_shared(&loaded.stem) { path.display().to_string() } else { loaded.stem.clone() };
    let own = label(first, args.scene.path()?);
    let mut all: Vec<MethodConfig> = of(first)?.into_iter().map(|config| config.on_scene(&own, None)).collect();
    for OtherScene { path, loaded } in others {
        let (label, file) = (label(loaded, path), quoted(&path.display().to_string()));
        for mut config in of(loaded)? {
            // The replicates of all scenes have the same seeds, which the report states.
            config.sampler.seed = first.sampler.seed;
            all.push(config.on_scene(&label, Some(file.clone())));
        }
    }
    let is_twice = |(index, config): (usize, &MethodConfig)| all[..index].iter().any(|before| before.name == config.name);
    if let Some(twice) = all.iter().enumerate().find(|(index, config)| is_twice((*index, config))) {
        return Err(Error::Usage(format!("expected different scenes: two methods would be called {}", twice.1.name)));
    }
    Ok(all)
}

/// The methods in the precisions that are asked for.
///
/// # Errors
/// `Usage` for double precision without the integrator `path`, or alone with others; those of [`DoublePath::new`].
fn in_precisions(args: &CompareArgs, loaded: &Loaded, single: Vec<MethodConfig>) -> Result<Vec<MethodConfig>> {
    let has = |precision| args.precision.contains(&precision);
    let mut double: Vec<MethodConfig> = vec![];
    if has(Precision::F64) {
        double = single.iter().filter(|config| config.integrator_name == "path").cloned().collect();
        if double.is_empty() {
            return Err(Error::Usage("--precision f64: only the integrator path has it; --integrators path".into()));
        }
        let integrator = Arc::new(DoublePath::new(loaded)?);
        for config in &mut double {
            config.name = config.name.replacen("path", double::NAME, 1);
            config.integrator_name = double::NAME.into();
            config.integrator = integrator.clone();
        }
    }
    if let (false, Some(other)) = (has(Precision::F32), single.iter().find(|config| config.integrator_name != "path")) {
        return Err(Error::Usage(format!("--precision f64: {} has single precision only; --precision f32,f64", other.integrator_name)));
    }
    Ok(if has(Precision::F32) { [single, double].concat() } else { double })
}
