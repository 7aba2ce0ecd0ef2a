//! Where light comes from.
//!
//! To add a light: a file beside these, a variant in [`Light`] and an arm in each `match`,
//! a variant in `describe::light`.

pub mod area;
pub mod directional;
pub mod environment;
pub mod point;
pub mod spot;

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use crate::effects::Effects;
use crate::math::{Density, Discrete, Ray, SolidAnglePdf, Spectrum};
use crate::shape::{Shape, SurfacePoint};

pub use area::{Area, Emission, Emitter};
pub use directional::Directional;
pub use environment::Environment;
pub use point::Point;
pub use spot::{Falloff, Spot};

#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// One primitive that emits.
    Area(Area),
    Point(Point),
    Spot(Spot),
    Directional(Directional),
    Environment(Environment),
}

/// A direction towards light, from a point that is to be lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// World space, unit, away from the lit point.
    pub wi: Vec3,
    /// Radiance / density, where there is a density; irradiance on a plane across `wi` for delta lights.
    /// The choice among the lights is divided out.
    pub weight: Spectrum,
    /// The density of `wi`, the choice among the lights included.
    pub density: Density,
    /// Where the shadow ray must reach.
    pub target: Target,
    /// Its index among the lights.
    pub light: u32,
}

/// The far end of a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Infinitely far away.
    Infinity,
    /// A point in empty space.
    Free(Vec3),
    /// A point on a surface, which must not shadow itself.
    Surface(SurfacePoint),
}

/// What one light offers to a point; the choice among lights is not yet in it.
struct Offer {
    wi: Vec3,
    /// Radiance, or irradiance for delta lights.
    li: Spectrum,
    density: Density,
    target: Target,
}

/// The lights of a scene.
pub struct Lights {
    shapes: Arc<[Box<dyn Shape>]>,
    lights: Vec<Light>,
    /// By power, mostly: [`shares`].
    choice: Option<Discrete>,
    /// The index of the environment among the lights.
    environment: Option<u32>,
    /// Whether some emit that cannot be sampled.
    found: bool,
}

impl Lights {
    /// - `radius`: of the scene's bounding sphere (m): what distant lights shine upon
    pub fn new(lights: Vec<Light>, shapes: Arc<[Box<dyn Shape>]>, radius: f32) -> Lights {
        let power: Vec<f64> = lights.iter().map(|light| light.power(&shapes, radius.into())).collect();
        let environment = lights.iter().position(|l| matches!(l, Light::Environment(_))).map(|i| i as u32);
        let found = lights.iter().any(|light| matches!(light, Light::Area(area) if area.is_found(&shapes)));
        Lights { shapes, choice: Discrete::new(&shares(&power)), environment, lights, found }
    }

    pub fn len(&self) -> usize {
        self.lights.len()
    }

    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Whether any of them is not black, however small it is.
    pub fn shine(&self) -> bool {
        self.lights.iter().any(|light| !light.is_black())
    }

    pub fn iter(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter()
    }

    pub fn effects(&self) -> Effects {
        let found = if self.found { Effects::FOUND_LIGHT } else { Effects::NONE };
        self.lights.iter().map(Light::effects).fold(found, Effects::union)
    }

    /// A direction towards some light, chosen by power with `choice`, on it with `u`.
    ///
    /// `None`: no light this way.
    pub fn sample(&self, from: Vec3, choice: f32, u: Vec2) -> Option<LightSample> {
        let (index, probability, _) = self.choice.as_ref()?.sample(choice);
        let offer = self.lights[index].sample(&self.shapes, from, u)?;
        let (weight, density) = match offer.density {
            Density::Delta => (offer.li / probability, Density::Delta),
            Density::Smooth(pdf) => (offer.li / (pdf * probability).get(), Density::Smooth(pdf * probability)),
        };
        Some(LightSample { wi: offer.wi, weight, density, target: offer.target, light: index as u32 })
    }

    /// The density with which [`Lights::sample`] at `from` finds `point`, a point of the area light `index`.
    pub fn pdf(&self, index: u32, from: Vec3, point: &SurfacePoint) -> SolidAnglePdf {
        match &self.lights[index as usize] {
            Light::Area(area) => self.shapes[area.shape as usize].pdf_from(area.primitive, from, point) * self.probability(index),
            _ => SolidAnglePdf::ZERO,
        }
    }

    /// The index of the background, where it is a light.
    pub fn environment(&self) -> Option<u32> {
        self.environment
    }

    /// What comes from infinitely far away along `ray`.
    pub fn background(&self, ray: &Ray) -> Spectrum {
        match self.environment.map(|i| &self.lights[i as usize]) {
            Some(Light::Environment(environment)) => environment.radiance(ray.direction),
            _ => Spectrum::BLACK,
        }
    }

    /// The density with which [`Lights::sample`] finds the direction `wi` of the background.
    pub fn background_pdf(&self, wi: Vec3) -> SolidAnglePdf {
        match self.environment.map(|i| (i, &self.lights[i as usize])) {
            Some((i, Light::Environment(environment))) => environment.pdf(wi) * self.probability(i),
            _ => SolidAnglePdf::ZERO,
        }
    }

    fn probability(&self, index: u32) -> f32 {
        self.choice.as_ref().map_or(0.0, |choice| choice.pmf(index as usize))
    }
}

/// The share of the choices that goes to all lights alike.
const ALIKE: f64 = 0.125;

/// How often each light is chosen: by power, but none that shines less often than ALIKE/n.
///
/// Power is a poor guide where a weak light is near and a mighty one far away; and a probability below
/// what a random number resolves would lose the light altogether. Ratios only: scaling changes nothing.
fn shares(power: &[f64]) -> Vec<f32> {
    let total: f64 = power.iter().sum();
    let shining = power.iter().filter(|&&p| p > 0.0).count() as f64;
    let share = |&p: &f64| if p > 0.0 { (1.0 - ALIKE) * (p / total) + ALIKE / shining } else { 0.0 };
    power.iter().map(|p| share(p) as f32).collect()
}

impl Light {
    fn sample(&self, shapes: &[Box<dyn Shape>], from: Vec3, u: Vec2) -> Option<Offer> {
        match self {
            Light::Area(area) => area.sample(shapes, from, u),
            Light::Point(point) => point.sample(from),
            Light::Spot(spot) => spot.sample(from),
            Light::Directional(directional) => directional.sample(),
            Light::Environment(environment) => environment.sample(u),
        }
    }

    /// Whether no light comes from it, wherever one looks from.
    fn is_black(&self) -> bool {
        match self {
            Light::Area(area) => area.emitter.emission.radiance.is_black(),
            Light::Point(point) => point.intensity.is_black(),
            Light::Spot(spot) => spot.intensity.is_black(),
            Light::Directional(directional) => directional.irradiance.is_black(),
            Light::Environment(environment) => environment.radiance.is_black(),
        }
    }

    /// An estimate of the flux (W), for choosing among lights.
    fn power(&self, shapes: &[Box<dyn Shape>], radius: f64) -> f64 {
        match self {
            Light::Area(area) => area.power(shapes),
            Light::Point(point) => point.power(),
            Light::Spot(spot) => spot.power(),
            Light::Directional(directional) => directional.power(radius),
            Light::Environment(environment) => environment.power(radius),
        }
    }

    /// The same light after the world has moved by −`origin`.
    pub fn recentred(mut self, origin: DVec3) -> Light {
        match &mut self {
            Light::Point(point) => point.position -= origin,
            Light::Spot(spot) => spot.position -= origin,
            Light::Area(_) | Light::Directional(_) | Light::Environment(_) => {}
        }
        self
    }

    pub fn effects(&self) -> Effects {
        match self {
            Light::Area(_) => Effects::AREA_LIGHT,
            Light::Point(_) | Light::Spot(_) | Light::Directional(_) => Effects::POINT_LIGHT,
            Light::Environment(_) => Effects::ENVIRONMENT,
        }
    }
}
