//! Tests of whether two methods, or two pictures, converge to the same picture.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pt::integrator::Integrator;
use pt::load::{Loaded, Settings};
use pt::measure::StopCondition;
use pt::measure::agreement::Conclusion;
use pt::measure::verify::{RenderedSide, Side, Verification, verify};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{detached, raised, usage, value};
use crate::integrator::{Failure, PythonIntegrator};
use crate::picture::{Picture, share};
use crate::scene::{Scene, TABLES, duration, thread_count};
use crate::watch::{Watched, watched};

/// What a side is before it is rendered.
enum Given {
    Side(Side),
    File(PathBuf),
    Method(&'static str, Arc<dyn Integrator>),
}

/// Tests whether two sides are estimates of the same picture, and returns a Verification.
///
/// Each side is a Picture, or, with `scene`, the name of an integrator, an object with a method `li` (see Scene.render), or the path of an EXR
/// file with standard errors.
///
/// - scene: scene that is rendered
/// - spp: samples per pixel of each rendered side; the scene's by default. At least 32 are needed.
/// - time: render time of each side in seconds
/// - alpha: risk of calling two sides different that are the same
/// - threads, progress: as for Scene.render
///
/// Rendered sides have random numbers of their own. Two pictures must have been rendered with different seeds.
///
/// Raises pt_renderer.Error for sides that cannot be compared, and KeyboardInterrupt on Ctrl-C.
#[pyfunction]
#[pyo3(name = "verify")]
#[pyo3(signature = (a, b, *, scene = None, spp = None, time = None, alpha = 0.01, threads = None, progress = None))]
#[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub fn verify_sides<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    scene: Option<Py<Scene>>,
    spp: Option<i128>,
    time: Option<f64>,
    alpha: f64,
    threads: Option<i128>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let alpha = share(py, "alpha", alpha)?;
    let time = time.map(|seconds| duration(py, seconds)).transpose()?;
    let threads = threads.map(|threads| thread_count(py, threads)).transpose()?;
    refuse_same_numbers(py, a, b)?;
    let settings = Settings { spp, ..Settings::default() };
    let loaded = scene.as_ref().map(|scene| detached(py, || scene.get().changed(&settings, None))).transpose()?;
    let failure = Arc::<Failure>::default();
    let given = [(a, "a"), (b, "b")].map(|(side, name)| given(py, side, name, loaded.as_ref(), &failure));
    let [a, b] = given;
    let given = [a?, b?];
    let Watched { result, interrupt } = watched(py, progress, threads, vec![failure], |watch| {
        let mut sides = vec![];
        for (given, k) in given.into_iter().zip(0..) {
            sides.push(match (given, &loaded) {
                (Given::Side(side), _) => side,
                (Given::File(path), Some(loaded)) => Side::read(&path, &loaded.film)?,
                (Given::Method(name, integrator), Some(loaded)) => {
                    let Loaded { world, film, sampler, .. } = loaded;
                    let until = StopCondition::new(spp.map(|_| sampler.spp), sampler.spp, time, None);
                    let film = film.clone().without_layers();
                    let method = (name, &*integrator);
                    let scene: Arc<dyn pt::scene::Scene> = world.clone();
                    let RenderedSide { side, samples, report, .. } = Side::render(&scene, &film, method, (*sampler, k), &until, watch);
                    match side {
                        Some(side) => side,
                        None if report.cancelled => return Ok(None),
                        None => return Err(pt::Error::Usage(format!("{} (spp, time)", Side::too_few(samples)))),
                    }
                }
                (_, None) => return Err(pt::Error::Internal("a side without a scene".into())),
            });
        }
        let found = verify(&sides[0], &sides[1], alpha)?;
        Ok(Some(found))
    })?;
    match (interrupt, result) {
        (Some(interrupt), _) => Err(interrupt),
        (None, Some(found)) => told(py, &found, alpha),
        (None, None) => Err(raised(py, &pt::Error::Internal("the test was cancelled".into()))),
    }
}

/// Refuses two pictures that share random numbers: they would agree more than chance allows.
fn refuse_same_numbers(py: Python<'_>, a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> PyResult<()> {
    let (Ok(a), Ok(b)) = (a.cast::<Picture>(), b.cast::<Picture>()) else { return Ok(()) };
    match (a.get().seed(), b.get().seed()) {
        (Some(one), Some(other)) if one == other => {
            Err(usage(py, format!("both pictures have seed {one}: their random numbers must differ, so render one with another seed")))
        }
        _ => Ok(()),
    }
}

fn given(py: Python<'_>, side: &Bound<'_, PyAny>, name: &str, loaded: Option<&Loaded>, failure: &Arc<Failure>) -> PyResult<Given> {
    if let Ok(picture) = side.cast::<Picture>() {
        return picture.get().side(py, name).map(Given::Side);
    }
    let custom = PythonIntegrator::of(side, failure);
    let path = side.extract::<PathBuf>().ok();
    if custom.is_none() && path.is_none() {
        return Err(usage(py, format!("{name}: expected a Picture, the name of an integrator or the path of an .exr file")));
    }
    let Some(loaded) = loaded else {
        return Err(usage(py, format!("{name}: expected a Picture; integrators and files need scene=")));
    };
    if let Some(custom) = custom {
        return Ok(Given::Method("python", Arc::new(custom)));
    }
    let path = path.unwrap_or_default();
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        return Ok(Given::File(path));
    }
    let chosen = loaded.choose(TABLES, &Path::new(&path).to_string_lossy());
    chosen.map(|(entry, integrator)| Given::Method(entry.name, integrator)).map_err(|error| raised(py, &error))
}

fn told<'py>(py: Python<'py>, found: &Verification, alpha: f64) -> PyResult<Bound<'py, PyAny>> {
    let agreement = &found.agreement;
    let conclusion = agreement.conclusion();
    let verdict = match conclusion {
        Conclusion::Same => "same",
        Conclusion::Different => "different",
        Conclusion::Inconclusive => "inconclusive",
    };
    // The level is shared by Šidák's rule among all tests of all colours: its inverse is the risk at which one of them just refuses.
    let overall = |p: f64, tests: f64| -(tests * (-p).ln_1p()).exp_m1();
    let tests = PyDict::new(py);
    let mut least = 1.0f64;
    for (name, one) in [("pixel", agreement.pixel), ("block", agreement.block), ("global", agreement.global), ("spread", agreement.spread)]
    {
        let p = overall(one.p, 4.0 * one.tests as f64);
        least = least.min(p);
        tests.set_item(name, p)?;
    }
    if agreement.heavy.contains(&true) {
        least = overall(agreement.rare.p, agreement.rare.tests as f64);
        tests.clear();
        tests.set_item("rare", least)?;
    }
    value(py, "Verification")?.call1((verdict, least, found.smallest_bias, alpha, tests, agreement.heavy))
}
