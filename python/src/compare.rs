//! Comparison of methods: what accuracy costs in time.

use std::path::PathBuf;
use std::sync::Arc;

use pt::compare::{self, Budget, Commands, Comparison, Provenance, Reference, ReferenceRenderer, conclusions, configs, report};
use pt::load::{Loaded, Settings};
use pt::measure::{Metric, StopCondition};
use pt::output::{self, Tonemap};
use pt::{Error, Fault};
use pyo3::prelude::*;

use crate::error::{detached, raised, usage};
use crate::picture::{Picture, share};
use crate::scene::{Scene, TABLES, duration, thread_count};
use crate::watch::{Watched, watched};

/// Samples per pixel of a replicate that only time limits.
const UNLIMITED: u64 = 1 << 30;
/// Time of each method, if neither a time nor a number of samples is given (s).
const TIME: f64 = 8.0;

/// Compares methods and writes the report into a folder.
///
/// - `words`: words of the command of the program that makes the same comparison
/// - `command`: that command, quoted for a shell, and the scene in it
#[pyfunction]
#[pyo3(name = "_compare")]
#[pyo3(signature = (scene, folder, integrators, samplers, spp, time, replicates, reference, reference_integrator, reference_time, metrics,
                    confidence, threads, words, command, scene_words))]
#[allow(clippy::too_many_arguments, reason = "the function is called from one place of the package")]
pub fn compare_methods(
    py: Python<'_>,
    scene: Py<Scene>,
    folder: PathBuf,
    integrators: Vec<String>,
    samplers: Vec<String>,
    spp: Option<i128>,
    time: Option<f64>,
    replicates: u32,
    reference: Option<Py<Picture>>,
    reference_integrator: Option<String>,
    reference_time: Option<f64>,
    metrics: Vec<String>,
    confidence: f64,
    threads: Option<i128>,
    words: Vec<String>,
    command: String,
    scene_words: String,
) -> PyResult<()> {
    let confidence = share(py, "confidence", confidence)?;
    if !(2..=256).contains(&replicates) {
        return Err(usage(py, format!("replicates: expected a whole number from 2 to 256, found {replicates}")));
    }
    let is_counted = spp.is_some() && time.is_none();
    let time = duration(py, time.unwrap_or(TIME))?;
    let reference_time = reference_time.map_or(Ok(time), |seconds| duration(py, seconds))?;
    let threads = threads.map(|threads| thread_count(py, threads)).transpose()?;
    let settings = Settings { spp, ..Settings::default() };
    let loaded = detached(py, || scene.get().changed(&settings, None))?;
    let given = match &reference {
        Some(picture) => {
            let picture = picture.get();
            Some(Reference::from_file(picture.image(py)?, "the reference".into(), picture.attributes_of().clone()))
        }
        None => None,
    };
    let (film, size) = (&loaded.film, given.as_ref().map(|reference| (reference.image.origin, reference.image.size)));
    if size.is_some_and(|size| size != (film.crop.min, film.crop.size())) {
        return Err(usage(py, "reference: expected a picture with the pixels of the scene"));
    }
    let Watched { result, interrupt } = watched(py, None, threads, vec![], |watch| {
        let metrics: Vec<Metric> = metrics.iter().map(|name| Metric::parse(name)).collect::<pt::Result<_>>()?;
        let configs = configs(&loaded, &integrators, &samplers, TABLES)?;
        let Loaded { world, sampler, stem, .. } = &loaded;
        let world: Arc<dyn pt::scene::Scene> = world.clone();
        let reference = match given {
            Some(reference) => reference,
            None => {
                let renderer = ReferenceRenderer::new(&loaded, reference_integrator.as_deref(), TABLES)?;
                let until = StopCondition { samples: u32::MAX.into(), time: Some(reference_time), target: None, patience: None };
                let made = renderer.render(&world, None, &until, watch);
                if made.report.cancelled {
                    return Ok(false);
                }
                renderer.reference(&made, "a reference", confidence)
            }
        };
        if reference.image.pixels().flatten().all(|value| value == 0.0) {
            return Err(Error::invalid(Fault::new(format!("{} is black: there is nothing to compare", reference.origin)).in_file(stem)));
        }
        let samples = if spp.is_some() { sampler.spp } else { UNLIMITED };
        let budget = Budget { replicates, samples, time: (!is_counted).then_some(time), metrics };
        let Some(methods) = compare::run(&configs, &budget, &reference, confidence, watch, &()) else { return Ok(false) };
        let mut provenance = Provenance::new(&loaded, command.clone(), words, replicates)?;
        provenance.reference_hash = output::hash(&reference.image).to_string();
        let [width, height] = reference.image.full_size.to_array();
        let commands = Commands {
            whole: command,
            scene: scene_words,
            options: String::new(),
            size: format!("--size {width}x{height}"),
            reference: folder.join("reference.exr").display().to_string(),
        };
        let conclusions = conclusions(&methods, &reference, confidence, &commands);
        let metrics = budget.metrics;
        let comparison = Comparison { scene: stem.clone(), reference, methods, metrics, confidence, conclusions, provenance };
        std::fs::create_dir_all(&folder).map_err(|failure| Error::io(&folder, failure))?;
        let Reference { image, attributes, .. } = &comparison.reference;
        output::write(&folder.join("reference.exr"), image, attributes, &Tonemap::default())?;
        report::write(&comparison, &folder, false)?;
        Ok(true)
    })?;
    match (interrupt, result) {
        (Some(interrupt), _) => Err(interrupt),
        (None, true) => Ok(()),
        (None, false) => Err(raised(py, &Error::Internal("the comparison was cancelled".into()))),
    }
}
