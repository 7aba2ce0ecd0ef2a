//! Lights and light sampling.
//!
//! A new light is a file in this folder, a variant in [`Light`] with an arm in each `match`, and a variant in `describe::light`.

pub mod area;
mod area_motion;
mod bounds;
mod choice;
pub mod directional;
mod distribution;
mod emission_distribution;
mod emitted_ray;
mod emitter;
pub mod environment;
pub mod environment_map;
mod flat_share;
mod placed;
pub mod point;
pub mod profile;
mod projector;
pub mod sky;
pub mod spot;
pub mod sun;
mod tree;

use std::sync::Arc;

use glam::{DVec3, Mat3, Vec2, Vec3};

use self::bounds::LightBounds;
pub(crate) use self::choice::{Choice, ChosenLanes, OneSidedLanes};
use self::emitted_ray::{EmissionContext, pdf_from_infinity};
use self::environment_map::IrradianceMap;
use crate::effects::Effects;
use crate::math::{Aabb, Density, Discrete, SolidAnglePdf, Spectrum};
use crate::shape::{Shape, SurfacePoint};

pub use area::Area;
pub use area_motion::EmitterMotion;
pub use directional::Directional;
pub use emitted_ray::{EmissionDensity, EmittedRay};
pub use emitter::{Emission, Emitter};
pub use environment::Environment;
pub use environment_map::{EnvironmentMap, Mapping};
pub use placed::Placed;
pub use point::Point;
pub use profile::{IntensityProfile, ProfiledPoint};
pub use projector::Projector;
pub use sky::{Sky, SkyLight};
pub use spot::{Falloff, Spot};
pub use sun::Sun;

/// Light of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// Emitting primitive of a shape.
    Area(Area),
    /// Point light.
    Point(Point),
    /// Point light with a cone.
    Spot(Spot),
    /// Point light with a measured intensity for each direction.
    Profiled(ProfiledPoint),
    /// Spotlight that projects a picture.
    Projector(Box<Projector>),
    /// Parallel light.
    Directional(Directional),
    /// Disk of light, infinitely far away.
    Sun(Sun),
    /// Constant environment: the same radiance from all directions.
    Environment(Environment),
    /// Environment map: radiance from all directions, given by a picture.
    EnvironmentMap(Arc<EnvironmentMap>),
    /// Light without a surface that a transform places, and may move.
    Placed(Box<Placed>),
}

/// Point that a light is sampled for. The choice among lights and the densities of directions may depend on all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSampleContext {
    /// Position from which shadow rays start (m).
    pub p: Vec3,
    /// Geometric normal; zero where there is no surface.
    pub ng: Vec3,
    /// Shading normal on the side of the viewer; zero where there is no surface.
    pub ns: Vec3,
    /// Whether light from behind `ns` may be scattered to the viewer too.
    pub transmits: bool,
    /// Time at which the path passes the point.
    pub time: f32,
}

impl LightSampleContext {
    /// A point in empty space, at time 0.
    pub fn at(p: Vec3) -> LightSampleContext {
        LightSampleContext { p, ng: Vec3::ZERO, ns: Vec3::ZERO, transmits: false, time: 0.0 }
    }

    /// Whether only light on the side of the viewer counts.
    pub fn is_one_sided(&self) -> bool {
        !self.transmits && self.ns != Vec3::ZERO
    }
}

/// Sampled direction towards a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction from the lit point, in world space.
    pub wi: Vec3,
    /// Radiance that arrives along `wi`; for delta lights the irradiance on a plane perpendicular to `wi`.
    pub li: Spectrum,
    /// Density of `wi`, including the probability of the light.
    pub density: Density,
    /// Probability with which the light was chosen.
    pub probability: f32,
    /// Far end of the shadow ray.
    pub target: ShadowTarget,
    /// Index of the light.
    pub light: u32,
}

impl LightSample {
    /// Radiance divided by the density; for delta lights the irradiance divided by the probability of the light.
    pub fn weight(&self) -> Spectrum {
        match self.density {
            Density::Smooth(pdf) => self.li / pdf.get(),
            Density::Delta => self.li / self.probability,
        }
    }
}

/// Far end of a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShadowTarget {
    /// No end: the light is infinitely far away.
    Infinity,
    /// Point in empty space.
    Point(Vec3),
    /// Point on a surface, which must not shadow itself.
    Surface(SurfacePoint),
}

/// Sample of one light, without the probability of choosing the light.
struct LightLiSample {
    wi: Vec3,
    /// Radiance; for delta lights irradiance on a plane perpendicular to `wi`.
    li: Spectrum,
    density: Density,
    target: ShadowTarget,
}

/// Irradiance from a light that is infinitely far away, the mean of the colour components [W·m⁻²].
enum InfiniteIrradiance {
    /// Irradiance that is equal on one side of any plane.
    Equal(f64),
    /// On a plane that faces the light, with the unit direction towards its middle, and the sine of the half angle of its disk.
    Towards(Vec3, f64, f32),
    /// By the normal in the coordinates that the rotation leads to.
    Map(Mat3, IrradianceMap),
}

/// Lights of a scene.
pub struct Lights {
    shapes: Arc<[Box<dyn Shape>]>,
    /// Centre and radius of the scene's bounding sphere (m).
    bounds: (Vec3, f32),
    lights: Vec<Light>,
    /// Choice of a light for a point.
    choice: Choice,
    /// Choice of a light that emits a ray, see [`emission_weights`].
    emission: Option<Discrete>,
    /// Indices of the infinitely distant lights that emit and that rays which hit nothing can see: suns and environments.
    infinite: Vec<u32>,
    /// Effects that simulating the lights requires.
    effects: Effects,
}

impl Lights {
    /// Lights of a scene.
    ///
    /// - `bounds`: centre and radius of the scene's bounding sphere (m), which determines the power of distant lights
    pub fn new(lights: Vec<Light>, shapes: Arc<[Box<dyn Shape>]>, bounds: (Vec3, f32)) -> Lights {
        let lights = area::distributed(lights, &shapes);
        let power: Vec<f64> = lights.iter().map(|light| light.power(&shapes, bounds.1.into())).collect();
        let infinite = (0..).zip(&lights).filter(|(_, light)| light.is_background() && !light.is_black()).map(|(i, _)| i).collect();
        let of = |light: &Light| match light {
            Light::Area(area) if area.is_unsampled(&shapes) => Effects::UNSAMPLED_EMITTER,
            _ => light.effects(),
        };
        let effects = lights.iter().map(of).fold(Effects::NONE, Effects::union);
        let light_bounds = lights.iter().zip(&power).map(|(light, power)| (*power > 0.0).then(|| light.bounds(&shapes)).flatten());
        let choice = Choice::new(&lights, light_bounds.collect());
        let emission = Discrete::new(&emission_weights(&power));
        Lights { shapes, bounds, choice, emission, infinite, lights, effects }
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether there are no lights.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// The choice, if there are so few lights that one can be chosen in each lane.
    pub(crate) fn choice_of_few(&self) -> Option<&Choice> {
        Some(&self.choice).filter(|choice| choice.has_lanes())
    }

    /// The only light that can be chosen, if there is just one.
    pub(crate) fn only(&self) -> Option<u32> {
        self.choice.only()
    }

    /// Whether any light has a radiance, intensity or irradiance above 0.
    pub fn has_emission(&self) -> bool {
        self.lights.iter().any(|light| !light.is_black())
    }

    /// Number of lights without any radiance, intensity or irradiance.
    pub fn black_count(&self) -> usize {
        self.lights.iter().filter(|light| light.is_black()).count()
    }

    /// A light. Panics if there is no such light.
    pub(crate) fn get(&self, index: u32) -> &Light {
        &self.lights[index as usize]
    }

    /// The lights, in the order of their indices.
    pub fn iter(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter()
    }

    /// Effects that simulating the lights requires.
    pub fn effects(&self) -> Effects {
        self.effects
    }

    /// Samples a direction towards a light.
    ///
    /// - `choice`: uniform number that chooses the light
    /// - `u`: uniform numbers that choose the direction
    ///
    /// `None` if the chosen light sends no light from the sampled direction.
    #[inline]
    pub fn sample(&self, cx: &LightSampleContext, choice: f32, u: Vec2) -> Option<LightSample> {
        self.sample_of(self.choose(cx, choice)?, cx, u)
    }

    /// Chooses a light, with its probability; `None` if no light reaches the point.
    ///
    /// - `choice`: uniform number in [0, 1)
    pub(crate) fn choose(&self, cx: &LightSampleContext, choice: f32) -> Option<(u32, f32)> {
        self.choice.sample(cx, choice)
    }

    /// Samples a direction towards a chosen light.
    pub(crate) fn sample_of(&self, (light, probability): (u32, f32), cx: &LightSampleContext, u: Vec2) -> Option<LightSample> {
        let LightLiSample { wi, li, density, target } = self.lights[light as usize].sample(&self.shapes, cx, u)?;
        let density = match density {
            Density::Delta => Density::Delta,
            Density::Smooth(pdf) => Density::Smooth(pdf * probability),
        };
        Some(LightSample { wi, li, density, probability, target, light })
    }

    /// Samples a ray that a light emits.
    ///
    /// - `choice`: uniform number that chooses the light
    /// - `position`, `direction`: uniform numbers that choose the start and the direction of the ray
    /// - `time`: fraction of the shutter interval, in [0, 1); 0 where nothing moves
    ///
    /// `None` if the chosen light emits nothing along the sampled ray.
    pub fn emit(&self, choice: f32, position: Vec2, direction: Vec2, time: f32) -> Option<EmittedRay> {
        let (index, probability, _) = self.emission.as_ref()?.sample(choice);
        let cx = EmissionContext { light: index as u32, probability, bounds: self.bounds, position, direction, time };
        self.lights[index].emit(&self.shapes, &cx)
    }

    /// A point of a light that is chosen by its power; `None` if that light is infinitely far away.
    ///
    /// - `choice`, `u`: uniform numbers that choose the light and the point
    /// - `time`: fraction of the shutter interval
    pub fn place(&self, choice: f32, u: Vec2, time: f32) -> Option<Vec3> {
        self.lights[self.emission.as_ref()?.sample(choice).0].place(&self.shapes, u, time)
    }

    /// The only light that [`Lights::place`] can choose, if there is just one.
    pub(crate) fn only_emitter(&self) -> Option<u32> {
        self.choice.only().filter(|only| self.emission_probability(*only) == 1.0)
    }

    /// Probability with which [`Lights::emit`] chooses the light `index`.
    pub fn emission_probability(&self, index: u32) -> f32 {
        self.emission.as_ref().map_or(0.0, |choice| choice.pmf(index as usize))
    }

    /// Densities with which [`Lights::emit`] samples a given ray once it has chosen the light `index`.
    ///
    /// A delta distribution is stated as such, whether or not the ray belongs to it. A one-sided light emits no ray backwards, nor a
    /// spotlight one outside of its cone: the density of such a direction is 0.
    ///
    /// - `point`: start of the ray on an area light, `None` for other lights
    /// - `w`: unit direction of the ray
    /// - `time`: fraction of the shutter interval
    ///
    /// Tests: given_rays_have_the_densities_of_emitted_rays.
    pub fn emission_density(&self, index: u32, point: Option<&SurfacePoint>, w: Vec3, time: f32) -> EmissionDensity {
        self.lights[index as usize].emission_density(&self.shapes, self.bounds.1, (point, w, time))
    }

    /// Density with which [`Lights::sample`] samples `point`, a point of the area light `index`.
    pub fn pdf(&self, index: u32, cx: &LightSampleContext, point: &SurfacePoint) -> SolidAnglePdf {
        match &self.lights[index as usize] {
            Light::Area(area) => area.pdf_from(&self.shapes, cx, point) * self.probability(index, cx),
            _ => SolidAnglePdf::ZERO,
        }
    }

    /// Indices of the infinitely distant lights that rays which hit nothing can see: suns and environments, but no delta lights.
    pub(crate) fn infinite(&self) -> &[u32] {
        &self.infinite
    }

    /// Radiance of each infinitely distant light that arrives along a ray which hits nothing, and the index of the light.
    ///
    /// - `direction`: direction of the ray
    #[inline]
    pub fn background(&self, direction: Vec3) -> impl Iterator<Item = (u32, Spectrum)> {
        self.infinite.iter().map(move |&i| (i, self.lights[i as usize].background(direction)))
    }

    /// Density with which [`Lights::sample`] samples the direction `wi` of the infinitely distant light `index`.
    pub fn background_pdf(&self, index: u32, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        self.lights[index as usize].background_pdf(cx, wi) * self.probability(index, cx)
    }

    /// Probability with which [`Lights::sample`] chooses the light `index`.
    pub fn probability(&self, index: u32, cx: &LightSampleContext) -> f32 {
        self.choice.probability(cx, index)
    }
}

/// Fraction of the rays from the lights that is divided equally among all lights.
const UNIFORM_FRACTION: f64 = 0.125;

/// Probabilities of the lights that emit rays: proportional to power, but at least `UNIFORM_FRACTION`/n for each of the n lights.
///
/// Power alone is a poor choice where the camera sees what a weak light shines on, and a probability below the resolution of a random
/// number would lose the light altogether. Only ratios count, so that scaling all lights changes nothing.
fn emission_weights(power: &[f64]) -> Vec<f32> {
    let total: f64 = power.iter().sum();
    let emitting = power.iter().filter(|&&p| p > 0.0).count() as f64;
    let weight = |&p: &f64| if p > 0.0 { (1.0 - UNIFORM_FRACTION) * (p / total) + UNIFORM_FRACTION / emitting } else { 0.0 };
    power.iter().map(|p| weight(p) as f32).collect()
}

impl Light {
    #[inline]
    fn sample(&self, shapes: &[Box<dyn Shape>], cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        match self {
            Light::Area(area) => area.sample(shapes, cx, u),
            Light::Point(point) => point.sample(cx.p),
            Light::Spot(spot) => spot.sample(cx.p),
            Light::Profiled(point) => point.sample(cx.p),
            Light::Projector(projector) => projector.sample(cx.p),
            Light::Directional(directional) => directional.sample(),
            Light::Sun(sun) => sun.sample(u),
            Light::Environment(environment) => environment.sample(cx, u),
            Light::EnvironmentMap(map) => map.sample(cx, u),
            Light::Placed(placed) => placed.sample(shapes, cx, u),
        }
    }

    /// A point of the light at a time, see [`Lights::place`].
    fn place(&self, shapes: &[Box<dyn Shape>], u: Vec2, time: f32) -> Option<Vec3> {
        match self {
            Light::Area(area) => area.place(shapes, u, time),
            Light::Point(light) => Some(light.position.as_vec3()),
            Light::Spot(light) => Some(light.position.as_vec3()),
            Light::Profiled(light) => Some(light.position.as_vec3()),
            Light::Projector(light) => Some(light.spot.position.as_vec3()),
            Light::Directional(_) | Light::Sun(_) | Light::Environment(_) | Light::EnvironmentMap(_) => None,
            Light::Placed(placed) => placed.light().place(shapes, u, time).map(|p| placed.point(p, time)),
        }
    }

    /// Densities of a given ray, see [`Lights::emission_density`].
    ///
    /// - `radius`: radius of the scene's bounding sphere (m)
    fn emission_density(
        &self,
        shapes: &[Box<dyn Shape>],
        radius: f32,
        (point, w, time): (Option<&SurfacePoint>, Vec3, f32),
    ) -> EmissionDensity {
        let from_infinity = Density::Smooth(pdf_from_infinity(radius));
        let (position, direction) = match self {
            Light::Area(area) => area.emission_density(shapes, point, w, time),
            Light::Point(point) => (Density::Delta, Density::Smooth(point.emission_pdf())),
            Light::Spot(spot) => (Density::Delta, Density::Smooth(spot.emission_pdf(w))),
            Light::Profiled(point) => (Density::Delta, Density::Smooth(point.emission_pdf(w))),
            Light::Projector(projector) => (Density::Delta, Density::Smooth(projector.emission_pdf(w))),
            Light::Directional(_) => (from_infinity, Density::Delta),
            Light::Sun(sun) => (from_infinity, Density::Smooth(sun.pdf(-w))),
            Light::Environment(environment) => (from_infinity, Density::Smooth(environment.emission_pdf())),
            Light::EnvironmentMap(map) => (from_infinity, Density::Smooth(map.emission_pdf(-w))),
            Light::Placed(placed) => {
                return placed.light().emission_density(shapes, radius, (point, placed.direction_to_local(w, time), time));
            }
        };
        EmissionDensity { position, direction }
    }

    fn emit(&self, shapes: &[Box<dyn Shape>], cx: &EmissionContext) -> Option<EmittedRay> {
        match self {
            Light::Area(area) => area.emit(shapes, cx),
            Light::Point(point) => point.emit(cx),
            Light::Spot(spot) => spot.emit(cx),
            Light::Profiled(point) => point.emit(cx),
            Light::Projector(projector) => projector.emit(cx),
            Light::Directional(directional) => directional.emit(cx),
            Light::Sun(sun) => sun.emit(cx),
            Light::Environment(environment) => environment.emit(cx),
            Light::EnvironmentMap(map) => map.emit(cx),
            Light::Placed(placed) => placed.emit(shapes, cx),
        }
    }

    /// Bounds for the choice of the light; `None` if it is infinitely far away.
    fn bounds(&self, shapes: &[Box<dyn Shape>]) -> Option<LightBounds> {
        match self {
            Light::Area(area) => Some(area.bounds(shapes)),
            Light::Point(point) => Some(LightBounds::all_directions(Aabb::around([point.position.as_vec3()]), point.intensity())),
            Light::Spot(spot) => Some(spot.bounds()),
            Light::Profiled(point) => Some(point.bounds()),
            Light::Projector(projector) => Some(projector.bounds()),
            Light::Placed(placed) => placed.bounds(shapes),
            Light::Directional(_) | Light::Sun(_) | Light::Environment(_) | Light::EnvironmentMap(_) => None,
        }
    }

    /// Whether rays that hit nothing can see the light: true for suns and environments.
    fn is_background(&self) -> bool {
        matches!(self, Light::Sun(_) | Light::Environment(_) | Light::EnvironmentMap(_))
    }

    /// Radiance that arrives from infinity along a ray in a direction; 0 for lights that no ray meets there.
    pub(crate) fn background(&self, direction: Vec3) -> Spectrum {
        match self {
            Light::Environment(environment) => environment.radiance(direction),
            Light::EnvironmentMap(map) => map.radiance(direction),
            Light::Sun(sun) => sun.radiance(direction),
            _ => Spectrum::BLACK,
        }
    }

    /// Density with which the light samples the direction `wi` of [`Light::background`] for a point.
    pub(crate) fn background_pdf(&self, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        match self {
            Light::Environment(environment) => environment.pdf(cx, wi),
            Light::EnvironmentMap(map) => map.pdf(cx, wi),
            Light::Sun(sun) => sun.pdf(wi),
            _ => SolidAnglePdf::ZERO,
        }
    }

    /// Irradiance from an infinitely distant light; `None` for other lights.
    fn infinite_irradiance(&self) -> Option<InfiniteIrradiance> {
        let average = |rgb| f64::from(Spectrum::from_illuminant(rgb).average());
        match self {
            Light::Directional(directional) => {
                Some(InfiniteIrradiance::Towards(-directional.direction, average(directional.irradiance), 0.0))
            }
            Light::Sun(sun) => Some(InfiniteIrradiance::Towards(-sun.direction, sun.irradiance(), sun.sine())),
            Light::Environment(environment) => Some(InfiniteIrradiance::Equal(std::f64::consts::PI * average(environment.radiance))),
            Light::EnvironmentMap(map) => {
                let (rotation, irradiance) = map.irradiance();
                Some(InfiniteIrradiance::Map(rotation, irradiance))
            }
            // It may come from any side.
            Light::Placed(placed) => match placed.light() {
                Light::Directional(directional) => Some(InfiniteIrradiance::Equal(average(directional.irradiance))),
                _ => None,
            },
            Light::Area(_) | Light::Point(_) | Light::Spot(_) | Light::Profiled(_) | Light::Projector(_) => None,
        }
    }

    /// Whether the light emits nothing in any direction.
    fn is_black(&self) -> bool {
        match self {
            Light::Area(area) => area.emitter.radiance.is_black(),
            Light::Point(point) => point.intensity.is_black(),
            Light::Spot(spot) => spot.intensity.is_black(),
            Light::Profiled(point) => point.intensity.is_black(),
            Light::Projector(projector) => projector.is_black(),
            Light::Directional(directional) => directional.irradiance.is_black(),
            Light::Sun(sun) => sun.radiance.is_black(),
            Light::Environment(environment) => environment.radiance.is_black(),
            Light::EnvironmentMap(map) => map.mean() == 0.0,
            Light::Placed(placed) => placed.light().is_black(),
        }
    }

    /// Estimate of the flux (W), for the choice of lights that emit rays. The light is never chosen if it is 0.
    fn power(&self, shapes: &[Box<dyn Shape>], radius: f64) -> f64 {
        match self {
            Light::Area(area) => area.power(shapes),
            Light::Point(point) => point.power(),
            Light::Spot(spot) => spot.power(),
            Light::Profiled(point) => point.power(),
            Light::Projector(projector) => projector.power(),
            Light::Directional(directional) => directional.power(radius),
            Light::Sun(sun) => sun.power(radius),
            Light::Environment(environment) => environment.power(radius),
            Light::EnvironmentMap(map) => map.power(radius),
            Light::Placed(placed) => placed.light().power(shapes, radius),
        }
    }

    /// The light in coordinates shifted by −`origin`.
    pub fn recentred(mut self, origin: DVec3) -> Light {
        match &mut self {
            Light::Placed(placed) => **placed = placed.clone().recentred(origin),
            Light::Point(point) => point.position -= origin,
            Light::Spot(spot) => spot.position -= origin,
            Light::Profiled(point) => point.position -= origin,
            Light::Projector(projector) => projector.spot.position -= origin,
            Light::Area(_) | Light::Directional(_) | Light::Sun(_) | Light::Environment(_) | Light::EnvironmentMap(_) => {}
        }
        self
    }

    /// Effects that simulating the light requires; none if it is black. Points are taken to be samplable.
    pub fn effects(&self) -> Effects {
        match self {
            _ if self.is_black() => Effects::NONE,
            Light::Area(_) => Effects::AREA_LIGHT,
            Light::Point(_) | Light::Spot(_) | Light::Profiled(_) | Light::Projector(_) | Light::Directional(_) => Effects::POINT_LIGHT,
            Light::Sun(_) | Light::Environment(_) | Light::EnvironmentMap(_) => Effects::ENVIRONMENT,
            Light::Placed(placed) => placed.effects(),
        }
    }
}
