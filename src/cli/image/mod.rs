//! `pt image`: compares, inspects and converts pictures. One file per verb.

mod average;
mod convert;
mod denoise;
mod diff;
mod falsecolor;
mod hash;
mod info;
mod label;

use std::path::Path;
use std::process::ExitCode;

use crate::cli::parse::finite;
use crate::cli::tone_mapping::Curve;
use crate::error::{Error, Fault, Result};
use crate::film::Image;
use crate::measure::format;
use crate::output::Tonemap;
use crate::output::{self, Pick};
use average::AverageArgs;
use clap::Subcommand;
use convert::ConvertArgs;
use denoise::DenoiseArgs;
use diff::DiffArgs;
use falsecolor::FalsecolorArgs;
use std::path::PathBuf;

#[derive(Subcommand, Debug)]
pub enum Verb {
    /// Measure how far picture A is from reference B, by any number of measures. Exit code 1 above --tolerance.
    Diff(DiffArgs),
    /// Print size, windows, attributes, and every channel with its range.
    Info {
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// Print a hash of the decoded channels: the same for the same pixels, however they are stored.
    Hash {
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// Convert to another format, exposure, tone curve or layer.
    Convert(ConvertArgs),
    /// Have another program remove the noise. What it leaves has no error bars.
    Denoise(DenoiseArgs),
    /// Average independent pictures of the same scene, weighted with SampleCount.Y if all have it; standard errors are combined.
    Average(AverageArgs),
    /// Show numbers as colours, with a scale: the brightness of a picture, or how far A is from B.
    Falsecolor(FalsecolorArgs),
}

impl Verb {
    /// Returns the pictures that are read.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Verb::Diff(args) => vec![args.first.clone(), args.second.clone()],
            Verb::Info { files } | Verb::Hash { files } => files.clone(),
            Verb::Convert(args) => vec![args.input.clone()],
            Verb::Denoise(args) => vec![args.input.clone()],
            Verb::Average(args) => args.inputs.clone(),
            Verb::Falsecolor(args) => [&args.first].into_iter().chain(&args.second).cloned().collect(),
        }
    }
}

/// Selection of a layer.
#[derive(clap::Args, Debug)]
pub struct LayerArgs {
    /// A layer such as StdErr, Albedo or N instead of R, G, B.
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// One channel, by its full name, such as Z or StdErr.R, as a grey.
    #[arg(long, value_name = "NAME", conflicts_with = "layer")]
    channel: Option<String>,
}

impl LayerArgs {
    /// Selected layer.
    pub fn pick(&self) -> Pick {
        match (&self.layer, &self.channel) {
            (Some(layer), _) => Pick::Layer(layer.clone()),
            (_, Some(channel)) => Pick::Channel(channel.clone()),
            _ => Pick::Colour,
        }
    }
}

/// Tone mapping.
#[derive(clap::Args, Debug)]
pub struct ToneArgs {
    /// Stops of exposure, for 8-bit files, flip and ssim.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
    exposure: f32,
    /// Tone curve from radiance to display, for 8-bit files, flip and ssim.
    #[arg(long, value_enum, default_value_t = Curve::None)]
    tonemap: Curve,
}

impl ToneArgs {
    /// Tone mapping with these options.
    pub fn map(&self) -> Tonemap {
        Tonemap { exposure: self.exposure, curve: self.tonemap.into() }
    }
}

/// Runs the command.
pub fn image(verb: &Verb) -> Result<ExitCode> {
    match verb {
        Verb::Diff(args) => return diff::diff(args),
        Verb::Info { files } => info::info(files)?,
        Verb::Hash { files } => hash::hash(files)?,
        Verb::Convert(args) => convert::convert(args)?,
        Verb::Denoise(args) => denoise::denoise(args)?,
        Verb::Average(args) => average::average(args)?,
        Verb::Falsecolor(args) => falsecolor::falsecolor(args)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Reads a picture and selects a layer.
fn read_layer(path: &Path, pick: &Pick) -> Result<Image> {
    select_layer(pick, &output::read(path)?.0, path)
}

fn select_layer(pick: &Pick, image: &Image, path: &Path) -> Result<Image> {
    pick.of(image).map_err(|message| Error::invalid(Fault::new(message).in_file(path)))
}

/// Number with six significant digits.
fn number(x: f64) -> String {
    format::number(x, 6)
}
