//! The open seam: how light transport is computed.
//!
//! An [`Integrator`] holds settings. For one scene it prepares an [`Estimator`], which is asked for the
//! radiance of one camera sample after the other, from any thread. To add one: a file with both, and an
//! [`Entry`]; see `integrators/` and `examples/plug_in.rs`.

use std::sync::Arc;

use glam::{UVec2, Vec2};
use schemars::JsonSchema;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};

use crate::bsdf::TransportMode;
use crate::effects::Effects;
use crate::error::Error;
use crate::film::FilmSpec;
use crate::light::LightSample;
use crate::math::{Ray, Spectrum, Vec3};
use crate::reader::{self, Faults, Node, UnknownKeys};
use crate::sampler::Sampler;
use crate::sampler::dimension::{self, Use};
use crate::scene::{Scene, Surface};
use crate::witness::Witness;

/// A method of light transport: settings only.
pub trait Integrator: Send + Sync {
    /// Everything that this scene needs and that can be done once.
    fn prepare(&self, scene: Arc<dyn Scene>, film: &FilmSpec) -> Box<dyn Estimator>;

    /// What its settings leave out of the picture, on purpose.
    fn biases(&self) -> Vec<Bias> {
        vec![]
    }
}

/// A setting that leaves something out.
pub struct Bias {
    /// As one would write it: `max_depth 7`.
    pub setting: String,
    /// The same method without it. On the same random numbers the two differ by what is left out, and by nothing else.
    pub without: Box<dyn Integrator>,
}

/// A method at work on one scene.
pub trait Estimator: Send + Sync {
    /// An unbiased estimate of the radiance that arrives along the camera's ray [W·m⁻²·sr⁻¹].
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum;
}

/// What the camera hands to an estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSample {
    pub ray: Ray,
    /// Of the reconstruction filter; applied by the render loop.
    pub weight: f32,
    pub pixel: UVec2,
    /// Position on the film (pixels), from the upper left.
    pub raster: Vec2,
}

/// What an estimator may use while it works on one sample.
pub struct Context<'a> {
    pub sampler: &'a mut dyn Sampler,
    /// Who wants to know, if anyone does: see [`crate::witness`]. Who tells nothing may leave it alone.
    pub witness: Option<&'a mut dyn Witness>,
    /// Tells whether the sample is still wanted. Whose samples are short may leave it alone.
    pub interrupt: Interrupt<'a>,
}

/// Tells a sample that takes long whether the render was cancelled: what is returned then does not count, whatever it is.
#[derive(Clone, Copy)]
pub struct Interrupt<'a> {
    is_cancelled: Option<&'a dyn Fn() -> bool>,
}

impl<'a> Interrupt<'a> {
    /// The interrupt that never comes.
    pub const NEVER: Interrupt<'static> = Interrupt { is_cancelled: None };

    /// - `is_cancelled`: once it says so, it always does
    pub fn new(is_cancelled: &'a dyn Fn() -> bool) -> Interrupt<'a> {
        Interrupt { is_cancelled: Some(is_cancelled) }
    }

    /// Whether to give up the sample after so many of its vertices. It is looked at once in 256 of them, at no cost for short paths.
    #[inline(always)]
    pub fn ends(self, vertices: u32) -> bool {
        vertices % 256 == 255 && self.comes()
    }

    #[cold]
    fn comes(self) -> bool {
        self.is_cancelled.is_some_and(|is_cancelled| is_cancelled())
    }
}

/// Russian roulette: paths that carry little end early, the survivors stand for them.
///
/// Survival probability q = min(1, max β·η²), with β the throughput and η² undoing the compression of
/// radiance in glass. By throughput alone, never by radiance: emission ×2^k gives pixels ×2^k.
///
/// Where β falls by ρ at each bounce, survivors carry β/q = 1 again. A bound on q below 1 would let them
/// grow instead, by ρ/q a bounce, and for ρ² > q without bound in the variance: a path among perfect
/// mirrors is ended by its greatest depth, not here.
///
/// Source: Arvo and Kirk, *Particle Transport and Image Synthesis* (1990). Tests: roulette_keeps_the_mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette {
    /// The first vertex at which a path may end.
    pub from_depth: u32,
}

impl Roulette {
    /// The probability that a path lives on.
    pub fn chance(&self, depth: u32, beta: Spectrum) -> f32 {
        if depth < self.from_depth { 1.0 } else { beta.max().min(1.0) }
    }

    /// What the throughput of a path that lives on is multiplied by; `None` for one that ends here.
    ///
    /// - `beta`: throughput, with the compression by refraction taken out
    pub fn survive(&self, depth: u32, beta: Spectrum, sampler: &mut dyn Sampler) -> Option<f32> {
        if depth < self.from_depth {
            return Some(1.0);
        }
        let q = self.chance(depth, beta);
        sampler.at(dimension::vertex(depth, Use::Roulette));
        (sampler.next_1d() < q).then(|| 1.0 / q)
    }
}

/// One light sample of a surface that scatters it and that it reaches: f·|cos|·Li / pdf, and the sample.
///
/// Delta lobes see no light sample, what is in shadow gets none: `None`.
pub fn sample_light(
    scene: &dyn Scene,
    surface: &Surface,
    wo: Vec3,
    depth: u32,
    time: f32,
    sampler: &mut dyn Sampler,
) -> Option<(Spectrum, LightSample)> {
    if !surface.bsdf.has_smooth_lobe() {
        return None;
    }
    sampler.at(dimension::vertex(depth, Use::Light));
    let (choice, u) = (sampler.next_1d(), sampler.next_2d());
    let light = scene.lights().sample(surface.lit, choice, u)?;
    let f = surface.eval(wo, light.wi, TransportMode::Radiance);
    let reached = !f.is_black() && !scene.occluded(&surface.shadow_ray(light.wi, &light.target, time));
    reached.then(|| (f * light.weight, light))
}

/// The greatest `max_depth` and `roulette_depth` that a scene may ask for: a path among perfect mirrors ends there.
pub const MAX_DEPTH: u32 = 65535;

/// Reads a depth: `#[serde(deserialize_with = "pt::integrator::depth")]`.
///
/// # Errors
/// Beyond [`MAX_DEPTH`].
pub fn depth<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    at_most::<MAX_DEPTH, D>(deserializer)
}

/// Reads a number that has a bound of its own: `#[serde(deserialize_with = "pt::integrator::at_most::<12, _>")]`.
///
/// # Errors
/// Beyond `MOST`.
pub fn at_most<'de, const MOST: u32, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    // Wider than what is wanted, so that its own bound is the one that is told.
    let number = i128::deserialize(deserializer)?;
    let refused = || D::Error::custom(format!("expected a whole number from 0 to {MOST}, found {number}"));
    u32::try_from(number).ok().filter(|number| *number <= MOST).ok_or_else(refused)
}

/// A row of the table of integrators: it feeds the command line, its help, comparisons and the tests.
#[derive(Clone, Copy)]
pub struct Entry {
    pub name: &'static str,
    /// One line.
    pub about: &'static str,
    /// What its pictures contain.
    pub simulates: Effects,
    /// With the options that the scene has for it.
    pub new: fn(&Options) -> Box<dyn Integrator>,
    /// Of the options.
    pub schema: fn() -> schemars::Schema,
}

impl Entry {
    /// The integrator whose settings are the type `T`: they are its options, by name.
    pub const fn of<T>(name: &'static str, about: &'static str, simulates: Effects) -> Entry
    where
        T: Integrator + Default + DeserializeOwned + JsonSchema + 'static,
    {
        Entry { name, about, simulates, new: |options| Box::new(options.read::<T>()), schema: || schemars::schema_for!(T) }
    }
}

/// The typed options of an integrator, as the scene has them; what is wrong with them is noted.
pub struct Options<'a> {
    node: Option<&'a Node>,
    unknown: UnknownKeys,
    faults: &'a Faults,
}

/// Where a scene keeps them.
const POINTER: &str = "/integrator";

impl Options<'_> {
    /// `T::default()` where the scene has none, or wrong ones.
    pub fn read<T: Default + DeserializeOwned>(&self) -> T {
        self.node.and_then(|node| reader::read_options(node, POINTER, self.unknown, self.faults)).unwrap_or_default()
    }
}

/// What a scene is rendered with that names no integrator.
pub const DEFAULT: &str = "nee";

/// The integrator that `name` chooses, or else the scene, out of `tables`.
///
/// - `scene`: the scene's own choice and options; where `name` chooses another, it takes the options that both know
///
/// # Errors
/// `Usage` for an unknown `name`; `Invalid` (or `Usage`, for what `-D` gave) for the scene's own mistakes.
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
            faults.add(&node.place, format!("{POINTER}/type"), reader::unknown("integrator", own.unwrap_or_default(), &names));
        }
        faults.into_result(file)?;
        return Err(Error::Internal("the table of integrators lacks the default".into()));
    };
    let unknown = if own == Some(entry.name) || own.is_none() { UnknownKeys::Refuse } else { UnknownKeys::Ignore };
    let integrator = (entry.new)(&Options { node: scene, unknown, faults: &faults });
    faults.into_result(file)?;
    Ok((entry, integrator))
}
