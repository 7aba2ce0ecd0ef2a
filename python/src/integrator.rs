//! Integrators written in Python, for teaching: they go through the same loop and the same statistics as those of pt.
//!
//! A method's `li` runs under the interpreter lock, on one thread. Everything else, from the camera's rays to the sums of the film, is
//! that of all renders.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::{DVec3, Vec2, Vec3};
use pt::bsdf::TransportMode;
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Entry, Estimator, Integrator};
use pt::integrators::normals::Normals;
use pt::math::{Ray, Rgb, Spectrum};
use pt::primitive::Hit;
use pt::sampler::Stream;
use pt::scene::Scene;
use pyo3::prelude::*;

/// Row of the table for all integrators that are written in Python. They say what they simulate by what they do.
pub const ENTRY: Entry =
    Entry::of::<Normals>("python", "an integrator that is written in Python", Effects::ALL.without(Effects::DISPERSION));

/// Exception in a method, which ends the render.
#[derive(Default)]
pub struct Failure {
    happened: AtomicBool,
    first: Mutex<Option<PyErr>>,
}

impl Failure {
    /// Whether the render is to end.
    pub fn happened(&self) -> bool {
        self.happened.load(Ordering::Relaxed)
    }

    fn set(&self, error: PyErr) {
        self.first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        self.happened.store(true, Ordering::Relaxed);
    }

    /// The exception, once.
    pub fn take(&self) -> Option<PyErr> {
        self.first.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// An object with a method `li`.
pub struct PythonIntegrator {
    object: Py<PyAny>,
    failure: Arc<Failure>,
}

impl PythonIntegrator {
    /// The integrator of an object, if it has a method `li`.
    pub fn of(object: &Bound<'_, PyAny>, failure: &Arc<Failure>) -> Option<PythonIntegrator> {
        let method = object.getattr("li").ok().filter(|method| method.is_callable())?;
        drop(method);
        Some(PythonIntegrator { object: object.clone().unbind(), failure: failure.clone() })
    }
}

impl Integrator for PythonIntegrator {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        let object = Python::attach(|py| self.object.clone_ref(py));
        Box::new(PythonEstimator { object, failure: self.failure.clone(), scene })
    }
}

struct PythonEstimator {
    object: Py<PyAny>,
    failure: Arc<Failure>,
    scene: Arc<dyn Scene>,
}

impl Estimator for PythonEstimator {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        if self.failure.happened() {
            return Spectrum::BLACK;
        }
        let radiance = Python::attach(|py| -> PyResult<[f32; 3]> {
            let origin = self.scene.origin();
            let scene = SceneView { scene: self.scene.clone() };
            let ray = PathRay { ray: camera.ray, origin };
            let sampler = Numbers { stream: Mutex::new(cx.numbers.stream(0)) };
            self.object.bind(py).call_method1("li", (scene, ray, sampler))?.extract()
        });
        match radiance {
            Ok(radiance) => rgb(radiance),
            Err(error) => {
                self.failure.set(error);
                Spectrum::BLACK
            }
        }
    }
}

/// The scene, as an integrator that is written in Python sees it.
#[pyclass(frozen, name = "PathScene", module = "pt_renderer")]
pub struct SceneView {
    scene: Arc<dyn Scene>,
}

#[pymethods]
impl SceneView {
    /// The Surface that a ray meets first, or None.
    fn intersect(&self, ray: &PathRay) -> Option<SurfaceView> {
        let hit = self.scene.intersect(&ray.ray)?;
        Some(SurfaceView { scene: self.scene.clone(), ray: ray.ray, hit })
    }

    /// Radiance (red, green, blue; W·m⁻²·sr⁻¹) that arrives along a ray which meets nothing.
    fn background(&self, ray: &PathRay) -> [f32; 3] {
        let all = self.scene.lights().background(ray.ray.direction);
        all.fold(Spectrum::BLACK, |sum, (_, radiance)| sum + radiance).to_rgb()
    }
}

/// A ray of a path.
#[pyclass(frozen, name = "PathRay", module = "pt_renderer")]
pub struct PathRay {
    ray: Ray,
    origin: DVec3,
}

#[pymethods]
impl PathRay {
    /// Start of the ray (m).
    #[getter]
    fn origin(&self) -> [f64; 3] {
        (self.ray.origin.as_dvec3() + self.origin).to_array()
    }

    /// Unit direction.
    #[getter]
    fn direction(&self) -> [f32; 3] {
        self.ray.direction.to_array()
    }
}

/// The surface at the point that a ray met.
#[pyclass(frozen, name = "PathSurface", module = "pt_renderer")]
pub struct SurfaceView {
    scene: Arc<dyn Scene>,
    ray: Ray,
    hit: Hit,
}

#[pymethods]
impl SurfaceView {
    /// Position (m).
    #[getter]
    fn point(&self) -> [f64; 3] {
        (self.surface().point.p.as_dvec3() + self.scene.origin()).to_array()
    }

    /// Unit shading normal, on the outside.
    #[getter]
    fn normal(&self) -> [f32; 3] {
        self.surface().point.ns.to_array()
    }

    /// Unit geometric normal, on the outside.
    #[getter]
    fn geometric_normal(&self) -> [f32; 3] {
        self.surface().point.ng.to_array()
    }

    /// Distance from the start of the ray (m).
    #[getter]
    fn distance(&self) -> f32 {
        self.hit.t
    }

    /// Radiance (red, green, blue; W·m⁻²·sr⁻¹) that the surface emits against the ray.
    #[getter]
    fn emitted(&self) -> [f32; 3] {
        self.surface().emitted(-self.ray.direction).to_rgb()
    }

    /// Samples the direction in which a path goes on: the next ray, and the factor (red, green, blue) of the light that arrives along it,
    /// f |cos θ| / pdf. None where the path ends.
    fn sample(&self, sampler: &Numbers) -> Option<(PathRay, [f32; 3])> {
        let (surface, [choice, u, v]) = (self.surface(), sampler.three());
        let (wi, sample) = surface.sample(-self.ray.direction, choice, Vec2::new(u, v), TransportMode::Radiance)?;
        let ray = surface.spawn(wi, self.ray.time);
        Some((PathRay { ray, origin: self.scene.origin() }, sample.weight.to_rgb()))
    }

    /// The ray that leaves the surface in a direction, which need not be a unit vector; None for one without a length.
    fn spawn(&self, direction: [f32; 3]) -> Option<PathRay> {
        let wi = Vec3::from(direction).try_normalize()?;
        Some(PathRay { ray: self.surface().spawn(wi, self.ray.time), origin: self.scene.origin() })
    }
}

impl SurfaceView {
    fn surface(&self) -> pt::scene::Surface<'_> {
        self.scene.surface(&self.ray, &self.hit)
    }
}

/// Random numbers of one sample, uniform in [0, 1) and without an end. They are the same in each render with the same seed.
#[pyclass(frozen, name = "PathSampler", module = "pt_renderer")]
pub struct Numbers {
    stream: Mutex<Stream>,
}

#[pymethods]
impl Numbers {
    /// The next number.
    fn get_1d(&self) -> f32 {
        self.stream.lock().unwrap_or_else(PoisonError::into_inner).next_1d()
    }

    /// The next two numbers.
    fn get_2d(&self) -> (f32, f32) {
        (self.get_1d(), self.get_1d())
    }
}

impl Numbers {
    fn three(&self) -> [f32; 3] {
        [self.get_1d(), self.get_1d(), self.get_1d()]
    }
}

fn rgb(radiance: [f32; 3]) -> Spectrum {
    Spectrum::from_illuminant(Rgb::new(radiance[0], radiance[1], radiance[2]))
}
