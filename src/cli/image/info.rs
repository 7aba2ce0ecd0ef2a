//! `pt image info FILE...`: prints what is in a picture.

use std::path::{Path, PathBuf};

use super::number;
use crate::cli::print_stdout;
use crate::error::Result;
use crate::film::Channel;
use crate::output::{self, window};

/// Runs the command.
pub fn info(files: &[PathBuf]) -> Result<()> {
    files.iter().try_for_each(|path| print_stdout(&about(path)?))
}

fn about(path: &Path) -> Result<String> {
    let (image, _) = output::read(path)?;
    let facts = output::facts(path)?;
    let mut text = format!("{}: {}\n", path.display(), window(&image));
    let width = facts.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (name, value) in &facts {
        text += &format!("  {name:width$}  {value}\n");
    }
    let width = image.channels.iter().map(|c| c.name.chars().count()).max().unwrap_or(0).max("channel".len());
    text += &format!("  {:width$}  {:>12}  {:>12}  {:>12}  {:>8}  {:>8}\n", "channel", "min", "mean", "max", "NaN", "infinite");
    for channel in &image.channels {
        let Span { min, mean, max, nan, infinite } = Span::of(channel);
        let [min, mean, max] = [min, mean, max].map(number);
        text += &format!("  {:width$}  {min:>12}  {mean:>12}  {max:>12}  {nan:>8}  {infinite:>8}\n", channel.name);
    }
    Ok(text)
}

/// Statistics of the finite values of a channel, and the numbers of others.
struct Span {
    min: f64,
    mean: f64,
    max: f64,
    nan: usize,
    infinite: usize,
}

impl Span {
    fn of(channel: &Channel) -> Span {
        let finite = || channel.values.iter().filter(|v| v.is_finite()).map(|&v| f64::from(v));
        let (min, max) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (min.min(v), max.max(v)));
        let (nan, infinite) =
            (channel.values.iter().filter(|v| v.is_nan()).count(), channel.values.iter().filter(|v| v.is_infinite()).count());
        Span { min, mean: finite().sum::<f64>() / finite().count() as f64, max, nan, infinite }
    }
}
