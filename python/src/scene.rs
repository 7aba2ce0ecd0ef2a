//! Scenes: loading, checking and rendering.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use pt::film::{Crop, MomentFilm};
use pt::import::{AutoCamera, ImportOptions, Up, Viewpoint, import_bytes};
use pt::integrator::Entry;
use pt::load::{self, Loaded, Settings, override_values};
use pt::measure::{ErrorTarget, Scope, StopCondition, render_until};
use pt::output::attributes::of_camera;
use pt::part::About;
use pt::reader::Node;
use pt::render::{self, Render, SHORT_WAVE};
use pt::scene::Scene as _;
use pt::{Error, describe, output};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{detached, raised, usage};
use crate::integrator::{ENTRY, Failure, PythonIntegrator};
use crate::items::Items;
use crate::meters;
use crate::part::{self, Part};
use crate::picture::{Picture, Rendered, share, tells_error};
use crate::rays::{self, LazyCaster};
use crate::watch::{Watched, watched};

/// Tables of integrators.
pub const TABLES: &[&[Entry]] = &[pt::integrators::ALL];

/// A scene that is read, checked and built: `load` makes one.
///
/// A scene never changes and may be used by several threads at once.
#[pyclass(frozen, module = "pt_renderer")]
pub struct Scene {
    loaded: Loaded,
    caster: LazyCaster,
}

/// Reads, checks and builds a scene.
///
/// - `bytes`: content of the scene; that of the file at `path` without it
/// - `overrides`: words for messages, JSON pointers and JSON values
/// - `has_places`: whether lines and columns of the content mean something to the user
#[pyfunction]
#[pyo3(name = "_load")]
#[pyo3(signature = (path, bytes, overrides, integrator, allow_outside, view, up, ground, studio, has_places))]
#[allow(clippy::too_many_arguments, reason = "the function is called from one place of the package")]
pub fn load_scene(
    py: Python<'_>,
    path: PathBuf,
    bytes: Option<Vec<u8>>,
    overrides: Vec<(String, String, String)>,
    integrator: Option<String>,
    allow_outside: bool,
    view: Option<&str>,
    up: Option<&str>,
    ground: Option<bool>,
    studio: bool,
    has_places: bool,
) -> PyResult<Scene> {
    let auto_camera =
        AutoCamera { up: up.map(|up| axis(py, up)).transpose()?, view: view.map(|view| side(py, view)).transpose()?, ground, studio };
    let exposure = load::exposure(overrides.iter().map(|(_, pointer, value)| (pointer.as_str(), value.as_str())));
    let options = ImportOptions { allow_outside, auto_camera, exposure };
    let work = || -> pt::Result<Loaded> {
        let bytes = bytes.map_or_else(|| describe::bytes(&path), Ok)?;
        let integrator = integrator.as_deref();
        let set = |root: &mut Node| overrides.iter().try_for_each(|(words, pointer, value)| root.set_by(words, pointer, value));
        let change = |root: &mut Node, file: &str| override_values(root, file, integrator, set);
        let imported = import_bytes(bytes, &path, &options, change)?;
        load::load(imported, integrator, TABLES)
    };
    let loaded = detached(py, || work().map_err(|error| if has_places { error } else { without_places(error, &path) }))?;
    Ok(Scene { loaded, caster: LazyCaster::default() })
}

#[pymethods]
impl Scene {
    /// Width of the whole picture in pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.loaded.film.size.x
    }

    /// Height of the whole picture in pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.loaded.film.size.y
    }

    /// Samples per pixel that the scene plans.
    #[getter]
    fn spp(&self) -> u64 {
        self.loaded.sampler.spp
    }

    /// Name of the integrator that renders the scene.
    #[getter]
    fn integrator(&self) -> &'static str {
        self.loaded.entry.name
    }

    /// Name of the scene file.
    #[getter]
    fn file(&self) -> &str {
        &self.loaded.file
    }

    /// Sentences about probable mistakes, and about what was left out of a scene of another program.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.loaded.warnings.clone()
    }

    /// The scene in pt's own format, as JSON, with its overrides.
    fn json(&self) -> String {
        self.loaded.root.to_string()
    }

    /// What is in the scene, and which effects it needs: a dict with
    ///
    /// - "shapes", "primitives", "instances", "materials" and "lights": numbers of them
    /// - "effects": for each effect that a picture of the scene requires, the parts that need it
    /// - "lacks": the effects that the integrator leaves out, in words, or None
    /// - "warnings": sentences about probable mistakes
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Loaded { world, entry, needs, description, warnings, .. } = &self.loaded;
        let effects = PyDict::new(py);
        for effect in world.effects().iter() {
            let parts: Vec<&str> = needs.iter().filter(|(_, needed)| needed.contains(effect)).map(|(name, _)| name.as_str()).collect();
            effects.set_item(effect.to_string(), parts)?;
        }
        let found = PyDict::new(py);
        found.set_item("shapes", world.shapes().len())?;
        found.set_item("primitives", world.primitive_count())?;
        found.set_item("instances", world.instance_count())?;
        found.set_item("materials", description.materials.len())?;
        found.set_item("lights", world.lights().len())?;
        found.set_item("effects", effects)?;
        found.set_item("lacks", entry.lacks(world.effects()))?;
        found.set_item("warnings", warnings.clone())?;
        Ok(found)
    }

    /// Renders the scene and returns a Picture. Each setting that is None is the scene's own.
    ///
    /// - spp: samples per pixel
    /// - target: stop when the relative error of the picture is at most this with `confidence`, such as 0.01; see Picture.target_met
    /// - region: with target, the pixels whose error counts, (x0, x1, y0, y1) with x0 <= x < x1 and y0 <= y < y1: that of a picture of them alone
    /// - tiles: with target, the share of the tiles of about 32 × 32 pixels of which each must have the error by itself, such as 0.95
    /// - time: stop after this many seconds. The first sample of every pixel is finished in any case.
    /// - integrator: name, see `pt list integrators`; or an object with a method `li(scene, ray, sampler)`, see docs/python.md
    /// - sampler: name, see `pt list samplers`
    /// - seed: another seed gives another, independent picture
    /// - scramblings: number of independent scramblings from which the error is estimated, a power of two up to 64
    /// - layers: names of layers beside the picture, see `pt list aovs`, or ["all"]
    /// - crop: pixels to render, (x0, x1, y0, y1) with x0 <= x < x1 and y0 <= y < y1
    /// - confidence: of the interval of the error, and of the target
    /// - threads: number of threads; all cores by default. It does not change the picture.
    /// - progress: called with a Progress between waves of samples, from the thread that called render
    ///
    /// The interpreter lock is released. Ctrl-C ends the render, and the samples until then are returned: see Picture.interrupted. Before
    /// the first sample of every pixel is done it raises KeyboardInterrupt. An exception of `progress` ends the render and is raised.
    ///
    /// Raises pt_renderer.Error for settings that the scene cannot have.
    #[pyo3(signature = (spp = None, *, target = None, time = None, integrator = None, sampler = None, seed = None, scramblings = None,
                        layers = None, crop = None, region = None, tiles = None, confidence = 0.95, threads = None, progress = None))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn render(
        &self,
        py: Python<'_>,
        spp: Option<i128>,
        target: Option<f64>,
        time: Option<f64>,
        integrator: Option<Bound<'_, PyAny>>,
        sampler: Option<String>,
        seed: Option<i128>,
        scramblings: Option<i128>,
        layers: Option<Items<String>>,
        crop: Option<[i128; 4]>,
        region: Option<[i128; 4]>,
        tiles: Option<f64>,
        confidence: f64,
        threads: Option<i128>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Picture> {
        let confidence = share(py, "confidence", confidence)?;
        let scope = scope(py, region, tiles, target.is_some())?;
        let target = target.map(|error| share(py, "target", error)).transpose()?.map(|error| ErrorTarget { error, confidence, scope });
        let time = time.map(|seconds| duration(py, seconds)).transpose()?;
        let threads = threads.map(|threads| thread_count(py, threads)).transpose()?;
        let layers = layers.map(|names| names.0);
        let settings = Settings { spp, seed, sampler, scramblings, crop, layers };
        let (failure, custom, name) = method(py, integrator.as_ref(), "integrator")?;
        let mut loaded = detached(py, || self.changed(&settings, name.as_deref()))?;
        // A method of Python has one thread at a time anyway.
        let threads = if custom.is_some() { Some(1) } else { threads };
        if let Some(custom) = custom {
            loaded.select(ENTRY, Arc::new(custom));
        }
        if target.is_some() && !tells_error(loaded.sampler.error_estimator()) {
            return Err(usage(py, "target: a single scrambling gives no error estimate; use scramblings of 2 or more"));
        }
        if let Some(why) = scope.refusal(loaded.film.crop, loaded.integrator.splats(), confidence) {
            return Err(usage(py, why));
        }
        let until = StopCondition::new(spp.map(|_| loaded.sampler.spp), loaded.sampler.spp, time, target);
        let Watched { result, interrupt } = watched(py, progress, threads, vec![failure], |watch| {
            let Loaded { world, film: spec, sampler, integrator, entry, .. } = &loaded;
            let about = About::new(loaded.identity()?, spec, sampler.error_estimator(), of_camera(&**world, spec));
            let settings = render::Settings { wave_time: Some(SHORT_WAVE), ..render::Settings::new(*sampler) };
            let mut film = MomentFilm::new(spec.clone());
            let mut render = Render::new(world.clone(), &**integrator, spec, &settings);
            let history = render_until(&mut render, &mut film, &until, watch);
            let (image, report) = (film.image(), render.report().clone());
            let (hash, integrator) = (output::hash(&image).to_string(), entry.name.to_owned());
            Ok(Rendered { film, image, hash, report, history, about, integrator, confidence, until })
        })?;
        match interrupt {
            Some(interrupt) if result.report.samples == 0 => Err(interrupt),
            _ => result.picture(py),
        }
    }

    /// Renders the samples first, ..., end - 1 of every pixel, and returns them as a Part, which `merge` adds to others.
    ///
    /// Other processes and machines may render the other samples: a part is pickled as the bytes of a .ptc file. All parts of a picture must have
    /// the same settings.
    ///
    /// - first, end: samples with 0 <= first <= sample < end
    /// - spp: number of samples that the sampler `stratified` spreads, which has no more; it changes no sample of
    ///   the others, but the memory that is needed is estimated by it
    /// - integrator: name, see `pt list integrators`
    /// - sampler, seed, scramblings, layers, crop, threads, progress: as for render
    ///
    /// Raises pt_renderer.Error for settings that the scene cannot have. On Ctrl-C, and where `progress` raises, the samples are discarded
    /// and the exception is raised.
    #[pyo3(signature = (first, end, *, spp = None, integrator = None, sampler = None, seed = None, scramblings = None, layers = None,
                        crop = None, threads = None, progress = None))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn part(
        &self,
        py: Python<'_>,
        first: i128,
        end: i128,
        spp: Option<i128>,
        integrator: Option<String>,
        sampler: Option<String>,
        seed: Option<i128>,
        scramblings: Option<i128>,
        layers: Option<Items<String>>,
        crop: Option<[i128; 4]>,
        threads: Option<i128>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Part> {
        let layers = layers.map(|names| names.0);
        let settings = Settings { spp, seed, sampler, scramblings, crop, layers };
        part::render(py, self, [first, end], &settings, integrator.as_deref(), threads, progress)
    }

    /// Names of the shapes, in the order of SceneHits.shape.
    #[getter]
    fn shapes(&self) -> Vec<String> {
        self.loaded.names.shapes.clone()
    }

    /// Where rays first meet the scene, as SceneHits, in double precision.
    ///
    /// `origins` (m) and `directions` have the shape (..., 3), or are broadcast to one; directions need not be unit vectors. Triangles, quads
    /// and boxes are met by exact decisions on the corners that the scene has: no ray slips through a closed mesh. Curved shapes, disks, meshes that
    /// change their form, and solids given by their distance are met in single precision; SceneHits.exact says which. Shapes of an instance are
    /// tested in the space of its group, so that a ray may pass between two instances that touch. What moves is where it is when the shutter
    /// opens. Opacity does not count.
    fn intersect<'py>(&self, py: Python<'py>, origins: &Bound<'py, PyAny>, directions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        rays::in_scene(py, (&self.loaded.world, &self.caster), origins, directions)
    }

    /// Measures irradiance and radiance at the meters of the scene, and returns a list of Reading.
    ///
    /// - integrator: name; the scene's by default
    /// - target: greatest relative error of the mean of each meter's three colours, half the width of its 95 % interval
    /// - samples: greatest number of samples of each meter, rounded down to 512, 1024, 2048, ..., and 512 at least; by default 65536, or 2**30
    ///   with another limit
    /// - time: time for each meter in seconds
    /// - threads: as for render
    ///
    /// Raises pt_renderer.Error for a scene without meters, and KeyboardInterrupt on Ctrl-C.
    #[pyo3(signature = (*, integrator = None, target = None, samples = None, time = None, threads = None))]
    fn measure<'py>(
        &self,
        py: Python<'py>,
        integrator: Option<&str>,
        target: Option<f64>,
        samples: Option<i128>,
        time: Option<f64>,
        threads: Option<i128>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        meters::measure(py, self, integrator, (target, samples, time), threads)
    }

    fn __repr__(&self) -> String {
        let Loaded { film, entry, sampler, .. } = &self.loaded;
        format!("<pt_renderer.Scene {:?}, {}×{}, {}, {} spp>", self.loaded.file, film.size.x, film.size.y, entry.name, sampler.spp)
    }
}

impl Scene {
    /// The scene as the library has it.
    pub fn loaded(&self) -> &Loaded {
        &self.loaded
    }

    /// The scene with settings and an integrator in place of its own.
    pub fn changed(&self, settings: &Settings, integrator: Option<&str>) -> pt::Result<Loaded> {
        let mut loaded = self.loaded.with(settings)?;
        if let Some(name) = integrator {
            let (entry, integrator) = loaded.choose(TABLES, name)?;
            loaded.select(entry, integrator);
        }
        Ok(loaded)
    }
}

/// Pixels whose error counts for a target.
fn scope(py: Python<'_>, region: Option<[i128; 4]>, tiles: Option<f64>, has_target: bool) -> PyResult<Scope> {
    match (region, tiles) {
        (None, None) => Ok(Scope::Picture),
        _ if !has_target => Err(usage(py, "region, tiles: only with a target, of whose error they choose the pixels; crop renders a part")),
        (Some(_), Some(_)) => Err(usage(py, "region, tiles: expected one of them")),
        (Some(region), None) => match region.map(u32::try_from) {
            [Ok(x0), Ok(x1), Ok(y0), Ok(y1)] => Ok(Scope::Region(Crop { min: [x0, y0].into(), max: [x1, y1].into() })),
            _ => Err(usage(py, format!("region={region:?}: expected whole numbers from 0 to {}", u32::MAX))),
        },
        (None, Some(tiles)) => Ok(Scope::Tiles { share: share(py, "tiles", tiles)? }),
    }
}

/// What renders: an object with a method `li`, or an integrator of a name.
type Method = (Arc<Failure>, Option<PythonIntegrator>, Option<String>);

/// The method that an argument stands for.
fn method(py: Python<'_>, given: Option<&Bound<'_, PyAny>>, argument: &str) -> PyResult<Method> {
    let failure = Arc::<Failure>::default();
    let Some(given) = given else { return Ok((failure, None, None)) };
    if let Ok(name) = given.extract::<String>() {
        return Ok((failure, None, Some(name)));
    }
    match PythonIntegrator::of(given, &failure) {
        Some(custom) => Ok((failure, Some(custom), None)),
        None => {
            Err(usage(py, format!("{argument}: expected the name of an integrator, or an object with a method li(scene, ray, sampler)")))
        }
    }
}

/// The error without lines and columns in the scene, which the user has not seen.
fn without_places(error: Error, path: &Path) -> Error {
    let name = describe::name(path);
    match error {
        Error::Invalid(mut faults) => {
            faults.iter_mut().filter(|fault| fault.file == name).for_each(|fault| (fault.line, fault.column) = (None, None));
            Error::Invalid(faults)
        }
        other => other,
    }
}

/// A time above 0.
pub fn duration(py: Python<'_>, seconds: f64) -> PyResult<Duration> {
    let given = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    given.ok_or_else(|| usage(py, format!("time: expected a number of seconds above 0 and up to 1e19, found {seconds:?}")))
}

/// A number of threads.
pub fn thread_count(py: Python<'_>, threads: i128) -> PyResult<usize> {
    const MOST: usize = 4096;
    let given = usize::try_from(threads).ok().filter(|threads| (1..=MOST).contains(threads));
    given.ok_or_else(|| usage(py, format!("threads: expected a whole number from 1 to {MOST}, found {threads}")))
}

fn axis(py: Python<'_>, name: &str) -> PyResult<Up> {
    match name {
        "y" => Ok(Up::Y),
        "z" => Ok(Up::Z),
        _ => Err(usage(py, format!("up: expected \"y\" or \"z\", found {name:?}"))),
    }
}

fn side(py: Python<'_>, name: &str) -> PyResult<Viewpoint> {
    let names = Viewpoint::ALL.map(|view| view.name);
    let found = Viewpoint::ALL.into_iter().find(|view| view.name == name);
    found.ok_or_else(|| raised(py, &Error::Usage(pt::reader::unknown("view", name, &names))))
}
