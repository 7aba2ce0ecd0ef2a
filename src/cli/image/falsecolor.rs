//! `pt image falsecolor A [B] -o OUT`: shows numbers as colours, with a scale.

use glam::UVec2;

use super::{LayerArgs, ToneArgs};
use super::{label, number, read_layer};
use crate::cli::outputs::{OutputKinds, check_outputs};
use crate::cli::print_stdout;
use crate::error::{Error, Result};
use crate::film::{Channel, Image};
use crate::math::photometry::luminance;
use crate::measure::Metric;
use crate::measure::metric::{ImagePair, Named};
use crate::output::tonemap::linear;
use crate::output::{self, Colormap, Tonemap};
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct FalsecolorArgs {
    /// Picture.
    #[arg(value_name = "A")]
    pub first: PathBuf,
    /// Reference, to show errors.
    #[arg(value_name = "B")]
    pub second: Option<PathBuf>,
    /// Output file: .png, .ppm, .exr, .hdr or .pfm.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// With B: the error measure; see `pt list metrics`.
    #[arg(short, long, value_name = "NAME", default_value = "relmse")]
    pub metric: String,
    /// Values of the darkest and of the brightest colour. Default: 0, or the smallest value if that is negative, and the value that
    /// 99 % of the pixels do not exceed; with --log the values that 1 % and 99 % of the positive ones do not exceed.
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<[f64; 2]>,
    /// Scale with equal factors instead of equal steps.
    #[arg(long)]
    pub log: bool,
    /// Colour map; all are perceptually uniform.
    #[arg(long, value_enum, default_value_t = Map::Magma)]
    pub map: Map,
    #[command(flatten)]
    pub layer: LayerArgs,
    #[command(flatten)]
    pub tone: ToneArgs,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    Magma,
    Inferno,
    Plasma,
    Viridis,
    /// Colours for people who cannot tell red from green.
    Cividis,
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

fn range(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| part.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let parsed = text.split_once(',').and_then(|(low, high)| Some([number(low)?, number(high)?]));
    parsed.filter(|[low, high]| low < high).ok_or("expected two numbers such as 0,0.5, the first below the second".to_owned())
}

/// Runs the command.
pub fn falsecolor(args: &FalsecolorArgs) -> Result<()> {
    let metric = Metric::parse(&args.metric)?;
    let inputs: Vec<_> = [Some(&args.first), args.second.as_ref()].into_iter().flatten().map(|path| path.as_path()).collect();
    check_outputs(std::slice::from_ref(&args.output), OutputKinds::Pictures, &inputs, "is one of the pictures")?;
    if args.log && args.range.is_some_and(|[low, _]| low <= 0.0) {
        return Err(Error::Usage("--log: expected a --range above 0".into()));
    }
    let pick = args.layer.pick();
    let image = read_layer(&args.first, &pick)?;
    let name = args.first.display().to_string();
    let (values, what) = match &args.second {
        None => (image.pixels().map(|rgb| luminance(rgb.map(f64::from))).collect(), format!("luminance of {pick} of {name}")),
        Some(path) => {
            let (reference, other) = (read_layer(path, &pick)?, path.display().to_string());
            let pair = ImagePair::new(Named { name: &name, image: &image }, Named { name: &other, image: &reference }, args.tone.map())?;
            let what = format!("{} of a = {name}, r = {other}: {}", metric.name(), metric.formula());
            (metric.measure(&pair).map, what)
        }
    };
    let scale = Scale::around(&values, args.range, args.log, args.map.into());
    output::write(&args.output, &false_color_image(&values, image.size, &scale), &vec![], &Tonemap::default())?;
    print_stdout(&format!("{what}\n{}\n", scale.sentence(&values)))
}

/// Map from numbers to colours.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    low: f64,
    high: f64,
    log: bool,
    map: Colormap,
}

/// Colour of NaN, which no colour map contains.
const NAN: [u8; 3] = [0, 255, 255];

impl Scale {
    /// Scale for a given range, or for one that 99 % of the values do not exceed, so that a firefly does not make all else black.
    pub fn around(values: &[f64], range: Option<[f64; 2]>, log: bool, map: Colormap) -> Scale {
        let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite() && (!log || *v > 0.0)).collect();
        finite.sort_by(f64::total_cmp);
        let at = |share: f64| finite.get((share * finite.len() as f64) as usize).copied().unwrap_or_default();
        let low = if log { at(0.01) } else { at(0.0).min(0.0) };
        let [low, high] = range.unwrap_or([low, at(0.99)]);
        Scale { low, high, log, map }
    }

    fn color(&self, value: f64) -> [u8; 3] {
        if value.is_nan() {
            return NAN;
        }
        let place = |x: f64| if self.log { x.max(0.0).ln() } else { x };
        let (low, high) = (place(self.low), place(self.high));
        // A range of width 0 has two colours.
        let share = if high > low { (place(value) - low) / (high - low) } else { f64::from(u8::from(value > self.high)) };
        self.map.color(share)
    }

    /// Value at the position `share` on the scale, from 0 at its low end to 1 at its high end.
    fn value(&self, share: f64) -> f64 {
        if self.log { self.low.powf(1.0 - share) * self.high.powf(share) } else { self.low + share * (self.high - self.low) }
    }

    /// Text with the range, the extremes, and the number of NaN pixels.
    pub fn sentence(&self, values: &[f64]) -> String {
        let (low, high) = (number(self.low), number(self.high));
        let numbers = || values.iter().copied().filter(|v| !v.is_nan());
        let (min, max) = numbers().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (min.min(v), max.max(v)));
        let broken = values.len() - numbers().count();
        let broken = if broken == 0 { String::new() } else { format!("; in cyan what is NaN, pixels: {broken}") };
        let log = if self.log { ", logarithmic" } else { "" };
        format!("colours from {low} to {high}{log}; values from {} to {}{broken}", number(min), number(max))
    }
}

/// Rows below the picture: a gap, the bar of the scale, a gap, its labels, a gap.
const GAP: usize = 3;
const BAR: usize = 10;
const LEGEND: usize = 3 * GAP + BAR + label::HEIGHT;

/// Picture of the values in colours, with the scale below.
///
/// - `values`: rows from the top, `size.x` in each
pub fn false_color_image(values: &[f64], size: UVec2, scale: &Scale) -> Image {
    let width = size.x as usize;
    let mut pixels: Vec<[u8; 3]> = values.iter().map(|&value| scale.color(value)).collect();
    pixels.extend(legend(width, scale));
    let value = |byte: u8| linear(f64::from(byte) / 255.0) as f32;
    let channel = |(c, name): (usize, &str)| Channel { name: name.into(), values: pixels.iter().map(|p| value(p[c])).collect() };
    let size = UVec2::new(size.x, size.y + LEGEND as u32);
    Image { full_size: size, origin: UVec2::ZERO, size, channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
}

fn legend(width: usize, scale: &Scale) -> Vec<[u8; 3]> {
    let mut rows = vec![[0; 3]; LEGEND * width];
    let share = |x: usize| (x as f64 + 0.5) / width as f64;
    for y in GAP..GAP + BAR {
        (0..width).for_each(|x| rows[y * width + x] = scale.map.color(share(x)));
    }
    // Labels of the ends and the middle, as many as fit into the picture.
    let texts = [0.0, 1.0, 0.5].map(|share| (share, label::short(scale.value(share))));
    let mut taken: Vec<(usize, usize)> = vec![];
    for (share, text) in texts {
        let room = label::width(&text);
        let Some(free) = width.checked_sub(room) else { continue };
        let start = (share * free as f64) as usize;
        if taken.iter().all(|&(from, to)| start + room + label::HEIGHT < from || start > to + label::HEIGHT) {
            label::write(&text, |x, y| rows[(2 * GAP + BAR + y) * width + start + x] = [255; 3]);
            taken.push((start, start + room));
        }
    }
    rows
}
