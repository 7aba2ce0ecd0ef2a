//! Meters: the irradiance on a plane and the radiance from a direction, in units of power or of what the eye sees, with error bars.
//!
//! A reading is the mean of [`SEQUENCES`] means of independently scrambled sequences. Their variance gives the error, without any
//! assumption about the samples of one sequence.

use std::f32::consts::PI;
use std::ops::ControlFlow;

use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::Mean;
use crate::bsdf::{Bsdf, Diffuse};
use crate::effects::Effects;
use crate::integrator::{CameraSample, Context, Estimator, Filled, Interrupt, Space};
use crate::light::LightSampleContext;
use crate::math::photometry::{LUMENS_PER_WATT, luminance};
use crate::math::{Density, Frame, Local, Ray, SolidAnglePdf, Spectrum, warp};
use crate::medium::Inside;
use crate::primitive::Hit;
use crate::sampler::{Kind, SampleNumbers, SamplerSpec, Sequence, dimension, hash};
use crate::scene::{Scene, Surface};
use crate::shape::{SurfacePoint, VertexColor, offset_bound};

/// The number of independent sequences behind a reading, whose means have a variance with 31 degrees of freedom.
pub const SEQUENCES: u32 = 32;
/// The number of samples of each sequence at the first look.
const FIRST: u64 = 16;
/// The share of the variance that a single sequence may have. With normal means a greater share is rarer than 1 in 10⁵ readings; it is a
/// sign of rare bright paths, of which there may be more than the samples met.
const MOST_SHARE: f64 = 0.6;

/// Share of a value that the rounding of positions, directions and radiances to f32 may change, all in one direction.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// A place where light is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meter {
    /// Position (m), less the origin of the scene.
    pub position: Vec3,
    /// What is measured.
    pub quantity: Quantity,
    /// Whether power is measured or what the eye sees.
    pub response: Response,
}

/// How the three colours become the one value of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Power: the mean of red, green and blue.
    Radiometric,
    /// What the eye sees: lumens, see [`photometry`](crate::math::photometry).
    Photometric,
}

/// What a meter measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Irradiance on the side of a plane that the normal faces (W·m⁻²): E = ∫ L cos θ dω over that side, or its mean over a disk.
    Irradiance {
        /// Unit normal.
        normal: Vec3,
        /// Radius of the disk (m); 0 for a point.
        radius: f32,
    },
    /// Mean radiance from a disk of directions (W·m⁻²·sr⁻¹).
    Radiance {
        /// Unit direction of the disk's middle, from which the light comes.
        direction: Vec3,
        /// 1 − cos of half the disk's angle; 0 for a single direction.
        one_minus_cos: f32,
    },
}

/// What a meter has measured so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Red, green, blue (in units of power), and the one value of the response.
    pub values: [Mean; 4],
    /// Number of samples.
    pub samples: u64,
    /// Number of samples that were not finite or were negative, and count as black.
    pub invalid: u64,
    /// Whether one sequence has most of the variance, so that no interval is stated.
    pub has_heavy_tail: bool,
}

impl Reading {
    /// Half the width of the interval that holds the true value with this confidence: by Student's t, and the rounding of f32.
    pub fn half_width(&self, channel: usize, confidence: f64) -> f64 {
        let Ok(student) = StudentsT::new(0.0, 1.0, f64::from(SEQUENCES - 1)) else { return f64::INFINITY };
        let mean = &self.values[channel];
        student.inverse_cdf(0.5 + 0.5 * confidence) * mean.standard_error() + ROUNDING * mean.value
    }

    /// Half the width of the interval of the value, relative to it; infinite where no interval is stated and
    /// where no light has arrived.
    pub fn relative_half_width(&self, confidence: f64) -> f64 {
        match self.values[3].value {
            _ if self.has_heavy_tail => f64::INFINITY,
            0.0 => f64::INFINITY,
            value => self.half_width(3, confidence) / value,
        }
    }
}

/// Measures until `look` breaks, and returns what it breaks with. It gets the reading after 512, 1024, 2048, … samples; each reading has
/// all samples of those before.
///
/// - `sampler`: kind and seed of the numbers; a stratified sampler, which needs to know the number of samples, becomes Sobol'
/// - `index`: number of the meter, so that several have independent numbers
pub fn measure<T>(
    scene: &dyn Scene,
    estimator: &dyn Estimator,
    meter: &Meter,
    (sampler, index): (SamplerSpec, u32),
    interrupt: &(dyn Fn() -> bool + Sync),
    mut look: impl FnMut(&Reading) -> ControlFlow<T>,
) -> T {
    let kind = if sampler.kind == Kind::Stratified { Kind::Sobol } else { sampler.kind };
    let seed = |r: u32| hash::dimension_key(hash::mix(sampler.seed ^ 0x6d65_7465), index.wrapping_mul(SEQUENCES).wrapping_add(r));
    let sequences: Vec<Sequence> = (0..SEQUENCES).map(|r| SamplerSpec { kind, seed: seed(r), ..sampler }.build()).collect();
    let mut sums = vec![Sum::default(); SEQUENCES as usize];
    let mut samples = FIRST;
    loop {
        sums.par_iter_mut().zip(&sequences).for_each(|(sum, sequence)| {
            for k in sum.count..samples {
                let numbers = sequence.sample(UVec2::ZERO, k);
                sum.add(meter.sample(scene, estimator, numbers, Interrupt::new(&|| interrupt())));
            }
        });
        if let ControlFlow::Break(result) = look(&reading(&sums, meter.response)) {
            return result;
        }
        samples *= 2;
    }
}

/// Sums over the samples of one sequence.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    rgb: [f64; 3],
    count: u64,
    invalid: u64,
}

impl Sum {
    fn add(&mut self, value: Spectrum) {
        self.count += 1;
        match value.is_finite() {
            true => self.rgb.iter_mut().zip(value.to_rgb()).for_each(|(sum, x)| *sum += f64::from(x)),
            false => self.invalid += 1,
        }
    }

    /// Red, green, blue, and the value of the response.
    fn means(&self, response: Response) -> [f64; 4] {
        let [r, g, b] = self.rgb.map(|sum| sum / self.count as f64);
        [r, g, b, response.value([r, g, b])]
    }
}

impl Response {
    fn value(self, [r, g, b]: [f64; 3]) -> f64 {
        match self {
            Response::Radiometric => (r + g + b) / 3.0,
            Response::Photometric => LUMENS_PER_WATT * luminance([r, g, b]),
        }
    }
}

fn reading(sums: &[Sum], response: Response) -> Reading {
    let means: Vec<[f64; 4]> = sums.iter().map(|sum| sum.means(response)).collect();
    let values = std::array::from_fn(|channel| {
        let of = || means.iter().map(move |mean| mean[channel]);
        // Deviations from the mean: their squares lose no digits where all means are nearly equal.
        let center = of().sum::<f64>() / means.len() as f64;
        let square = of().map(|x| (x - center) * (x - center)).sum();
        let spread = Mean::from_sums(0.0, square, means.len() as u64);
        Mean { value: center, ..spread }
    });
    let square = |mean: &[f64; 4]| (mean[3] - values[3].value).powi(2);
    let (all, most) = means.iter().map(square).fold((0.0, 0.0), |(all, most): (f64, f64), x| (all + x, most.max(x)));
    Reading {
        values,
        samples: sums.iter().map(|sum| sum.count).sum(),
        invalid: sums.iter().map(|sum| sum.invalid).sum(),
        // Means that differ by rounding only have no tails.
        has_heavy_tail: most > MOST_SHARE * all && values[3].standard_error() > ROUNDING * values[3].value,
    }
}

impl Meter {
    /// An unbiased estimate of the quantity by one sample; not finite if the estimator's radiance is not, or is negative. Where media
    /// scatter the path, it may bring less light than the expected contribution of light sampling, which is subtracted; then the estimate is
    /// negative.
    fn sample(&self, scene: &dyn Scene, estimator: &dyn Estimator, mut numbers: SampleNumbers, interrupt: Interrupt) -> Spectrum {
        let time = if scene.effects().contains(Effects::MOTION) { numbers.get_1d(dimension::TIME) } else { 0.0 };
        match self.quantity {
            Quantity::Irradiance { normal, radius } => {
                let frame = Frame::around(normal);
                let on_disk = warp::disk(numbers.get_2d(dimension::LENS)) * radius;
                let p = self.position + frame.to_world(Local(Vec3::new(on_disk.x, on_disk.y, 0.0)));
                let (plane, inside) = (plane(p, normal), bodies_around(scene, p));
                let direct = direct(scene, &plane, inside, time, &mut numbers);
                let local = warp::cosine_hemisphere(numbers.get_2d(dimension::FILM));
                let ray = plane.spawn(frame.to_world(Local(local)), time);
                let hit = scene.intersect(&ray);
                let sampled = sampled_from_lights(scene, &plane, &ray, hit, local.z / PI);
                let way = Ray { t_max: hit.map_or(f32::INFINITY, |hit| hit.t), ..ray };
                let sampled = sampled * passed(scene, inside, &way, dimension::FILM, &numbers);
                direct + (radiance(estimator, &ray, hit, inside, numbers, interrupt) - sampled) * PI
            }
            Quantity::Radiance { direction, one_minus_cos } => {
                let local = warp::uniform_cone(numbers.get_2d(dimension::FILM), one_minus_cos);
                let ray = Ray { time, ..Ray::new(self.position, Frame::around(direction).to_world(Local(local))) };
                let (hit, inside) = (scene.intersect(&ray), bodies_around(scene, self.position));
                radiance(estimator, &ray, hit, inside, numbers, interrupt)
            }
        }
    }
}

/// The meter's plane as a white surface, off which rays start as off other surfaces there.
fn plane(p: Vec3, normal: Vec3) -> Surface<'static> {
    let offset = offset_bound(normal, p.abs());
    let point = SurfacePoint { p, offset, ng: normal, ns: normal, uv: Vec2::ZERO, color: VertexColor::WHITE };
    Surface::new(point, Bsdf::Diffuse(Diffuse { albedo: Spectrum::ONE }), None)
}

/// The irradiance by one light sample, weighted by the balance heuristic against directions that are sampled by their cosine:
/// Li cos θ / (p_light + cos θ/π); for delta lights the whole of it.
fn direct(scene: &dyn Scene, plane: &Surface, inside: Inside, time: f32, numbers: &mut SampleNumbers) -> Spectrum {
    let (choice, u) = numbers.get_3d(dimension::METER_LIGHT);
    let Some(light) = scene.lights().sample(&context(plane, time), choice, u) else { return Spectrum::BLACK };
    let cos = plane.point.ng.dot(light.wi);
    let shadow_ray = plane.shadow_ray(light.wi, &light.target, time);
    if cos <= 0.0 || scene.occluded(&shadow_ray) {
        return Spectrum::BLACK;
    }
    let arriving = match light.density {
        Density::Delta => light.weight() * cos,
        Density::Smooth(pdf) => light.li * (cos / (pdf.get() + cos / PI)),
    };
    arriving * passed(scene, inside, &shadow_ray, dimension::METER_LIGHT, numbers)
}

/// Bodies with media around a point.
fn bodies_around(scene: &dyn Scene, p: Vec3) -> Inside {
    if scene.media().is_some() { scene.bodies_around(p) } else { Inside::default() }
}

/// Share of the light that media let pass along a ray.
fn passed(scene: &dyn Scene, inside: Inside, ray: &Ray, dimension: u32, numbers: &SampleNumbers) -> Spectrum {
    if scene.media().is_some() { Filled::new(inside).media_transmittance(scene, ray, dimension, numbers) } else { Spectrum::ONE }
}

fn context(plane: &Surface, time: f32) -> LightSampleContext {
    let SurfacePoint { p, ng, ns, .. } = plane.point;
    LightSampleContext { p, ng, ns, transmits: false, time }
}

/// The radiance that arrives along a ray, by the estimator; not a number where the estimator finds one that is negative or not finite.
fn radiance(
    estimator: &dyn Estimator,
    ray: &Ray,
    hit: Option<Hit>,
    inside: Inside,
    numbers: SampleNumbers,
    interrupt: Interrupt,
) -> Spectrum {
    let (pixel, raster, known_hit) = (UVec2::ZERO, Vec2::ZERO, Some(hit));
    let camera = CameraSample { ray: *ray, weight: 1.0, pixel, raster, known_hit, inside, differential: None };
    let radiance = estimator.li(&camera, &mut Context { numbers, recorder: None, interrupt, light_path: None });
    if radiance.is_valid() { radiance } else { Spectrum::gray(f32::NAN) }
}

/// Emitted light that arrives along a ray, from the surface that it hits or from the background, times the MIS weight of light sampling:
/// the sum of Le p_light/(p_light + p).
///
/// - `pdf`: p, the density with which the ray's direction was sampled
fn sampled_from_lights(scene: &dyn Scene, plane: &Surface, ray: &Ray, hit: Option<Hit>, pdf: f32) -> Spectrum {
    let (lights, context) = (scene.lights(), context(plane, ray.time));
    let share = |by_light: SolidAnglePdf| by_light.get() / (by_light.get() + pdf);
    let Some(hit) = hit else {
        let all = lights.background(ray.direction);
        return all.fold(Spectrum::BLACK, |sum, (light, le)| sum + le * share(lights.background_pdf(light, &context, ray.direction)));
    };
    let surface = scene.surface(ray, &hit);
    let le = surface.emitted(-ray.direction);
    if le.is_black() { le } else { le * share(lights.pdf(surface.light, &context, &surface.point)) }
}
