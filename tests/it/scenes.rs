//! Scenes and measurements that the tests of light transport share.

use std::sync::Arc;

use glam::DVec3;
use pt::bsdf::{Material, MaterialId};
use pt::camera::{Camera, Perspective, Pose};
use pt::effects::Effects;
use pt::film::{Film, FilmSpec, Image, MomentFilm, Moments, PixelSums, Wave};
use pt::integrator::{Entry, Integrator};
use pt::integrators::nee::Nee;
use pt::integrators::path::Path;
use pt::integrators::whitted::Whitted;
use pt::light::Emitter;
use pt::math::{Rgb, Spectrum, Transform};
use pt::measure::{Mean, critical_z};
use pt::render::{Settings, Silent, render};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use pt::shape::Quad;
use pt::world::{World, WorldBuilder};

/// An upper bound of the number of statistical tests in the suite, which together have 1 % of false alarms.
const SUITE: usize = 1000;

/// Number of standard errors by which a mean may be off.
pub fn critical() -> f64 {
    critical_z(0.01, SUITE)
}

pub fn gray(value: f64) -> Spectrum {
    Spectrum::gray(value as f32)
}

/// The colour that is stored for a spectrum of three coefficients.
pub fn stored(color: Spectrum) -> Rgb {
    let [r, g, b] = color.to_rgb();
    Rgb::new(r, g, b)
}

pub fn glow(radiance: f64) -> Option<Emitter> {
    Some(Emitter::new(stored(gray(radiance))))
}

pub fn two_sided(radiance: f64) -> Option<Emitter> {
    Some(Emitter { two_sided: true, ..Emitter::new(stored(gray(radiance))) })
}

/// A material that absorbs all light and does not require interreflection.
pub fn black() -> Material {
    Material::mirror(Rgb::BLACK)
}

pub fn at(p: DVec3) -> Transform {
    Transform::translate(p).unwrap()
}

/// The plane z = 0 moved to `center`, its +z turned to `normal`.
pub fn facing(center: DVec3, normal: DVec3) -> Transform {
    let up = if normal.normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    Transform::look_at(center, center - normal, up).unwrap()
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
pub fn probe(from: DVec3, to: DVec3) -> Camera {
    let up = if (to - from).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    Camera::Perspective(Perspective::new(Pose::new(&Transform::look_at(from, to, up).unwrap()), 1e-7, 0.0, 1.0))
}

/// Limits of the length of an integrator's paths.
#[derive(Clone, Copy)]
pub struct Depth {
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

/// The edge of the film [pixels] of which every sample estimates the same number.
const EDGE: u32 = 32;

/// The mean of all samples of all pixels, in the red channel.
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
pub struct Law {
    pub name: String,
    pub scene: Arc<World>,
    /// Radiance along the camera's ray.
    pub radiance: f64,
    pub depth: Depth,
    /// Relative half width of the confidence interval. A test that cannot reach it fails.
    pub resolution: f64,
    /// Resolution of a quick run (relative half width).
    pub quick: f64,
    /// Resolution for paths that hit the light by chance; `None` if they hit it too rarely.
    pub by_chance: Option<f64>,
    /// Whether light sampling without multiple importance sampling has a usable variance.
    pub lights_alone: bool,
}

impl Law {
    /// A law with a resolution of 0.1 % for integrators with light sampling.
    pub fn new(name: impl Into<String>, world: WorldBuilder, radiance: f64, depth: Depth) -> Law {
        let scene = Arc::new(world.build().unwrap());
        Law { name: name.into(), scene, radiance, depth, resolution: 1e-3, quick: 1e-3, by_chance: None, lights_alone: true }
    }

    pub fn by_chance(self, quick: f64) -> Law {
        Law { by_chance: Some(quick), ..self }
    }

    pub fn resolution(self, resolution: f64, quick: f64) -> Law {
        Law { resolution, quick, ..self }
    }

    pub fn not_by_lights_alone(self) -> Law {
        Law { lights_alone: false, ..self }
    }

    /// The required resolution for an integrator; `None` if the integrator is not tested.
    fn asked(&self, entry: &Entry, effort: Effort) -> Option<f64> {
        let quick = match entry.name {
            _ if !entry.simulates.contains(needs(&*self.scene, self.depth)) => None,
            "path" => self.by_chance,
            "whitted" => self.lights_alone.then_some(self.quick),
            _ => Some(self.quick),
        };
        quick.map(|quick| if effort == Effort::Full { self.resolution } else { quick })
    }
}

#[derive(Clone, Copy, PartialEq)]
pub enum Effort {
    Quick,
    Full,
}

/// Relative error of a mean due to f32.
pub const ROUNDING: f64 = 1e-5;

const PILOT: u64 = 1 << 13;
const MOST: u64 = 1 << 34;

/// Tests laws with every integrator that simulates all effects of their scene, and panics with a list of all failures.
///
/// A pilot determines how many samples the resolution takes. The test itself has another seed.
pub fn confirm(laws: Vec<Law>, effort: Effort) {
    let mut wrong = vec![];
    for law in &laws {
        let mut asked = 0;
        for entry in pt::integrators::ALL {
            let (Some(resolution), Some(integrator)) = (law.asked(entry, effort), integrator(entry, law.depth)) else { continue };
            asked += 1;
            if let Err(fault) = hold(law, &*integrator, resolution) {
                wrong.push(format!("{} by {}: {fault}", law.name, entry.name));
            }
        }
        assert!(asked > 0, "{}: no integrator was asked", law.name);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn hold(law: &Law, integrator: &dyn Integrator, resolution: f64) -> Result<(), String> {
    let begin = std::time::Instant::now();
    let unit = law.radiance.abs();
    let mean = resolve(|samples, seed| measure(law.scene.clone(), integrator, samples, seed), resolution * unit)?;
    let half_width = critical() * mean.standard_error();
    if std::env::var_os("PT_TEST_VERBOSE").is_some() {
        let (n, error, seconds) = (mean.samples, (mean.value / law.radiance - 1.0) * 100.0, begin.elapsed().as_secs_f64());
        println!("{}: {:.7} ± {half_width:.1e} ({error:+.4} %), {n:.1e} samples, {seconds:.1} s", law.name, mean.value);
    }
    if (mean.value - law.radiance).abs() <= half_width + ROUNDING * unit {
        return Ok(());
    }
    Err(format!("{} ± {half_width:.1e}, expected {}: {:+.2} standard errors", mean.value, law.radiance, mean.z(law.radiance)))
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
