//! `pt image diff A B`: measures how far a picture is from its reference.

use std::path::Path;
use std::process::ExitCode;

use super::falsecolor::{Scale, false_color_image};
use super::{LayerArgs, ToneArgs};
use super::{number, read_layer};
use crate::cli::outputs::{OutputKinds, check_outputs};
use crate::cli::print_stdout;
use crate::error::Result;
use crate::film::{Channel, Image};
use crate::measure::Metric;
use crate::measure::metric::{ImagePair, Measured, Named};
use crate::output::{self, Colormap, Format, Tonemap};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct DiffArgs {
    /// Picture to judge.
    #[arg(value_name = "A")]
    pub first: PathBuf,
    /// Reference.
    #[arg(value_name = "B")]
    pub second: PathBuf,
    /// Error measure, such as relmse, mse:robust or relmse:eps=1e-2: see `pt list metrics`. May be repeated.
    #[arg(short, long, value_name = "NAME", default_value = "relmse")]
    pub metric: Vec<String>,
    /// Output file for the error of every pixel: .exr, .hdr or .pfm as numbers, .png or .ppm (of the first measure) as colours.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// End with exit code 1 if any measure is larger.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,
    #[command(flatten)]
    pub layer: LayerArgs,
    #[command(flatten)]
    pub tone: ToneArgs,
}

fn tolerance(text: &str) -> std::result::Result<f64, String> {
    text.parse().ok().filter(|x: &f64| *x >= 0.0).ok_or("expected a number from 0".to_owned())
}

/// Prints every measure with its formula. The exit code is 1 if a measure exceeds the tolerance.
pub fn diff(args: &DiffArgs) -> Result<ExitCode> {
    let metrics: Vec<Metric> = args.metric.iter().map(|name| Metric::parse(name)).collect::<Result<_>>()?;
    check_outputs(args.output.as_slice(), OutputKinds::Pictures, &[&args.first, &args.second], "is one of the pictures")?;
    let pick = args.layer.pick();
    let (a, r) = (read_layer(&args.first, &pick)?, read_layer(&args.second, &pick)?);
    let names = [&args.first, &args.second].map(|path| path.display().to_string());
    let pair = ImagePair::new(Named { name: &names[0], image: &a }, Named { name: &names[1], image: &r }, args.tone.map())?;

    let measured: Vec<(Metric, Measured)> = metrics.into_iter().map(|metric| (metric, metric.measure(&pair))).collect();
    let mut text = format!("a = {}, r = {}\n", names[0], names[1]);
    let width = measured.iter().map(|(metric, _)| metric.name().len()).max().unwrap_or(0);
    let mut is_worse = false;
    for (metric, Measured { value, .. }) in &measured {
        let tolerated = args.tolerance.is_none_or(|tolerance| *value <= tolerance);
        is_worse |= !tolerated;
        let verdict = if tolerated { String::new() } else { format!("  ABOVE {}", number(args.tolerance.unwrap_or_default())) };
        text += &format!("{:width$}  {}{verdict}  {}\n", metric.name(), number(*value), sentence(metric));
    }
    if let Some(path) = &args.output {
        text += &write(path, &a, &measured)?;
    }
    print_stdout(&text)?;
    Ok(ExitCode::from(u8::from(is_worse)))
}

/// Formula of a measure, with the roles of the pictures if they differ.
fn sentence(metric: &Metric) -> String {
    let kind = metric.kind();
    let roles = if kind.first == kind.second { String::new() } else { format!("; a is the {}, r the {}", kind.first, kind.second) };
    format!("{}{roles}", metric.formula())
}

/// Writes the errors of all pixels to a file; returns a line about the colours.
fn write(path: &Path, window: &Image, measured: &[(Metric, Measured)]) -> Result<String> {
    let values = |measured: &Measured| measured.map.iter().map(|&v| v as f32).collect::<Vec<f32>>();
    let (metric, first) = &measured[0];
    let about = vec![("pt/metric".to_owned(), metric.formula().into())];
    match Format::of(path) {
        Some(Format::Exr) => {
            // A single map becomes a single channel, which every viewer shows.
            let name = |metric: &Metric| if measured.len() == 1 { "Y".to_owned() } else { format!("{}.Y", metric.name()) };
            let channels = measured.iter().map(|(metric, m)| Channel { name: name(metric), values: values(m) }).collect();
            output::write(path, &Image { channels, ..*window }, &about, &Tonemap::default()).map(|()| String::new())
        }
        Some(Format::Pfm) => {
            let channels = ["R", "G", "B"].map(|name| Channel { name: name.into(), values: values(first) }).into();
            output::write(path, &Image { channels, ..*window }, &about, &Tonemap::default()).map(|()| String::new())
        }
        _ => {
            let scale = Scale::around(&first.map, None, false, Colormap::default());
            output::write(path, &false_color_image(&first.map, window.size, &scale), &about, &Tonemap::default())?;
            Ok(format!("{}: {}, {}\n", path.display(), metric.name(), scale.sentence(&first.map)))
        }
    }
}
