//! Path tracing the way short programs do it.

use std::f64::consts::PI;
use std::sync::Arc;

use pt::bsdf::{BsdfSample, Lobe, TransportMode};
use pt::describe::{Direction, Positive, Radiometric};
use pt::film::FilmSpec;
use pt::integrator::{Bias, CameraSample, Context, Estimator, Integrator, Interrupt, MAX_DEPTH, Roulette};
use pt::math::{Density, Local, Ray, SolidAnglePdf, Spectrum, Vec3, float};
use pt::sampler::Sampler;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};
use pt::witness::{Account, End, Event, Nobody, Origin, Technique};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Paths that end where they meet light, as `path` follows them, with what postcard-sized programs add or leave out.
///
/// L = Σ_k β_k Le(x_k) + Σ_k β_k f·|cos| π S V(x_k, ω)
///
/// - V: whether the first thing that a ray from x_k into the sun's direction ω meets is something that emits: a window
/// - S: what a white matte surface that faces the sun would shine with
///
/// With its defaults it is `path`, bit for bit. `step_off` starts rays at a fixed length off a surface, in place of the
/// error bound of the point: right for one size of scene.
///
/// Source: Andrew Kensler's postcard path tracer. Tests: card_is_path_to_the_bit, the_sun_shines_through_windows,
/// only_the_cosine_is_right, the_picture_is_the_originals.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Card {
    /// The most scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
    /// The most scattering events after which emission counts that a path meets; `max_depth` where that is less.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub emission_depth: u32,
    /// How far from a surface rays start: along their direction, shadow rays along the normal (m). Default: beyond the
    /// error bound of the point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_off: Option<Positive>,
    /// Light from far away that comes in through whatever emits: what a white matte surface shines with that faces it, linear
    /// `[red, green, blue]` (W·m⁻²·sr⁻¹), its irradiance / π. Default: no sun.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sun_radiance: Option<[Radiometric; 3]>,
    /// Where the sun stands.
    pub sun_direction: Direction,
    /// How matte surfaces choose the next direction.
    pub hemisphere: Hemisphere,
}

/// Directions above a matte surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Hemisphere {
    /// With a density proportional to the cosine: right.
    #[default]
    Cosine,
    /// With an even polar angle, weighed as if it were the cosine's density: a usual mistake, to be looked at.
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
        let met = self.emission_depth.min(self.max_depth);
        Box::new(Walk {
            scene,
            max_depth: self.max_depth,
            last: if self.sun_radiance.is_some() { met.max(self.max_depth.saturating_sub(1)) } else { met },
            emission_depth: met,
            roulette: Roulette { from_depth: self.roulette_depth },
            step_off: self.step_off.map(|length| length.get() as f32),
            sun: self.sun_radiance.map(|radiance| Beam::new(self.sun_direction, radiance)),
            hemisphere: self.hemisphere,
        })
    }

    /// Without a limit Russian roulette ends the paths; up to the limit they are the same paths.
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
    /// The last vertex at which there is light to find.
    last: u32,
    roulette: Roulette,
    step_off: Option<f32>,
    sun: Option<Beam>,
    hemisphere: Hemisphere,
}

/// The sun as seen from anywhere.
struct Beam {
    /// To it, unit.
    wi: Vec3,
    /// On a plane across the light [W·m⁻²].
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

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        match cx.witness.take() {
            None => self.walk(camera, cx.sampler, &mut Nobody, cx.interrupt),
            Some(witness) => self.walk(camera, cx.sampler, witness, cx.interrupt),
        }
    }
}

impl Walk {
    fn walk<A: Account + ?Sized>(
        &self,
        camera: &CameraSample,
        sampler: &mut dyn Sampler,
        account: &mut A,
        interrupt: Interrupt,
    ) -> Spectrum {
        let mut ray = camera.ray;
        let mut beta = Spectrum::ONE;
        let mut radiance = Spectrum::BLACK;
        let mut compression = 1.0;
        for depth in 0.. {
            if interrupt.ends(depth) {
                break;
            }
            let Some(hit) = self.scene.intersect(&ray) else {
                let lights = self.scene.lights();
                let light = if depth > self.emission_depth { Spectrum::BLACK } else { lights.background(&ray) };
                radiance += account.light(beta * light, depth, || Origin::background(lights, 1.0));
                account.tell(|| Event::end(depth, End::Escaped));
                break;
            };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            account.tell(|| Event::vertex(depth, &ray, &hit, &surface, beta));
            if depth <= self.emission_depth {
                radiance += account.light(beta * surface.emitted(wo), depth, || Origin::emission(&surface, 1.0));
            }
            if let (Some(sun), true) = (&self.sun, depth < self.max_depth)
                && let Some((direct, window)) = self.sunlight(sun, &surface, wo, ray.time)
            {
                let technique = Technique::Light { wi: sun.wi, density: Density::Delta };
                radiance += account.light(beta * direct, depth + 1, || Origin { light: Some(window), technique, weight: 1.0 });
            }
            if depth == self.last {
                account.tell(|| Event::end(depth, End::DepthLimit));
                break;
            }
            sampler.at(dimension::vertex(depth, Use::Bsdf));
            let Some((wi, sample)) = self.scatter(&surface, wo, sampler) else {
                account.tell(|| Event::end(depth, End::Absorbed));
                break;
            };
            beta *= sample.weight;
            compression *= sample.eta * sample.eta;
            let carried = beta * compression;
            account.tell(|| Event::scattering(depth, &surface, wo, &(wi, sample), self.roulette.chance(depth, carried)));
            let Some(survivors) = self.roulette.survive(depth, carried, sampler) else {
                account.tell(|| Event::end(depth, End::Roulette));
                break;
            };
            beta *= survivors;
            ray = match self.step_off {
                Some(length) => Ray { time: ray.time, ..Ray::new(surface.point.p + wi * length, wi) },
                None => surface.spawn(wi, ray.time),
            };
        }
        radiance
    }

    /// Light of the sun that the surface scatters into `wo`, where it comes in through a window; and that window's light.
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

    fn scatter(&self, surface: &Surface, wo: Vec3, sampler: &mut dyn Sampler) -> Option<(Vec3, BsdfSample)> {
        let (choice, u) = (sampler.next_1d(), sampler.next_2d());
        if self.hemisphere == Hemisphere::Cosine || !surface.bsdf.has_smooth_lobe() {
            return surface.sample(wo, choice, u, TransportMode::Radiance);
        }
        // θ = u π/2, φ = 2π v; weighed by the density that these directions do not have.
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
