//! Path tracing with the shortcuts of very short programs.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use pt::bsdf::{BsdfSample, Lobe, TransportMode};
use pt::describe::{Direction, Positive, Radiometric};
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraPath, CameraSample, Estimator, Integrator, MAX_DEPTH, PathWalk, Roulette};
use pt::math::{Density, Local, Ray, SolidAnglePdf, Spectrum, Vec2, Vec3, float};
use pt::recorder::{End, Event, Origin, Recorder, Technique};
use pt::sampler::SampleNumbers;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path tracing as in `path`, with options for what postcard-sized programs add or leave out.
///
/// L = Σ_k β_k Le(x_k) + Σ_k β_k f·|cos| π S V(x_k, ω)
///
/// - V: 1 if the first surface along a ray from x_k in the sun's direction ω emits light (a window), otherwise 0
/// - S: radiance of a white matte surface that faces the sun
///
/// With default settings the pictures of scenes without media are those of `path`, bit for bit. `step_off` starts rays at a fixed distance
/// from a surface instead of the error bound of the point, which suits one size of scene only.
///
/// Source: Andrew Kensler's postcard path tracer. Tests: card_is_path_to_the_bit, the_sun_shines_through_windows,
/// only_the_cosine_is_right, the_picture_is_the_originals.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Card {
    /// Greatest number of scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Number of scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
    /// Greatest number of scattering events after which emission that a path hits still counts; `max_depth` where that is less.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub emission_depth: u32,
    /// Distance from a surface at which rays start (m): along their direction, for shadow rays along the normal. Default: just
    /// beyond the error bound of the point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_off: Option<Positive>,
    /// Sunlight that comes in through emitting surfaces, as the radiance of a white matte surface that faces the sun: linear
    /// `[red, green, blue]` (W·m⁻²·sr⁻¹), the sun's irradiance / π. Default: no sun.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sun_radiance: Option<[Radiometric; 3]>,
    /// Direction towards the sun.
    pub sun_direction: Direction,
    /// Distribution of sampled directions above matte surfaces.
    pub hemisphere: Hemisphere,
}

/// Distribution of sampled directions above a matte surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Hemisphere {
    /// Density proportional to the cosine, which is correct.
    #[default]
    Cosine,
    /// Uniform polar angle, weighted as if the density were proportional to the cosine: a common mistake, offered for study.
    Angle,
}

impl Default for Card {
    fn default() -> Card {
        Card {
            max_depth: 64,
            roulette_depth: 4,
            emission_depth: MAX_DEPTH,
            step_off: None,
            sun_radiance: None,
            sun_direction: Direction([0.0, 1.0, 0.0]),
            hemisphere: Hemisphere::Cosine,
        }
    }
}

impl Integrator for Card {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        let emission_depth = self.emission_depth.min(self.max_depth);
        Box::new(Walk {
            scene,
            max_depth: self.max_depth,
            last_depth: match self.sun_radiance {
                Some(_) => emission_depth.max(self.max_depth.saturating_sub(1)),
                None => emission_depth,
            },
            emission_depth,
            roulette: Roulette { from_depth: self.roulette_depth },
            step_off: self.step_off.map(|length| length.get() as f32),
            sun: self.sun_radiance.map(|radiance| Beam::new(self.sun_direction, radiance)),
            hemisphere: self.hemisphere,
        })
    }

    /// Biases of `max_depth` and of the other shortcuts. The integrator without the depth limit follows the same paths up to that depth;
    /// beyond it Russian roulette ends them.
    fn biases(&self) -> Vec<Bias> {
        let roulette_depth = self.roulette_depth.min(self.max_depth);
        let endless = Card { max_depth: MAX_DEPTH, emission_depth: MAX_DEPTH, roulette_depth, ..self.clone() };
        let mut biases = vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(endless) }];
        if let Some(length) = self.step_off {
            let without = Card { step_off: None, ..self.clone() };
            biases.push(Bias { setting: format!("step_off {}", length.get()), without: Box::new(without) });
        }
        if self.hemisphere == Hemisphere::Angle {
            let without = Card { hemisphere: Hemisphere::Cosine, ..self.clone() };
            biases.push(Bias { setting: "hemisphere angle".to_owned(), without: Box::new(without) });
        }
        biases
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    emission_depth: u32,
    /// Depth of the last vertex at which light can be found.
    last_depth: u32,
    roulette: Roulette,
    step_off: Option<f32>,
    sun: Option<Beam>,
    hemisphere: Hemisphere,
}

/// Parallel light of the sun.
struct Beam {
    /// Unit direction towards the sun.
    wi: Vec3,
    /// Irradiance on a plane perpendicular to the light [W·m⁻²].
    irradiance: Spectrum,
}

impl Beam {
    fn new(Direction([x, y, z]): Direction, radiance: [Radiometric; 3]) -> Beam {
        let largest = x.abs().max(y.abs()).max(z.abs());
        let to = [x, y, z].map(|v| v / largest);
        let length = (to[0] * to[0] + to[1] * to[1] + to[2] * to[2]).sqrt();
        let [r, g, b] = radiance.map(|v| (v.get() * PI) as f32);
        Beam { wi: Vec3::from(to.map(|v| (v / length) as f32)), irradiance: Spectrum::rgb(r, g, b) }
    }
}

impl PathWalk for Walk {
    type State = CameraPath;

    fn start(&self, camera: &CameraSample) -> CameraPath {
        CameraPath::new(camera)
    }

    fn step<R: Recorder + ?Sized>(&self, path: &mut CameraPath, numbers: &mut SampleNumbers, recorder: &mut R) -> ControlFlow<Spectrum> {
        let Some(hit) = path.hit(&*self.scene) else {
            let counts = path.depth <= self.emission_depth;
            for (light, radiance) in self.scene.lights().background(path.ray.direction).filter(|_| counts) {
                path.add_emission(radiance, recorder, || Origin::background(light, 1.0));
            }
            return path.end(End::Escaped, recorder);
        };
        let mut surface = path.surface(&*self.scene, &hit);
        let wo = -path.ray.direction;
        recorder.record(|| Event::vertex(path.depth, &path.ray, &hit, &surface, path.beta));
        if path.depth <= self.emission_depth {
            path.add_emission(surface.emitted(wo), recorder, || Origin::emission(&surface, 1.0));
        }
        path.take_wavelength(&mut surface, numbers, recorder);
        if let (Some(sun), true) = (&self.sun, path.depth < self.max_depth)
            && let Some((direct, window)) = self.sunlight(sun, &surface, wo, path.ray.time)
        {
            let technique = Technique::Light { wi: sun.wi, density: Density::Delta };
            path.add_scattered(direct, recorder, || Origin { light: Some(window), technique, weight: 1.0 });
        }
        if path.depth == self.last_depth {
            return path.end(End::DepthLimit, recorder);
        }
        let (choice, u) = numbers.get_3d(dimension::vertex(path.depth, Use::Bsdf));
        path.scatter(&surface, self.sample(&surface, wo, choice, u), self.roulette, numbers, recorder)?;
        if let Some(length) = self.step_off {
            let wi = path.ray.direction;
            path.ray = Ray { time: path.ray.time, ..Ray::new(surface.point.p + wi * length, wi) };
        }
        ControlFlow::Continue(())
    }
}

impl Walk {
    /// Sunlight that the surface scatters into `wo` if it comes in through a window, and the index of that window's light.
    fn sunlight(&self, sun: &Beam, surface: &Surface, wo: Vec3, time: f32) -> Option<(Spectrum, u32)> {
        let f = surface.eval(wo, sun.wi, TransportMode::Radiance);
        if f.is_black() {
            return None;
        }
        let probe = match self.step_off {
            Some(length) => Ray { time, ..Ray::new(surface.point.p + surface.point.ng * length, sun.wi) },
            None => surface.spawn(sun.wi, time),
        };
        let hit = self.scene.intersect(&probe)?;
        let window = self.scene.surface(&probe, &hit);
        window.emission.map(|_| (f * sun.irradiance, window.light))
    }

    fn sample(&self, surface: &Surface, wo: Vec3, choice: f32, u: Vec2) -> Option<(Vec3, BsdfSample)> {
        if self.hemisphere == Hemisphere::Cosine || !surface.bsdf.has_smooth_lobe() {
            return surface.sample(wo, choice, u, TransportMode::Radiance);
        }
        // θ = u π/2, φ = 2π v, with a weight for the cosine's density, which these directions do not have.
        let (sin, cos) = float::sin_cos(u.x * std::f32::consts::FRAC_PI_2);
        let (sin_phi, cos_phi) = float::sin_cos(u.y * std::f32::consts::TAU);
        let up = 1f32.copysign(surface.frame.to_local(wo).cos());
        let local = Local(Vec3::new(sin * cos_phi, sin * sin_phi, cos * up));
        let wi = surface.frame.to_world(local).normalize();
        let density = SolidAnglePdf::new(cos * std::f32::consts::FRAC_1_PI);
        let f = surface.eval(wo, wi, TransportMode::Radiance);
        let sample =
            BsdfSample { wi: local, weight: f / density.get(), density: Density::Smooth(density), lobe: Lobe::Reflection, eta: 1.0 };
        (!f.is_black()).then_some((wi, sample))
    }
}
