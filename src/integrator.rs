//! Interface of light transport methods.
//!
//! An [`Integrator`] holds settings. For one scene it prepares an [`Estimator`], which computes the radiance of one camera sample
//! at a time and is called from many threads. A new method is a file with both and an [`Entry`]; see `integrators/` and
//! `examples/plug_in.rs`.

mod differential;
mod direct;
mod interrupt;
mod side_by_side;
mod space;
mod transport;
mod wavelength;

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{UVec2, Vec2};
use schemars::JsonSchema;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};

use crate::camera::Camera;
use crate::effects::Effects;
use crate::error::Error;
use crate::film::{FilmSpec, Splat};
use crate::math::{Ray, RayDifferential, Spectrum};
use crate::medium::Inside;
use crate::primitive::Hit;
use crate::reader::{self, Faults, Node, UnknownKeys};
use crate::recorder::{NoRecorder, PathRecorder, Recorder};
use crate::sampler::SampleNumbers;
use crate::scene::Scene;

pub use direct::sample_light;
pub use interrupt::Interrupt;
pub use side_by_side::{BATCH, Batch, CameraRays, PathLanes, SideBySide, WideWalk};
pub use space::{Filled, Space, Vacuum, WideSpace};
pub use transport::{CameraPath, PathState, Roulette};
pub use wavelength::PathWavelength;

/// Settings of a light transport method.
pub trait Integrator: Send + Sync {
    /// Does the work that is done once per scene, and returns the estimator for it.
    fn prepare(&self, scene: Arc<dyn Scene>, film: &FilmSpec) -> Box<dyn Estimator>;

    /// Settings that change the expected picture on purpose: they leave out light, or add some.
    fn biases(&self) -> Vec<Bias> {
        vec![]
    }

    /// Whether the estimator follows paths from the lights, whose light arrives anywhere on the film. Only then does it get a
    /// [`Context::light_path`]. All pixels then take the same number of samples.
    fn splats(&self) -> bool {
        false
    }
}

/// Setting that changes the expected picture.
pub struct Bias {
    /// Key and value, such as `max_depth 7`.
    pub setting: String,
    /// The method without the setting. On the same random numbers, the difference of the two pictures is the error of the setting.
    pub without: Box<dyn Integrator>,
}

/// Method prepared for one scene.
pub trait Estimator: Send + Sync {
    /// An estimate of the radiance that arrives along the camera's ray [W·m⁻²·sr⁻¹], or of the part of it that [`LightPath::splat`] does
    /// not bring. Its expected value is exact, except for the effect of the settings in
    /// [`Integrator::biases`].
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum;

    /// The method for many samples at once, if it has one for its scene. It is used for samples without a recorder.
    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        None
    }
}

/// Method that follows paths from vertex to vertex, generic over the recorder.
///
/// Every walk is an [`Estimator`]: the blanket implementation compiles its steps once without recording and once for a
/// [`PathRecorder`], chooses between the two by [`Context::recorder`], and ends the walk if the render is cancelled.
pub trait PathWalk: Send + Sync {
    /// What is known between two vertices, such as a [`CameraPath`].
    type State;

    /// The method for many samples at once, see [`Estimator::side_by_side`].
    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        None
    }

    /// The state before the first vertex.
    fn start(&self, camera: &CameraSample) -> Self::State;

    /// Goes to the next vertex. At the end of the walk it breaks with the estimate of the radiance that arrives along the camera's ray
    /// [W·m⁻²·sr⁻¹], as [`Estimator::li`] returns it.
    fn step<R: Recorder + ?Sized>(&self, state: &mut Self::State, numbers: &mut SampleNumbers, recorder: &mut R) -> ControlFlow<Spectrum>;
}

impl<W: PathWalk> Estimator for W {
    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        PathWalk::side_by_side(self)
    }

    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        match cx.recorder.take() {
            None => walk(self, camera, &mut cx.numbers, &mut NoRecorder, cx.interrupt),
            Some(recorder) => walk(self, camera, &mut cx.numbers, recorder, cx.interrupt),
        }
    }
}

/// Radiance found by the steps of a walk.
fn walk<W: PathWalk, R: Recorder + ?Sized>(
    method: &W,
    camera: &CameraSample,
    numbers: &mut SampleNumbers,
    recorder: &mut R,
    interrupt: Interrupt,
) -> Spectrum {
    let mut state = method.start(camera);
    let mut steps = 0u32;
    while !interrupt.ends(steps) {
        if let ControlFlow::Break(radiance) = method.step(&mut state, numbers, recorder) {
            return radiance;
        }
        steps = steps.wrapping_add(1);
    }
    // The sample of a cancelled render is discarded.
    Spectrum::BLACK
}

/// Camera ray of a sample and its place on the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSample {
    /// Ray from the camera into the scene.
    pub ray: Ray,
    /// Weight of the reconstruction filter, times that of the camera's ray; applied by the render loop.
    pub weight: f32,
    /// Pixel that the sample belongs to.
    pub pixel: UVec2,
    /// Position on the film (pixels), from the upper left corner.
    pub raster: Vec2,
    /// What the ray hits, if that was found already for the layers of the picture; the inner `None` means that it hits nothing.
    /// An estimator that traces the ray itself gets the same hit.
    pub known_hit: Option<Option<Hit>>,
    /// Bodies with media around the start of the ray.
    pub inside: Inside,
    /// How the ray differs from those beside it at the distance of the texture footprint; `None` if no texture depends on it.
    pub differential: Option<RayDifferential>,
}

impl CameraSample {
    /// What the ray hits.
    pub fn hit(&self, scene: &dyn Scene) -> Option<Hit> {
        self.known_hit.unwrap_or_else(|| scene.intersect(&self.ray))
    }
}

/// Resources of an estimator for one camera sample.
pub struct Context<'a> {
    /// Random numbers of the sample.
    pub numbers: SampleNumbers<'a>,
    /// Recorder of the sample's paths, if there is one: see [`crate::recorder`]. An estimator that records nothing may ignore it.
    pub recorder: Option<&'a mut dyn PathRecorder>,
    /// Query whether the render was cancelled. An estimator whose samples are short may ignore it.
    pub interrupt: Interrupt<'a>,
    /// What a path from the lights needs; `None` unless [`Integrator::splats`].
    pub light_path: Option<LightPath<'a>>,
}

/// Resources for a path that starts at a light. One such path is traced with each camera sample, in all pixels of the whole picture.
pub struct LightPath<'a> {
    /// Random numbers of the path. Those of all paths from lights are one sequence, evenly distributed over all of them.
    pub numbers: SampleNumbers<'a>,
    film: &'a FilmSpec,
    camera: &'a Camera,
    splats: &'a mut Vec<Splat>,
    /// Whether all splats so far are finite and not negative.
    is_valid: &'a mut bool,
}

impl<'a> LightPath<'a> {
    /// A path without splats, for a camera and its film.
    ///
    /// - `splats`: list to which the path's splats are added
    /// - `is_valid`: set to `false` by a splat that is not finite or is negative, which is not added
    pub fn new(
        numbers: SampleNumbers<'a>,
        film: &'a FilmSpec,
        camera: &'a Camera,
        splats: &'a mut Vec<Splat>,
        is_valid: &'a mut bool,
    ) -> LightPath<'a> {
        LightPath { numbers, film, camera, splats, is_valid }
    }

    /// Adds light to the film. Returns whether it counts in a pixel of the crop.
    ///
    /// - `film`: position as in [`Camera::connect`]; it may lie outside of the film
    /// - `value`: flux of the path times the importance of the camera, [`CameraConnection::weight`](crate::camera::CameraConnection)
    /// - `depth`: scattering events between light and camera
    /// - `light`: index of the light
    pub fn splat(&mut self, film: Vec2, value: Spectrum, depth: u32, light: u32) -> bool {
        if !value.is_valid() {
            *self.is_valid = false;
            return false;
        }
        if value.is_black() {
            return false;
        }
        let before = self.splats.len();
        for place in self.camera.same_film_positions(film) {
            let splat = Splat { raster: place * self.film.size.as_vec2(), value, depth, light };
            if splat.reaches(&self.film.filter, self.film.crop) {
                self.splats.push(splat);
            }
        }
        self.splats.len() > before
    }

    /// Width of the film divided by its height.
    pub fn aspect(&self) -> f32 {
        self.film.aspect()
    }

    /// Width and height of the film (pixels).
    pub fn film_size(&self) -> Vec2 {
        self.film.size.as_vec2()
    }
}

/// The greatest `max_depth` and `roulette_depth` of a scene. It ends paths between perfect mirrors.
pub const MAX_DEPTH: u32 = 65535;

/// Deserializes a depth: `#[serde(deserialize_with = "pt::integrator::depth")]`.
///
/// # Errors
/// The number exceeds [`MAX_DEPTH`].
pub fn depth<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    at_most::<MAX_DEPTH, D>(deserializer)
}

/// Deserializes a whole number with an upper bound: `#[serde(deserialize_with = "pt::integrator::at_most::<12, _>")]`.
///
/// # Errors
/// The number exceeds `MOST`.
pub fn at_most<'de, const MOST: u32, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    // A type wider than needed, so that the fault names `MOST` and not the range of u32.
    let number = i128::deserialize(deserializer)?;
    let refused = || D::Error::custom(format!("expected a whole number from 0 to {MOST}, found {number}"));
    u32::try_from(number).ok().filter(|number| *number <= MOST).ok_or_else(refused)
}

/// Row of the table of integrators. The command line, its help, comparisons and the tests are made from the table.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Name on the command line and in scene files.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Effects that its pictures contain.
    pub simulates: Effects,
    /// What a picture looks like that lacks certain effects: added to the note that names the missing effects.
    pub when_missing: &'static [(Effects, &'static str)],
    /// Makes the integrator from the options of a scene.
    pub new: fn(&Options) -> Box<dyn Integrator>,
    /// JSON schema of the options.
    pub schema: fn() -> schemars::Schema,
}

impl Entry {
    /// Entry of the integrator `T`, whose fields are its options.
    pub const fn of<T>(name: &'static str, about: &'static str, simulates: Effects) -> Entry
    where
        T: Integrator + Default + DeserializeOwned + JsonSchema + 'static,
    {
        let new = |options: &Options| -> Box<dyn Integrator> { Box::new(options.read::<T>()) };
        Entry { name, about, simulates, when_missing: &[], new, schema: || schemars::schema_for!(T) }
    }

    /// The entry with a description of what a picture looks like where some effects are missing.
    pub const fn when_missing(self, when_missing: &'static [(Effects, &'static str)]) -> Entry {
        Entry { when_missing, ..self }
    }

    /// The effects of a scene that the integrator does not simulate, in words; `None` if there are none.
    pub fn lacks(&self, effects: Effects) -> Option<String> {
        let lacks = effects - self.simulates;
        let is_lacking = |described: &Effects| lacks.iter().any(|effect| described.contains(effect));
        let looks: Vec<&str> = self.when_missing.iter().filter(|(described, _)| is_lacking(described)).map(|(_, looks)| *looks).collect();
        let looks = if looks.is_empty() { String::new() } else { format!(" ({})", looks.join("; ")) };
        (!lacks.is_empty()).then(|| format!("{lacks}{looks}"))
    }
}

/// Options of an integrator in a scene file. Faults found while reading them are collected.
pub struct Options<'a> {
    node: Option<&'a Node>,
    unknown: UnknownKeys,
    faults: &'a Faults,
}

/// JSON pointer to the options in a scene file.
const POINTER: &str = "/integrator";

impl Options<'_> {
    /// Reads the options; `T::default()` where the scene has none or they have faults.
    pub fn read<T: Default + DeserializeOwned>(&self) -> T {
        self.node.and_then(|node| reader::read_options(node, POINTER, self.unknown, self.faults)).unwrap_or_default()
    }
}

/// Name of the integrator for scenes that choose none.
pub const DEFAULT: &str = "nee";

/// Chooses an integrator from `tables`: by `name` if given, otherwise by the scene.
///
/// - `scene`: the scene's `integrator` node. If `name` chooses another integrator, that one takes the options which both know.
///
/// # Errors
/// `Usage` for an unknown `name`; `Invalid` (or `Usage`, for values given with `-D`) for faults in the scene.
pub fn choose(tables: &[&[Entry]], scene: Option<&Node>, name: Option<&str>, file: &str) -> crate::Result<(Entry, Box<dyn Integrator>)> {
    let all = || tables.iter().copied().flatten();
    let find = |name: &str| all().find(|entry| entry.name == name).copied();
    let names: Vec<&str> = all().map(|entry| entry.name).collect();
    let own = scene.and_then(|node| node.child("type")).and_then(Node::as_str);
    let faults = Faults::default();
    let entry = match (name, own) {
        (Some(name), _) => Some(find(name).ok_or_else(|| Error::Usage(reader::unknown("integrator", name, &names)))?),
        (None, None) => find(DEFAULT),
        (None, Some(own)) => find(own),
    };
    let Some(entry) = entry else {
        if let Some(node) = scene.and_then(|node| node.child("type")) {
            faults.add(&node.location, format!("{POINTER}/type"), reader::unknown("integrator", own.unwrap_or_default(), &names));
        }
        faults.into_result(file)?;
        return Err(Error::Internal("the table of integrators lacks the default".into()));
    };
    let unknown = if own == Some(entry.name) || own.is_none() { UnknownKeys::Refuse } else { UnknownKeys::Ignore };
    let integrator = (entry.new)(&Options { node: scene, unknown, faults: &faults });
    faults.into_result(file)?;
    Ok((entry, integrator))
}
