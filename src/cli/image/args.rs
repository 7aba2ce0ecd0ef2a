//! What can be said after `pt image`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use crate::cli::args::{Curve, Develop, finite};
use crate::output::{Colormap, Pick, Tonemap};

#[derive(Subcommand, Debug)]
pub enum Verb {
    /// How far picture A is from reference B, by any number of measures. Exit code 1 above --tolerance.
    Diff(Diff),
    /// Size, windows, attributes, and every channel with its range.
    Info {
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// A hash of the decoded channels: the same for the same pixels, however they are stored.
    Hash {
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// Another format, exposure, tone curve or layer.
    Convert(Convert),
    /// The mean of independent pictures of the same, weighted with SampleCount.Y where all have it; standard errors are combined.
    Average(Average),
    /// Numbers as colours, with a scale: a picture's brightness, or how far A is from B.
    Falsecolor(Falsecolor),
}

impl Verb {
    /// The pictures that are read.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Verb::Diff(args) => vec![args.first.clone(), args.second.clone()],
            Verb::Info { files } | Verb::Hash { files } => files.clone(),
            Verb::Convert(args) => vec![args.input.clone()],
            Verb::Average(args) => args.inputs.clone(),
            Verb::Falsecolor(args) => [&args.first].into_iter().chain(&args.second).cloned().collect(),
        }
    }
}

#[derive(Args, Debug)]
pub struct Diff {
    /// The picture to be judged.
    #[arg(value_name = "A")]
    pub first: PathBuf,
    /// The reference.
    #[arg(value_name = "B")]
    pub second: PathBuf,
    /// Which measure, such as relmse, mse:robust or relmse:eps=1e-2: see `pt list metrics`. May be repeated.
    #[arg(short, long, value_name = "NAME", default_value = "relmse")]
    pub metric: Vec<String>,
    /// The error of every pixel: .exr or .pfm as numbers, .png or .ppm (of the first measure) as colours.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// End with exit code 1 if any measure is larger.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,
    #[command(flatten)]
    pub layer: Layer,
    #[command(flatten)]
    pub tone: Tone,
}

#[derive(Args, Debug)]
pub struct Convert {
    /// The picture.
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Where the picture goes: .exr, .png, .ppm or .pfm. May be repeated.
    #[arg(short, long, value_name = "OUT", required = true)]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub layer: Layer,
    #[command(flatten)]
    pub develop: Develop,
}

#[derive(Args, Debug)]
pub struct Average {
    /// The pictures.
    #[arg(required = true, value_name = "FILE")]
    pub inputs: Vec<PathBuf>,
    /// Where the mean goes: .exr, .png, .ppm or .pfm. May be repeated.
    #[arg(short, long, value_name = "OUT", required = true)]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub develop: Develop,
}

#[derive(Args, Debug)]
pub struct Falsecolor {
    /// The picture.
    #[arg(value_name = "A")]
    pub first: PathBuf,
    /// The reference, where errors are to be shown.
    #[arg(value_name = "B")]
    pub second: Option<PathBuf>,
    /// Where the colours go: .png, .ppm, .exr or .pfm.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// With B: which measure; see `pt list metrics`.
    #[arg(short, long, value_name = "NAME", default_value = "relmse")]
    pub metric: String,
    /// The values of the darkest and of the brightest colour. Default: from 0, or below what is negative, to what 99 % of the
    /// pixels do not exceed; with --log what 1 % and 99 % of the positive ones do not exceed.
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<[f64; 2]>,
    /// Equal factors instead of equal steps.
    #[arg(long)]
    pub log: bool,
    /// The colours, all perceptually uniform.
    #[arg(long, value_enum, default_value_t = Map::Magma)]
    pub map: Map,
    #[command(flatten)]
    pub layer: Layer,
    #[command(flatten)]
    pub tone: Tone,
}

/// What of a picture.
#[derive(Args, Debug)]
pub struct Layer {
    /// A layer such as StdErr, Albedo or N instead of R, G, B.
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// One channel, by its full name, such as Z or StdErr.R, as a grey.
    #[arg(long, value_name = "NAME", conflicts_with = "layer")]
    channel: Option<String>,
}

/// From radiance to display.
#[derive(Args, Debug)]
pub struct Tone {
    /// Stops of exposure, for 8-bit files, flip and ssim.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
    exposure: f32,
    /// The curve from radiance to display, for 8-bit files, flip and ssim.
    #[arg(long, value_enum, default_value_t = Curve::None)]
    tonemap: Curve,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    Magma,
    Inferno,
    Plasma,
    Viridis,
    /// For eyes that do not tell red from green.
    Cividis,
}

impl Layer {
    pub fn pick(&self) -> Pick {
        match (&self.layer, &self.channel) {
            (Some(layer), _) => Pick::Layer(layer.clone()),
            (_, Some(channel)) => Pick::Channel(channel.clone()),
            _ => Pick::Colour,
        }
    }
}

impl Tone {
    pub fn map(&self) -> Tonemap {
        Tonemap { exposure: self.exposure, curve: self.tonemap.into() }
    }
}

impl From<Map> for Colormap {
    fn from(map: Map) -> Colormap {
        match map {
            Map::Magma => Colormap::Magma,
            Map::Inferno => Colormap::Inferno,
            Map::Plasma => Colormap::Plasma,
            Map::Viridis => Colormap::Viridis,
            Map::Cividis => Colormap::Cividis,
        }
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| *x >= 0.0).ok_or("expected a number from 0".to_owned())
}

fn range(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| part.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let parsed = text.split_once(',').and_then(|(low, high)| Some([number(low)?, number(high)?]));
    parsed.filter(|[low, high]| low < high).ok_or("expected two numbers such as 0,0.5, the first below the second".to_owned())
}
