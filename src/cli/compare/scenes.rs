//! Further scenes of a comparison: other versions of the first one, such as other materials or settings, with the same pixels.

use std::path::{Path, PathBuf};

use super::{CompareArgs, MethodConfig, configs};
use crate::cli::load::{Loaded, Override, load};
use crate::cli::note;
use crate::cli::quote::quoted;
use crate::cli::render::resized;
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
/// Those of [`configs`]; `Usage` for a scene that is there twice.
pub fn contestants(args: &CompareArgs, first: &Loaded, others: &[OtherScene], tables: &[&[Entry]]) -> Result<Vec<MethodConfig>> {
    let of = |loaded: &Loaded| configs(loaded, &args.integrators, &args.samplers, tables);
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
