//! `pt meter SCENE`: measures the light at the scene's meters, with error bars.

use std::ops::ControlFlow;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use glam::DVec3;
use serde_json::{Value, json};

use super::load::{Loaded, SceneArgs, load};
use super::parse::{duration as parse_duration, share, threads};
use super::{INCONCLUSIVE, note, print_stdout, render, signals};
use crate::build::Built;
use crate::describe;
use crate::effects::Effects;
use crate::error::text::one_line;
use crate::error::{Error, Fault, Result};
use crate::integrator::Entry;
use crate::math::float::sin_cos_degrees;
use crate::measure::format::{number, per_cent};
use crate::measure::meter::{Meter, Quantity, Reading, measure};
use crate::scene::Scene as _;

#[derive(clap::Args, Debug)]
pub struct MeterArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Integrator. Default: the scene's, or nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Greatest relative error of the mean of each meter's three colours, such as 1%: half the width of its 95 % interval. Exit code 7 if
    /// one is not reached.
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub target: Option<f64>,
    /// Greatest number of samples of each meter, rounded down to 512, 1024, 2048, … Default: 65536, or 2³⁰ with --target or --time.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: Option<u64>,
    /// Time for each meter; at least 512 samples are taken.
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    pub time: Option<Duration>,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Number of threads. Default: all cores. The readings do not depend on it.
    #[arg(short, long, env = "PT_THREADS", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// Confidence of the stated intervals.
const CONFIDENCE: f64 = 0.95;
/// Number of samples without any limit, and with a target or a time only.
const SAMPLES: u64 = 1 << 16;
const MOST_SAMPLES: u64 = 1 << 30;
/// Least target: the rounding of f32 alone makes up to a millionth.
const LEAST_TARGET: f64 = 2e-6;

/// Runs the command.
pub fn meter(args: &MeterArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    if args.target.is_some_and(|target| target < LEAST_TARGET) {
        return Err(Error::Usage("--target: expected at least 0.0002 %, below which readings are rounded".into()));
    }
    let loaded = load(&args.scene, &[], args.integrator.as_deref(), tables)?;
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    if loaded.description.meters.is_empty() {
        let message = "the scene has no \"meters\"; one is {\"type\": \"irradiance\", \"position\": [0, 1, 0], \"normal\": [0, 1, 0]}";
        return Err(Error::invalid(Fault::new(message).in_file(&loaded.file)));
    }
    let Loaded { entry, integrator, .. } = &loaded;
    if integrator.splats() || entry.simulates.is_empty() {
        let message = format!("{}: expected an integrator that finds the light along rays from the camera, such as nee", entry.name);
        return Err(Error::Usage(message));
    }
    signals::catch()?;
    render::pool(args.threads)?.install(|| run(args, loaded))
}

fn run(args: &MeterArgs, loaded: Loaded) -> Result<ExitCode> {
    let Loaded { built: Built { world, film, sampler, .. }, entry, integrator, description, file, .. } = loaded;
    if world.effects().contains(Effects::MEDIA) {
        let message = "pt meter cannot measure light in scenes with participating media yet; render the place and read the pixels";
        return Err(Error::invalid(Fault::new(message).in_file(&file)));
    }
    if let Some(lacks) = entry.lacks(world.effects()) {
        note(&format!("note: {} does not simulate what this scene calls for: {lacks}", entry.name));
    }
    let scene: std::sync::Arc<dyn crate::scene::Scene> = std::sync::Arc::new(world);
    let estimator = integrator.prepare(scene.clone(), &film);
    let (mut rows, mut missed) = (vec![], false);
    for (described, index) in description.meters.iter().zip(0..) {
        let meter = placed(described, scene.origin());
        let (start, cancelled) = (Instant::now(), || signals::caught().is_some());
        let reading = measure(&*scene, &*estimator, &meter, (sampler, index), &cancelled, |reading| {
            match is_done(args, reading, start) || cancelled() {
                true => ControlFlow::Break(reading.clone()),
                false => ControlFlow::Continue(()),
            }
        });
        if let Some(signal) = signals::caught() {
            return Err(Error::Interrupted(signal));
        }
        missed |= args.target.is_some_and(|target| reading.relative_half_width(CONFIDENCE) > target);
        let name = described.name().filter(|name| !name.is_empty()).map_or_else(|| format!("/meters/{index}"), str::to_owned);
        rows.push((name, meter.quantity, reading, start.elapsed()));
    }
    print_stdout(&if args.json { as_json(entry.name, &rows) } else { table(&rows) })?;
    Ok(if missed { ExitCode::from(INCONCLUSIVE) } else { ExitCode::SUCCESS })
}

/// A meter in the coordinates of the scene.
fn placed(meter: &describe::Meter, origin: DVec3) -> Meter {
    let at = |position: describe::Point| (DVec3::from(position.0) - origin).as_vec3();
    let unit = |direction: describe::Direction| DVec3::from(direction.0).normalize().as_vec3();
    match meter {
        describe::Meter::Irradiance(m) => {
            Meter { position: at(m.position), quantity: Quantity::Irradiance { normal: unit(m.normal), radius: m.radius.get() as f32 } }
        }
        describe::Meter::Radiance(m) => {
            // 1 − cos α = 2 sin² α/2 keeps its digits at small angles.
            let sin = sin_cos_degrees(m.angle.get() / 4.0).0;
            let one_minus_cos = (2.0 * sin * sin) as f32;
            Meter { position: at(m.position), quantity: Quantity::Radiance { direction: unit(m.direction), one_minus_cos } }
        }
    }
}

/// Whether a limit is reached. The next look would take as long again as all before.
fn is_done(args: &MeterArgs, reading: &Reading, start: Instant) -> bool {
    let is_met = args.target.is_some_and(|target| reading.relative_half_width(CONFIDENCE) <= target);
    let is_late = args.time.is_some_and(|time| start.elapsed() * 2 > time);
    let has_limit = args.target.is_some() || args.time.is_some();
    let most = args.samples.unwrap_or(if has_limit { MOST_SAMPLES } else { SAMPLES });
    let is_dark = reading.values[3].value == 0.0 && reading.samples >= SAMPLES;
    is_met || is_late || is_dark || reading.samples.saturating_mul(2) > most
}

type Row = (String, Quantity, Reading, Duration);

fn unit(quantity: &Quantity) -> (&'static str, &'static str) {
    match quantity {
        Quantity::Irradiance { .. } => ("irradiance", "W/m²"),
        Quantity::Radiance { .. } => ("radiance", "W/(m² sr)"),
    }
}

fn table(rows: &[Row]) -> String {
    let mut text = String::new();
    for (name, quantity, reading, _) in rows {
        let (what, unit) = unit(quantity);
        text += &format!("{}, {what} in {unit}, {} samples\n", one_line(name), reading.samples);
        let is_gray = reading.values[1..3].iter().all(|mean| mean.value == reading.values[0].value);
        let channels: &[(usize, &str)] = if is_gray { &[(3, "gray")] } else { &[(0, "red"), (1, "green"), (2, "blue"), (3, "mean")] };
        for &(channel, color) in channels {
            let (value, half) = (reading.values[channel].value, reading.half_width(channel, CONFIDENCE));
            let error = match reading.has_heavy_tail {
                true => "no error is told: rare bright paths hold most of the noise".into(),
                false if value == 0.0 => "no light has arrived".into(),
                false => format!("± {} ({} %)", number(half, 2), per_cent(half / value)),
            };
            text += &format!("  {color:5} {:>12} {error}\n", number(value, 5));
        }
        if reading.invalid > 0 {
            text += &format!("  {} samples were not finite or were negative, and count as black\n", reading.invalid);
        }
    }
    text + &format!("± is half of an interval that holds the true value with {} %\n", per_cent(CONFIDENCE))
}

fn as_json(integrator: &str, rows: &[Row]) -> String {
    let meters: Vec<Value> = rows
        .iter()
        .map(|(name, quantity, reading, time)| {
            let (what, unit) = unit(quantity);
            let refusal = match reading.values[3].value {
                0.0 => Some("no light has arrived"),
                _ => reading.has_heavy_tail.then_some("rare bright paths hold most of the noise"),
            };
            let half = |channel| refusal.is_none().then(|| reading.half_width(channel, CONFIDENCE));
            let value = |channel: usize| reading.values[channel].value;
            json!({
                "name": name, "type": what, "unit": unit,
                "rgb": [value(0), value(1), value(2)], "rgb_half_width": [half(0), half(1), half(2)],
                "mean": value(3), "half_width": half(3), "confidence": CONFIDENCE,
                "samples": reading.samples, "invalid": reading.invalid, "seconds": time.as_secs_f64(),
                "refusal": refusal,
            })
        })
        .collect();
    format!("{}\n", json!({ "integrator": integrator, "meters": meters }))
}
