//! `pt meter SCENE`: measures the light at the scene's meters, with error bars.

use std::process::ExitCode;
use std::time::Duration;

use serde_json::{Value, json};

use super::load::{Loaded, SceneArgs, load};
use super::parse::{duration as parse_duration, share, threads};
use super::{INCONCLUSIVE, note, print_stdout, render, signals};
use crate::error::text::one_line;
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::measure::format::{number, per_cent};
use crate::measure::meter::Response;
use crate::measure::meters::{CONFIDENCE, MeterLimits, NamedReading, check_meters, measure_meters};
use crate::scene::Scene as _;

#[derive(clap::Args, Debug)]
pub struct MeterArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Integrator. Default: the scene's, or nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Greatest relative error of each meter's value, such as 1%: half the width of its 95 % interval. Exit code 7 if
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

/// Runs the command.
pub fn meter(args: &MeterArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    let loaded = load(&args.scene, &[], args.integrator.as_deref(), tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    check_meters(&loaded, &args.limits())?;
    signals::catch()?;
    render::pool(args.threads)?.install(|| run(args, &loaded))
}

impl MeterArgs {
    fn limits(&self) -> MeterLimits {
        MeterLimits { target: self.target, samples: self.samples, time: self.time }
    }
}

fn run(args: &MeterArgs, loaded: &Loaded) -> Result<ExitCode> {
    let Loaded { entry, world, .. } = loaded;
    if let Some(lacks) = entry.lacks(world.effects()) {
        note(&format!("note: {} does not simulate what this scene calls for: {lacks}", entry.name));
    }
    let rows = measure_meters(loaded, &args.limits(), &|| signals::caught().is_some())?;
    let rows = rows.ok_or_else(|| Error::Interrupted(signals::caught().unwrap_or_default()))?;
    let missed = rows.iter().any(|row| args.limits().is_missed(&row.reading));
    print_stdout(&if args.json { as_json(entry.name, &rows) } else { table(&rows) })?;
    Ok(if missed { ExitCode::from(INCONCLUSIVE) } else { ExitCode::SUCCESS })
}

fn table(rows: &[NamedReading]) -> String {
    let mut text = String::new();
    for row in rows {
        let NamedReading { name, reading, .. } = row;
        let (what, unit) = row.unit();
        text += &format!("{}, {what} in {unit}, {} samples\n", one_line(name), reading.samples);
        let is_gray = reading.values[1..3].iter().all(|mean| mean.value == reading.values[0].value);
        let channels: &[(usize, &str)] = match row.response {
            Response::Photometric => &[(3, "value")],
            Response::Radiometric if is_gray => &[(3, "gray")],
            Response::Radiometric => &[(0, "red"), (1, "green"), (2, "blue"), (3, "mean")],
        };
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

fn as_json(integrator: &str, rows: &[NamedReading]) -> String {
    let meters: Vec<Value> = rows
        .iter()
        .map(|row| {
            let NamedReading { name, reading, time, .. } = row;
            let ((what, unit), refusal) = (row.unit(), row.refusal());
            let half = |channel| refusal.is_none().then(|| reading.half_width(channel, CONFIDENCE));
            let value = |channel: usize| reading.values[channel].value;
            json!({
                "name": name, "type": what, "unit": unit,
                "rgb_unit": row.rgb_unit(), "rgb": [value(0), value(1), value(2)], "rgb_half_width": [half(0), half(1), half(2)],
                "value": value(3), "half_width": half(3), "confidence": CONFIDENCE,
                "samples": reading.samples, "invalid": reading.invalid, "seconds": time.as_secs_f64(),
                "refusal": refusal,
            })
        })
        .collect();
    format!("{}\n", json!({ "integrator": integrator, "meters": meters }))
}
