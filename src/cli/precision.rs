//! `pt precision SCENE`: what rounding to single precision does to a picture, by a second path tracer in double precision.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use super::load::{Loaded, Override, SceneArgs, load};
use super::messages::fitted;
use super::outputs::{OutputKinds, check_outputs};
use super::parse::{size, threads};
use super::{note, print_stdout, render, signals};
use crate::double::{PrecisionReport, difference};
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::measure::format::number;
use crate::output::{self, Attributes, Tonemap};

#[derive(clap::Args, Debug)]
pub struct PrecisionArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Samples per pixel. Default: the scene's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Size of the picture, such as 96x96. Default: the scene's.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Output file for the picture in double precision.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Number of threads. Default: all cores. Only the times depend on it.
    #[arg(short, long, env = "PT_THREADS", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// Runs the command.
pub fn precision(args: &PrecisionArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    let mut overrides = args.size.map(render::resized).unwrap_or_default();
    overrides.extend(args.spp.map(render::with_samples));
    // Averages over the footprints of pixels are not known in double precision.
    overrides.push(Override { words: "pt precision".into(), pointer: "/film/texture_footprint", value: "0".into() });
    let loaded = load(&args.scene, &overrides, Some("path"), tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    if let Some(path) = &args.output {
        check_outputs(std::slice::from_ref(path), OutputKinds::Pictures, &[args.scene.path()?], "is the scene file")?;
    }
    signals::catch()?;
    let report = render::pool(args.threads)?.install(|| difference(&loaded, &|| signals::caught().is_some()))?;
    let report = report.ok_or_else(|| Error::Interrupted(signals::caught().unwrap_or_default()))?;
    if let Some(path) = &args.output {
        output::write(path, &report.image, &Attributes::new(), &Tonemap::default())?;
    }
    print_stdout(&if args.json { as_json(&report) } else { fitted(&text(&loaded, &report)) })?;
    Ok(ExitCode::SUCCESS)
}

fn text(loaded: &Loaded, report: &PrecisionReport) -> String {
    let (size, spp) = (loaded.film.crop.size(), loaded.sampler.spp);
    let [single, double] = report.times.map(|time| time.as_secs_f64() / report.paths as f64);
    let micro = |seconds: f64| number(1e6 * seconds, 2);
    let [picture, same_way, brightness, error] =
        [report.picture, report.same_way, report.brightness, 1.96 * report.brightness_error].map(share);
    let noise = report.noise.map_or("not known".to_owned(), |noise| format!("{} %", share(noise)));
    let PrecisionReport { paths, parted, invalid, .. } = report;
    let not_finite = match invalid {
        [0, 0] => String::new(),
        [single, double] => format!(", {single} in single and {double} in double precision without a finite result"),
    };
    [
        format!("{} · {}×{} · {spp} spp · every path in single and in double precision", loaded.stem, size.x, size.y),
        format!("pictures    differ by {picture} % (√relMSE); the noise of so many independent samples is {noise}"),
        format!("brightness  differs by {brightness} % ± {error} % (95 %)"),
        format!("paths       {parted} of {paths} differ by more than 1 %{not_finite}; the others by {same_way} % (root mean square)"),
        format!(
            "time        {} µs for a path in single precision without lanes, {} µs in double: {} times",
            micro(single),
            micro(double),
            number(double / single, 2)
        ),
    ]
    .map(|line| line + "\n")
    .concat()
}

/// A small share in per cent, with two digits.
fn share(share: f64) -> String {
    number(100.0 * share, 2)
}

fn as_json(report: &PrecisionReport) -> String {
    let [single, double] = report.times.map(|time| time.as_secs_f64());
    let object = json!({
        "paths": report.paths, "parted": report.parted,
        "invalid": { "single": report.invalid[0], "double": report.invalid[1] }, "same_way_rms": report.same_way,
        "relative_error": report.picture, "noise": report.noise,
        "brightness": report.brightness, "brightness_standard_error": report.brightness_error,
        "seconds": { "single": single, "double": double },
    });
    format!("{object}\n")
}
