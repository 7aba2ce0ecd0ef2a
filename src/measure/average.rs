//! The average of several pictures of the same scene.
//!
//! m = Σ n m_i / Σ n,    s = √(Σ n² s_i²) / Σ n
//!
//! n is the number of samples that each picture has in the pixel if all of them say it, and 1 otherwise.

use super::metric::Named;
use crate::film::{Channel, Image};
use crate::output::window;
use crate::{Error, Fault, Result};

/// Channel with the number of samples of each pixel.
const COUNT: &str = "SampleCount.Y";

/// Returns the mean of independent pictures.
///
/// - `StdErr.*` becomes the standard error of the mean, which is right only for pictures of independent samples
/// - `SampleCount.*` and `Time.*` add up
/// - every other channel is averaged, each pixel weighted with its number of samples; values that are not finite stay so
///
/// # Errors
/// `Invalid`, one fault that names the file: other windows or other channels than the first picture's, or no picture at all.
///
/// Tests: by hand, one picture with itself, parts against the whole.
pub fn average(pictures: &[Named]) -> Result<Image> {
    let (first, others) = pictures.split_first().ok_or_else(|| Error::invalid(Fault::new("expected a picture to average")))?;
    others.iter().try_for_each(|other| comparable(first, other))?;
    let counts: Option<Vec<&[f32]>> = pictures.iter().map(|p| p.image.channel(COUNT)).collect();
    let channel = |Channel { name, .. }: &Channel| {
        let parts: Vec<&[f32]> = pictures.iter().filter_map(|p| p.image.channel(name)).collect();
        let rule = Rule::of(name);
        let value = |i: usize| {
            let weights = weights(counts.as_deref(), parts.len(), i);
            rule.join(parts.iter().zip(weights).map(|(part, weight)| (f64::from(part[i]), weight))) as f32
        };
        Channel { name: name.clone(), values: (0..parts[0].len()).map(value).collect() }
    };
    let channels = first.image.channels.iter().map(channel).collect();
    Ok(Image { channels, ..*first.image })
}

/// Rule by which the values of a channel are combined.
#[derive(Clone, Copy)]
enum Rule {
    Mean,
    Error,
    Sum,
}

impl Rule {
    fn of(channel: &str) -> Rule {
        match channel.split('.').next() {
            Some("StdErr") => Rule::Error,
            Some("SampleCount" | "Time") => Rule::Sum,
            _ => Rule::Mean,
        }
    }

    /// Combines values of several pictures by the rule.
    ///
    /// - `parts`: values and their weights
    fn join(self, parts: impl Iterator<Item = (f64, f64)>) -> f64 {
        let (sum, weights) = parts.fold((0.0, 0.0), |(sum, weights), (x, w)| {
            let term = match self {
                Rule::Mean => w * x,
                Rule::Error => w * x * w * x,
                Rule::Sum => x,
            };
            (sum + term, weights + w)
        });
        match self {
            Rule::Mean => sum / weights,
            Rule::Error => sum.sqrt() / weights,
            Rule::Sum => sum,
        }
    }
}

/// Numbers of samples of pixel `i` in the pictures; all are 1 if no picture has a sample there, or if the numbers are not known.
fn weights(counts: Option<&[&[f32]]>, pictures: usize, i: usize) -> Vec<f64> {
    let counts = counts.map(|counts| counts.iter().map(|count| f64::from(count[i])).collect::<Vec<_>>());
    counts.filter(|counts| counts.iter().sum::<f64>() > 0.0).unwrap_or_else(|| vec![1.0; pictures])
}

fn comparable(first: &Named, other: &Named) -> Result<()> {
    let wrong = |what: &str, expected: String, found: String| {
        let message = format!("expected the {what} of {}, {expected}; found {found}", first.name);
        Err(Error::invalid(Fault::new(message).in_file(other.name)))
    };
    let (expected, found) = (window(first.image), window(other.image));
    if expected != found {
        return wrong("window", expected, found);
    }
    let names = |named: &Named| {
        let mut names: Vec<String> = named.image.channels.iter().map(|c| c.name.clone()).collect();
        names.sort();
        names.join(", ")
    };
    let (expected, found) = (names(first), names(other));
    if expected != found { wrong("channels", expected, found) } else { Ok(()) }
}
