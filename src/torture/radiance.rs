//! Scenes whose radiance is known by formula, and means of it by every integrator, with their confidence.

use std::sync::Arc;

use glam::DVec3;

use super::{Answer, Effort, Row};
use crate::bsdf::{Material, MaterialId};
use crate::camera::{Camera, Perspective, Pose};
use crate::effects::Effects;
use crate::film::{Film, FilmSpec, Image, MomentFilm, Moments, PixelSums, Wave};
use crate::integrator::{Entry, Integrator};
use crate::integrators::nee::Nee;
use crate::integrators::path::Path;
use crate::integrators::whitted::Whitted;
use crate::light::Emitter;
use crate::math::{Rgb, Spectrum, Transform};
use crate::measure::{Mean, critical_z};
use crate::render::{Settings, Silent, render};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;
use crate::shape::Quad;
use crate::world::{World, WorldBuilder};

/// An upper bound of the number of statistical cases, which together have 1 % of false alarms.
const SUITE: usize = 1000;

/// Number of standard errors by which a mean may be off.
pub fn critical() -> f64 {
    critical_z(0.01, SUITE)
}

/// The same value in all channels.
pub fn gray(value: f64) -> Spectrum {
    Spectrum::gray(value as f32)
}

/// The colour that is stored for a spectrum of three coefficients.
pub fn stored(color: Spectrum) -> Rgb {
    let [r, g, b] = color.to_rgb();
    Rgb::new(r, g, b)
}

/// Emission of this radiance from the side of the normal.
pub fn glow(radiance: f64) -> Option<Emitter> {
    Some(Emitter::new(stored(gray(radiance))))
}

/// Emission of this radiance from both sides.
pub fn two_sided(radiance: f64) -> Option<Emitter> {
    Some(Emitter { two_sided: true, ..Emitter::new(stored(gray(radiance))) })
}

/// A material that absorbs all light and does not require interreflection.
pub fn black() -> Material {
    Material::mirror(Rgb::BLACK)
}

/// A translation.
///
/// # Panics
/// `p` is not finite.
pub fn at(p: DVec3) -> Transform {
    Transform::translate(p).expect("finite")
}

/// The plane z = 0 moved to `center`, its +z turned to `normal`.
///
/// # Panics
/// `normal` is zero.
pub fn facing(center: DVec3, normal: DVec3) -> Transform {
    let up = if normal.normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    Transform::look_at(center, center - normal, up).expect("a normal")
}

/// Adds the six walls of a box, with normals inwards. `wall` returns the material and emission of the wall on one side (±1) of one axis
/// (0 to 2).
pub fn room(world: &mut WorldBuilder, center: DVec3, half: DVec3, wall: impl Fn(usize, f64) -> (MaterialId, Option<Emitter>)) {
    for (axis, side) in (0..3).flat_map(|axis| [-1.0, 1.0].map(|side| (axis, side))) {
        let out = DVec3::AXES[axis] * side;
        let size = [[half.z, half.y], [half.x, half.z], [half.x, half.y]][axis].map(|s| 2.0 * s);
        let (material, emission) = wall(axis, side);
        world.shape(Quad { size }, facing(center + out * half, -out), material, emission);
    }
}

/// A camera all of whose pixels look at one point, within a billionth of the distance.
///
/// # Panics
/// Both points are the same.
pub fn probe(from: DVec3, to: DVec3) -> Camera {
    let up = if (to - from).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    Camera::Perspective(Perspective::new(Pose::new(&Transform::look_at(from, to, up).expect("two points")), 1e-7, 0.0, 1.0))
}

/// Limits of the length of an integrator's paths.
#[derive(Clone, Copy)]
pub struct Depth {
    /// Greatest number of scattering events.
    pub max: u32,
    /// Depth at which Russian roulette begins.
    pub roulette: u32,
}

impl Depth {
    /// A maximum depth without Russian roulette.
    pub fn exactly(max: u32) -> Depth {
        Depth { max, roulette: u32::MAX }
    }
}

/// The integrator of an entry with these limits. The options of each integrator appear only here.
pub fn integrator(entry: &Entry, depth: Depth) -> Option<Box<dyn Integrator>> {
    match entry.name {
        "path" => Some(Box::new(Path { max_depth: depth.max, roulette_depth: depth.roulette })),
        "nee" => Some(Box::new(Nee { max_depth: depth.max, roulette_depth: depth.roulette, ..Nee::default() })),
        "whitted" => Some(Box::new(Whitted { max_depth: depth.max, ..Whitted::default() })),
        _ => None,
    }
}

/// Effects that a picture requires. With a single scattering event surfaces cannot light each other.
pub fn needs(scene: &dyn Scene, depth: Depth) -> Effects {
    if depth.max <= 1 { scene.effects() - Effects::SCATTERED } else { scene.effects() }
}

/// The edge of the film, in pixels, of which every sample estimates the same number.
const EDGE: u32 = 32;

/// The mean of all samples of all pixels, in the red channel.
///
/// # Panics
/// A sample is not a number.
pub fn measure(scene: Arc<dyn Scene>, integrator: &dyn Integrator, samples: u64, seed: u64) -> Mean {
    let mut film = Pool { spec: FilmSpec::new(EDGE, EDGE), total: Moments::default(), samples: 0 };
    let spp = samples.div_ceil(u64::from(EDGE * EDGE));
    let settings = Settings::new(SamplerSpec { spp, seed, ..SamplerSpec::default() });
    let report = render(scene, integrator, &mut film, &settings, &Silent);
    assert_eq!(report.invalid, 0, "invalid samples: {:?}", report.first_invalid);
    Mean::from_sums(film.total.sum[0], film.total.square[0], film.samples)
}

/// A film that stores a single mean.
struct Pool {
    spec: FilmSpec,
    total: Moments,
    samples: u64,
}

impl Film for Pool {
    fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    fn add(&mut self, wave: Wave, block: PixelSums) {
        self.samples += wave.samples() * block.len() as u64;
        let moments = |pixel: &[f64]| Moments {
            sum: std::array::from_fn(|c| pixel[c]),
            square: std::array::from_fn(|c| pixel[3 + c]),
            ..Moments::default()
        };
        self.total = block.pixels().fold(self.total, |sum, pixel| sum.join(&moments(pixel)));
    }
}

/// A picture with its standard errors.
pub fn picture(scene: Arc<dyn Scene>, integrator: &dyn Integrator, spec: FilmSpec, sampler: SamplerSpec) -> Image {
    let mut film = MomentFilm::new(spec);
    let report = render(scene, integrator, &mut film, &Settings::new(sampler), &Silent);
    assert_eq!(report.invalid, 0, "invalid samples: {:?}", report.first_invalid);
    film.image()
}

/// A scene of which one radiance is known.
pub struct KnownRadiance {
    /// The setup, in a few words.
    pub name: String,
    /// The scene.
    pub scene: Arc<World>,
    /// Radiance along the camera's ray.
    pub radiance: f64,
    /// Limits of the paths.
    pub depth: Depth,
    /// Relative half width of the confidence interval at full effort. A case that cannot reach it fails.
    pub resolution: f64,
    /// The same at the default effort.
    pub standard: f64,
    /// The same for paths that hit the light by chance; `None` if they hit it too rarely.
    pub by_chance: Option<f64>,
    /// Whether light sampling without multiple importance sampling has a usable variance.
    pub lights_alone: bool,
}

impl KnownRadiance {
    /// A resolution of 0.1 % for integrators with light sampling.
    ///
    /// # Panics
    /// The scene is invalid.
    pub fn new(name: impl Into<String>, world: WorldBuilder, radiance: f64, depth: Depth) -> KnownRadiance {
        let scene = Arc::new(world.build().expect("a valid scene"));
        KnownRadiance { name: name.into(), scene, radiance, depth, resolution: 1e-3, standard: 1e-3, by_chance: None, lights_alone: true }
    }

    /// Sets the resolution for paths that hit the light by chance.
    pub fn by_chance(self, standard: f64) -> KnownRadiance {
        KnownRadiance { by_chance: Some(standard), ..self }
    }

    /// Sets the resolutions at full and at the default effort.
    pub fn resolution(self, resolution: f64, standard: f64) -> KnownRadiance {
        KnownRadiance { resolution, standard, ..self }
    }

    /// Leaves out integrators without multiple importance sampling.
    pub fn not_by_lights_alone(self) -> KnownRadiance {
        KnownRadiance { lights_alone: false, ..self }
    }

    /// The resolution for an integrator at the default effort; `None` if the integrator is not asked.
    fn resolution_of(&self, entry: &Entry) -> Option<f64> {
        match entry.name {
            _ if !entry.simulates.contains(needs(&*self.scene, self.depth)) => None,
            "path" => self.by_chance,
            "whitted" => self.lights_alone.then_some(self.standard),
            _ => Some(self.standard),
        }
    }

    /// The integrators that simulate all effects of the scene, each with its case.
    ///
    /// A pilot determines how many samples the resolution takes; the mean that is judged has another seed.
    pub fn cases(self) -> Vec<(String, f64, impl Fn(Effort) -> Answer + Send + Sync + use<>)> {
        let law = Arc::new(self);
        let asked = |entry: &Entry| {
            let (resolution, integrator) = (law.resolution_of(entry)?, integrator(entry, law.depth)?);
            let known = law.clone();
            let ask = move |effort| known.ask(&*integrator, resolution, effort);
            Some((format!("{}, {}", law.name, entry.name), law.radiance, ask))
        };
        crate::integrators::ALL.iter().filter_map(asked).collect()
    }

    fn ask(&self, integrator: &dyn Integrator, standard: f64, effort: Effort) -> Answer {
        let unit = self.radiance.abs();
        let resolution = match effort {
            Effort::Quick => QUICK * standard,
            Effort::Standard => standard,
            Effort::Full => self.resolution,
        };
        match resolve(|samples, seed| measure(self.scene.clone(), integrator, samples, seed), resolution * unit) {
            Ok(mean) => Answer {
                found: mean.value,
                tolerance: critical() * mean.standard_error() + ROUNDING * unit,
                tries: mean.samples as u64,
                note: String::new(),
            },
            Err(note) => Answer { found: f64::NAN, tolerance: resolution * unit, tries: 0, note },
        }
    }
}

/// Factor of the resolution of a quick run, which takes a sixteenth of the samples.
const QUICK: f64 = 4.0;

/// Relative error of a mean due to f32.
pub const ROUNDING: f64 = 1e-5;

const PILOT: u64 = 1 << 13;
const MOST: u64 = 1 << 34;

impl Row {
    /// Adds a case for every integrator that simulates all effects of the scene.
    pub fn radiance(self, known: KnownRadiance) -> Row {
        known.cases().into_iter().fold(self, |row, (setup, expected, ask)| row.answered(setup, expected, ask))
    }
}

/// A mean with the confidence interval ± `half_width`, of as many samples as that takes.
///
/// The variance of a pilot determines the number of samples. If rare bright samples give the run a larger variance, it is repeated with
/// more samples. Every run has its own seed, and whether it is used depends only on its variance, never on its mean.
fn resolve(run: impl Fn(u64, u64) -> Mean, half_width: f64) -> Result<Mean, String> {
    let mut samples = PILOT;
    for seed in 1..=5 {
        let mean = run(samples, seed);
        let needed = mean.variance * mean.samples * (critical() / half_width).powi(2);
        // Without noise no further samples are needed, even for a width of 0.
        if mean.variance == 0.0 || needed <= mean.samples {
            return Ok(mean);
        }
        // A third more samples than needed, because the variance is only an estimate.
        samples = (1.33 * needed) as u64;
        if samples > MOST {
            break;
        }
    }
    Err(format!("under-powered: {samples} samples would not do for ±{half_width:.2e}"))
}
