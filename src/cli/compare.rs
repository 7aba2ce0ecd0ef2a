//! `pt compare SCENE`: what accuracy costs in time, method against method.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use super::load::{Loaded, load};
use super::progress::Progress;
use super::{args, note, render, say, signals};
use crate::compare::{self, Comparison, Contestant, Effort, Reference, conclusions};
use crate::error::{Error, Fault, Result};
use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::{self, Entry};
use crate::measure::RelativeError;
use crate::measure::words::{duration, per_cent};
use crate::output::{self, exr};
use crate::render::{Render, Settings};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;

/// Where nothing else is asked for: so many pixels, and so long for each method and for the reference.
const PIXELS: u32 = 1 << 16;
const TIME: Duration = Duration::from_secs(8);

pub fn compare(args: &args::Compare, tables: &[&[Entry]]) -> Result<ExitCode> {
    let loaded = sized(args, tables)?;
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let contestants = contestants(args, &loaded, tables)?;
    let given = args.reference.as_deref().map(|path| given(path, &loaded.built.film)).transpose()?;
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}-report", loaded.stem)));
    std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
    signals::catch()?;
    render::pool(args.threads)?.install(|| measure(args, loaded, contestants, given, &folder, tables))
}

/// The scene, made smaller where no size is asked for: how errors fall does not depend on how many pixels show it.
fn sized(args: &args::Compare, tables: &[&[Entry]]) -> Result<Loaded> {
    if let Some(size) = args.size {
        return load(&args.scene, &render::resized(size), None, tables);
    }
    let loaded = load(&args.scene, &[], None, tables)?;
    let [width, height] = loaded.built.film.size.to_array();
    if loaded.built.film.crop.pixel_count() <= PIXELS.into() {
        return Ok(loaded);
    }
    let scale = (f64::from(PIXELS) / (f64::from(width) * f64::from(height))).sqrt();
    let smaller = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    note(&format!("compared at {}×{} pixels instead of {width}×{height}; --size asks for more", smaller[0], smaller[1]));
    load(&args.scene, &render::resized(smaller), None, tables)
}

/// Every integrator with every sampler.
fn contestants(args: &args::Compare, loaded: &Loaded, tables: &[&[Entry]]) -> Result<Vec<Contestant>> {
    let effects = loaded.built.world.effects();
    let samplers: Vec<Kind> = match &args.samplers[..] {
        [] => vec![loaded.built.sampler.kind],
        names => names.iter().map(|name| render::sampler_named(name)).collect::<Result<_>>()?,
    };
    let mut all = vec![];
    for name in &args.integrators {
        let (entry, integrator) = loaded.choose(tables, name)?;
        for kind in &samplers {
            let sampler_name = Kind::ALL.iter().find(|row| row.0 == *kind).map_or("", |row| row.1);
            let name = if samplers.len() > 1 { format!("{} · {sampler_name}", entry.name) } else { entry.name.to_owned() };
            let lacks = effects - entry.simulates;
            all.push(Contestant {
                name,
                integrator_name: entry.name.into(),
                sampler_name: sampler_name.into(),
                integrator: integrator.clone(),
                sampler: SamplerSpec { kind: *kind, ..loaded.built.sampler },
                lacks: if lacks.is_empty() { String::new() } else { lacks.to_string() },
            });
        }
    }
    Ok(all)
}

/// A reference from a file: the same pixels, all of them numbers.
fn given(path: &Path, film: &FilmSpec) -> Result<Reference> {
    let (image, _) = exr::read(path)?;
    let refused = |text: String| Error::invalid(Fault::new(text).in_file(path));
    render::same_pixels(path, &image, film)?;
    if let Some(missing) = ["R", "G", "B"].into_iter().find(|name| image.channel(name).is_none()) {
        return Err(refused(format!("the reference has no channel {missing}")));
    }
    let broken = image.pixels().flatten().filter(|value| !value.is_finite()).count();
    if broken > 0 {
        return Err(refused(format!("the reference has {broken} values that are no numbers")));
    }
    Ok(Reference { image, origin: path.display().to_string(), error: None })
}

fn measure(
    args: &args::Compare,
    loaded: Loaded,
    contestants: Vec<Contestant>,
    given: Option<Reference>,
    folder: &Path,
    tables: &[&[Entry]],
) -> Result<ExitCode> {
    let spec = loaded.built.film.clone().without_layers();
    let judge = loaded.choose(tables, args.reference_integrator.as_deref().unwrap_or(integrator::DEFAULT))?;
    let sampler = SamplerSpec { kind: Kind::Sobol, seed: loaded.built.sampler.seed.wrapping_sub(1), spp: 0, scramblings: 8 };
    let stem = loaded.stem.clone();
    let scene: Arc<dyn Scene> = Arc::new(loaded.built.world);
    let time = args.time.unwrap_or(TIME);
    let interrupted = || Error::Interrupted(signals::caught().unwrap_or_default());
    let reference = match given {
        Some(reference) => reference,
        None => computed(&scene, &spec, &judge, &sampler, args.reference_time.unwrap_or(time)).ok_or_else(interrupted)?,
    };
    if reference.image.pixels().flatten().all(|value| value == 0.0) {
        return Err(Error::invalid(Fault::new(format!("{} is black: there is nothing to compare", reference.origin)).in_file(&stem)));
    }
    let effort = Effort {
        replicates: args.replicates,
        samples: args.spp.map_or(1 << 30, u64::from),
        // With samples alone the clock has no say.
        time: if args.spp.is_some() && args.time.is_none() { None } else { Some(time) },
    };
    let count = contestants.len() as u32;
    let progress = Progress::new(args.progress, &spec, u32::MAX.into(), Some(effort.time.unwrap_or(time) * count));
    let methods = compare::run(&scene, &spec, contestants, &effort, &reference, args.confidence, &progress).ok_or_else(interrupted)?;
    progress.finish();
    let conclusions = conclusions(&methods);
    let comparison = Comparison { scene: stem, reference, methods, confidence: args.confidence, conclusions };
    output::write(&folder.join("reference.exr"), &comparison.reference.image, &vec![], &output::Tonemap::default())?;
    compare::report::write(&comparison, folder, args.jeri)?;
    say(&summary(&comparison, folder))?;
    Ok(ExitCode::SUCCESS)
}

/// By the most trusted method, for a time; with its own error told.
fn computed(
    scene: &Arc<dyn Scene>,
    spec: &FilmSpec,
    (entry, judge): &(Entry, Arc<dyn integrator::Integrator>),
    sampler: &SamplerSpec,
    time: Duration,
) -> Option<Reference> {
    let progress = Progress::new(args::Progress::None, &spec, u32::MAX.into(), Some(time));
    let mut film = MomentFilm::new(spec.clone());
    let mut render = Render::new(scene.clone(), &**judge, spec, &Settings::new(*sampler));
    render.advance_for(time, u32::MAX.into(), &mut film, &progress);
    if render.report().cancelled {
        return None;
    }
    let error = RelativeError::of(&film).map(|error| error.value);
    let image: Image = film.image();
    Some(Reference { image, origin: format!("a reference by {}, {} spp", entry.name, film.samples()), error })
}

fn summary(comparison: &Comparison, folder: &Path) -> String {
    let known = comparison.reference.error.map_or(String::new(), |error| format!(", relative error {} %", per_cent(error)));
    let mut text = format!("against {}{known}\n", comparison.reference.origin);
    for method in &comparison.methods {
        let Some(last) = method.curve.last() else { continue };
        let slope = method.slope.map_or(String::new(), |(slope, error)| format!(" · slope −{slope:.2} ± {error:.2}"));
        let error = per_cent(last.relmse.0.max(0.0).sqrt());
        text += &format!("{}: {} spp · {} · error {error} %{slope}\n", method.name, last.samples, duration(last.seconds));
    }
    comparison.conclusions.iter().for_each(|sentence| text += &format!("{sentence}\n"));
    text + &format!("{}\n", folder.join("index.html").display())
}
