//! `pt compare SCENE`: what accuracy costs in time, method against method.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use super::load::{Loaded, load};
use super::progress::Progress;
use super::reference::{self, Judge};
use super::{args, note, render, say, signals};
use crate::compare::{self, Comparison, Contestant, Effort, Reference, conclusions};
use crate::error::{Error, Fault, Result};
use crate::film::FilmSpec;
use crate::integrator::Entry;
use crate::measure::words::{duration, per_cent};
use crate::measure::{Metric, RelativeError, Until};
use crate::output::{self, exr};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;

/// Where nothing else is asked for: so many pixels, and so long for each method and for the reference.
const PIXELS: u32 = 1 << 16;
const TIME: Duration = Duration::from_secs(8);

pub fn compare(args: &args::Compare, tables: &[&[Entry]]) -> Result<ExitCode> {
    let loaded = sized(args, tables)?;
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    args.metric.iter().try_for_each(|name| Metric::parse(name).map(drop))?;
    let contestants = contestants(args, &loaded, tables)?;
    let given = args.reference.as_deref().map(|path| given(path, &loaded.built.film)).transpose()?;
    let folder = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}-report", loaded.stem)));
    std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
    signals::catch()?;
    render::pool(args.work.threads)?.install(|| measure(args, loaded, contestants, given, &folder, tables))
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
    let judge = Judge::new(&loaded, args.reference_integrator.as_deref(), tables)?;
    let kept = reference::cache(args.cache.as_deref()).ok().map(|cache| judge.path(&cache)).filter(|path| path.exists());
    let stem = loaded.stem.clone();
    let scene: Arc<dyn Scene> = Arc::new(loaded.built.world);
    let time = args.time.unwrap_or(TIME);
    let interrupted = || Error::Interrupted(signals::caught().unwrap_or_default());
    let reference = match given {
        Some(reference) => reference,
        None => {
            let time = args.reference_time.unwrap_or(time);
            computed(&scene, &judge, kept, time)?.ok_or_else(interrupted)?
        }
    };
    if reference.image.pixels().flatten().all(|value| value == 0.0) {
        return Err(Error::invalid(Fault::new(format!("{} is black: there is nothing to compare", reference.origin)).in_file(&stem)));
    }
    let effort = Effort {
        replicates: args.replicates,
        samples: args.spp.map_or(1 << 30, u64::from),
        // With samples alone the clock has no say.
        time: if args.spp.is_some() && args.time.is_none() { None } else { Some(time) },
        metrics: args.metric.iter().map(|name| Metric::parse(name)).collect::<Result<_>>()?,
    };
    let count = contestants.len() as u32;
    let progress = Progress::new(args.work.progress, &spec, u32::MAX.into(), Some(effort.time.unwrap_or(time) * count));
    let methods = compare::run(&scene, &spec, contestants, &effort, &reference, args.confidence, &progress).ok_or_else(interrupted)?;
    progress.finish();
    let conclusions = conclusions(&methods);
    let comparison = Comparison { scene: stem, reference, methods, metrics: effort.metrics, confidence: args.confidence, conclusions };
    output::write(&folder.join("reference.exr"), &comparison.reference.image, &vec![], &output::Tonemap::default())?;
    compare::report::write(&comparison, folder, args.jeri)?;
    remark_coarse_reference(&comparison);
    say(&summary(&comparison, folder))?;
    Ok(ExitCode::SUCCESS)
}

/// By the most trusted method: one that is kept, taken on for as long as is asked for, or else one for a time.
fn computed(scene: &Arc<dyn Scene>, judge: &Judge, kept: Option<PathBuf>, time: Duration) -> Result<Option<Reference>> {
    let progress = Progress::new(args::Progress::None, &judge.spec, u32::MAX.into(), Some(time));
    let before = kept.as_ref().and_then(|path| judge.kept(path));
    let (known, origin) =
        (before.as_ref().map_or(0, |kept| kept.report.samples), if before.is_some() { "the kept reference" } else { "a reference" });
    let until = Until { samples: u32::MAX.into(), time: Some(time), target: None };
    let made = judge.rendered(scene, before, &until, &progress);
    if let Some(path) = kept.filter(|_| known > 0 && made.report.samples > known) {
        judge.keep(&path, &made)?;
    }
    if made.report.cancelled {
        return Ok(None);
    }
    let error = RelativeError::of(&made.film).map(|error| error.value);
    let origin = format!("{origin} by {}, {} spp", judge.entry.name, made.film.samples());
    Ok(Some(Reference { image: made.film.image(), origin, error }))
}

/// A reference is good for what is compared where its variance is a tenth of theirs.
fn remark_coarse_reference(comparison: &Comparison) {
    let Some(own) = comparison.reference.error else { return };
    let last = |method: &compare::Method| method.curve.last().map(|last| (last.relmse.0, method.name.clone()));
    let best = comparison.methods.iter().filter_map(last).filter(|(relmse, _)| *relmse > 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((relmse, name)) = best.filter(|(relmse, _)| 10.0 * own * own > *relmse) {
        let needed = per_cent((relmse / 10.0).sqrt());
        let [width, height] = comparison.reference.image.size.to_array();
        let wish = format!("pt reference --size {width}x{height} --error {needed}%");
        note(&format!("note: the reference's variance is more than a tenth of that of {name}; {wish} makes one that is better"));
    }
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
