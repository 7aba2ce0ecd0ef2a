//! Measurement of all meters of a scene.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;

use super::meter::{Meter, Quantity, Reading, Response, measure};
use crate::describe;
use crate::error::{Error, Fault, Result};
use crate::load::Loaded;
use crate::math::float::sin_cos_degrees;
use crate::scene::Scene;

/// Default limit of the number of samples; also the number after which a meter that has found no light stops, whatever the limits.
const SAMPLES: u64 = 1 << 16;
/// Default limit of the number of samples if there is a target or a time.
const MOST_SAMPLES: u64 = 1 << 30;
/// Least target: the rounding of f32 alone makes up to a millionth.
const LEAST_TARGET: f64 = 2e-6;
/// Confidence with which a target must be reached.
pub const CONFIDENCE: f64 = 0.95;

/// Limits of the measurement of each meter: the first that is reached ends it.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeterLimits {
    /// Greatest relative error of the value: half the width of its 95 % interval.
    pub target: Option<f64>,
    /// Greatest number of samples, rounded down to 512, 1024, 2048, … Default: 65536, or 2³⁰ with another limit.
    pub samples: Option<u64>,
    /// Greatest time; at least 512 samples are taken.
    pub time: Option<Duration>,
}

/// What one meter of a scene has measured.
#[derive(Clone, Debug)]
pub struct NamedReading {
    /// Name in the scene, or its JSON pointer.
    pub name: String,
    /// What was measured.
    pub quantity: Quantity,
    /// Whether power was measured or what the eye sees.
    pub response: Response,
    /// The reading.
    pub reading: Reading,
    /// Time that it took.
    pub time: Duration,
}

impl MeterLimits {
    /// Whether a limit is reached. The next look would take as long again as all before.
    fn is_reached(&self, reading: &Reading, start: Instant) -> bool {
        let is_met = self.is_met(reading);
        let is_late = self.time.is_some_and(|time| start.elapsed() * 2 > time);
        let has_limit = self.target.is_some() || self.time.is_some();
        let most = self.samples.unwrap_or(if has_limit { MOST_SAMPLES } else { SAMPLES });
        let is_dark = reading.values[3].value == 0.0 && reading.samples >= SAMPLES;
        is_met || is_late || is_dark || reading.samples.saturating_mul(2) > most
    }

    /// Whether there is a target that is reached.
    fn is_met(&self, reading: &Reading) -> bool {
        self.target.is_some_and(|target| reading.relative_half_width(CONFIDENCE) <= target)
    }

    /// Whether there is a target that a reading misses.
    pub fn is_missed(&self, reading: &Reading) -> bool {
        self.target.is_some() && !self.is_met(reading)
    }
}

impl NamedReading {
    /// Name of the quantity and the unit of its value.
    pub fn unit(&self) -> (&'static str, &'static str) {
        match (self.quantity, self.response) {
            (Quantity::Irradiance { .. }, Response::Radiometric) => ("irradiance", self.rgb_unit()),
            (Quantity::Irradiance { .. }, Response::Photometric) => ("illuminance", "lx"),
            (Quantity::Radiance { .. }, Response::Radiometric) => ("radiance", self.rgb_unit()),
            (Quantity::Radiance { .. }, Response::Photometric) => ("luminance", "cd/m²"),
        }
    }

    /// Unit of red, green and blue.
    pub fn rgb_unit(&self) -> &'static str {
        match self.quantity {
            Quantity::Irradiance { .. } => "W/m²",
            Quantity::Radiance { .. } => "W/(m² sr)",
        }
    }

    /// Reason why no interval is stated, if there is one.
    pub fn refusal(&self) -> Option<&'static str> {
        match self.reading.values[3].value {
            0.0 => Some("no light has arrived"),
            _ => self.reading.has_heavy_tail.then_some("rare bright paths hold most of the noise"),
        }
    }
}

/// Checks that a scene has meters and that its integrator can read them.
///
/// # Errors
/// `Invalid` for a scene without meters; `Usage` for a target that is too small and for an integrator whose light does not arrive along rays
/// from the camera.
pub fn check_meters(loaded: &Loaded, limits: &MeterLimits) -> Result<()> {
    if limits.target.is_some_and(|target| target < LEAST_TARGET) {
        return Err(Error::Usage("expected a target of at least 0.0002 %, below which readings are rounded".into()));
    }
    if loaded.description.meters.is_empty() {
        let message = "the scene has no \"meters\"; one is {\"type\": \"irradiance\", \"position\": [0, 1, 0], \"normal\": [0, 1, 0]}";
        return Err(Error::invalid(Fault::new(message).in_file(&loaded.file)));
    }
    let Loaded { entry, integrator, .. } = loaded;
    if integrator.splats() || entry.simulates.is_empty() {
        let message = format!("{}: expected an integrator that finds the light along rays from the camera, such as nee", entry.name);
        return Err(Error::Usage(message));
    }
    Ok(())
}

/// Measures all meters of a scene, one after the other. `None` if it was interrupted.
///
/// # Errors
/// Those of [`check_meters`].
pub fn measure_meters(loaded: &Loaded, limits: &MeterLimits, interrupt: &(dyn Fn() -> bool + Sync)) -> Result<Option<Vec<NamedReading>>> {
    check_meters(loaded, limits)?;
    let scene: Arc<dyn Scene> = loaded.world.clone();
    let estimator = loaded.integrator.prepare(scene.clone(), &loaded.film);
    let mut readings = vec![];
    for (described, index) in loaded.description.meters.iter().zip(0..) {
        let meter = placed(described, scene.origin());
        let start = Instant::now();
        let reading = measure(&*scene, &*estimator, &meter, (loaded.sampler, index), interrupt, |reading| {
            match limits.is_reached(reading, start) || interrupt() {
                true => ControlFlow::Break(reading.clone()),
                false => ControlFlow::Continue(()),
            }
        });
        if interrupt() {
            return Ok(None);
        }
        let name = described.name().filter(|name| !name.is_empty()).map_or_else(|| format!("/meters/{index}"), str::to_owned);
        readings.push(NamedReading { name, quantity: meter.quantity, response: meter.response, reading, time: start.elapsed() });
    }
    Ok(Some(readings))
}

/// A meter in the coordinates of the scene.
fn placed(meter: &describe::Meter, origin: DVec3) -> Meter {
    let at = |position: describe::Point| (DVec3::from(position.0) - origin).as_vec3();
    let unit = |direction: describe::Direction| DVec3::from(direction.0).normalize().as_vec3();
    let on_plane = |m: &describe::PlaneMeter, response| {
        let quantity = Quantity::Irradiance { normal: unit(m.normal), radius: m.radius.get() as f32 };
        Meter { position: at(m.position), quantity, response }
    };
    let in_direction = |m: &describe::DirectionMeter, response| {
        // 1 − cos α = 2 sin² α/2 keeps its digits at small angles.
        let sin = sin_cos_degrees(m.angle.get() / 4.0).0;
        let quantity = Quantity::Radiance { direction: unit(m.direction), one_minus_cos: (2.0 * sin * sin) as f32 };
        Meter { position: at(m.position), quantity, response }
    };
    match meter {
        describe::Meter::Irradiance(m) => on_plane(m, Response::Radiometric),
        describe::Meter::Illuminance(m) => on_plane(m, Response::Photometric),
        describe::Meter::Radiance(m) => in_direction(m, Response::Radiometric),
        describe::Meter::Luminance(m) => in_direction(m, Response::Photometric),
    }
}
