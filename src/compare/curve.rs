//! Statistics over the replicates of a method: its curve, the slope of the curve, and its mean picture.
//!
//! ```text
//! √relMSE ~ secondsˢ,   s = −½ for plain Monte Carlo
//! ```

use super::replicates::replicates;
use super::{CheckpointStats, Measurement};
use crate::film::{Channel, Image};
use crate::measure::Replicates;

/// Mean and standard error over the replicates of each checkpoint.
pub fn points(measurements: &[Measurement]) -> Vec<CheckpointStats> {
    let mut samples: Vec<u64> = measurements.iter().map(|m| m.samples).collect();
    samples.sort_unstable();
    samples.dedup();
    let point = |samples: u64| {
        let all: Vec<&Measurement> = measurements.iter().filter(|m| m.samples == samples).collect();
        let over = |value: &dyn Fn(&Measurement) -> f64| {
            let spread = Replicates::new(&all.iter().map(|m| value(m)).collect::<Vec<_>>());
            (spread.mean, spread.error)
        };
        let metrics = all.first().map_or(0, |m| m.others.len());
        CheckpointStats {
            samples,
            seconds: over(&|m| m.seconds).0,
            mse: over(&|m| m.mse),
            relmse: over(&|m| m.relmse),
            trimmed: over(&|m| m.trimmed),
            others: (0..metrics).map(|i| over(&|m| m.others[i])).collect(),
        }
    };
    samples.into_iter().map(point).collect()
}

/// Mean of the pictures; its standard error comes from their variance, which a single picture does not tell.
pub fn mean(pictures: &[Image]) -> Image {
    let Some(first) = pictures.first() else {
        return Image { full_size: glam::UVec2::ZERO, origin: glam::UVec2::ZERO, size: glam::UVec2::ZERO, channels: vec![] };
    };
    let count = pictures.len() as f64;
    let all = |name: &str| -> Vec<&[f32]> { pictures.iter().filter_map(|picture| picture.channel(name)).collect() };
    let mut channels: Vec<Channel> = vec![];
    let mut errors: Vec<Channel> = vec![];
    for name in ["R", "G", "B"] {
        let values = all(name);
        let at = |i: usize| values.iter().map(move |channel| f64::from(channel[i]));
        let middle = |i: usize| at(i).sum::<f64>() / count;
        let error = |i: usize| (at(i).map(|x| (x - middle(i)).powi(2)).sum::<f64>() / (count * (count - 1.0))).sqrt();
        let pixels = first.pixels().count();
        channels.push(Channel { name: name.into(), values: (0..pixels).map(|i| middle(i) as f32).collect() });
        errors.push(Channel { name: format!("StdErr.{name}"), values: (0..pixels).map(|i| error(i) as f32).collect() });
    }
    if pictures.len() > 1 {
        channels.extend(errors);
    }
    Image { channels, ..first.clone() }
}

/// One of the pictures, with the standard errors that follow from the variance of all: √R times those of the mean.
pub fn one(pictures: &[Image], mean: &Image) -> Image {
    let Some(first) = pictures.first() else { return mean.clone() };
    let root = (pictures.len() as f32).sqrt();
    let wider = |channel: &Channel| Channel { values: channel.values.iter().map(|error| error * root).collect(), ..channel.clone() };
    let colors = first.channels.iter().filter(|channel| ["R", "G", "B"].contains(&channel.name.as_str())).cloned();
    let errors = mean.channels.iter().filter(|channel| channel.name.starts_with("StdErr.")).map(wider);
    Image { channels: colors.chain(errors).collect(), ..first.clone() }
}

/// Slope s of the error over time with its standard error; `None` for fewer than three checkpoints.
pub fn slope(measurements: &[Measurement]) -> Option<(f64, f64)> {
    replicates(measurements, slope_of_one).map(|slopes| (slopes.mean, slopes.error))
}

/// Slope d ln √relMSE / d ln seconds of one replicate, by least squares over its last five checkpoints.
fn slope_of_one(of: &[&Measurement]) -> Option<f64> {
    let usable: Vec<(f64, f64)> =
        of.iter().rev().take(5).filter(|m| m.relmse > 0.0).map(|m| (m.seconds.ln(), 0.5 * m.relmse.ln())).collect();
    if usable.len() < 3 {
        return None;
    }
    let count = usable.len() as f64;
    let (x, y) = (usable.iter().map(|p| p.0).sum::<f64>() / count, usable.iter().map(|p| p.1).sum::<f64>() / count);
    let xx: f64 = usable.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = usable.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (xx > 0.0).then(|| xy / xx)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::super::synthetic::{history, image};
    use super::*;

    /// relMSE = v t⁻ᵇ gives √relMSE = √v t^(−b/2): the slope that the eye sees is negative where the error falls.
    #[test]
    fn a_power_law_has_its_power() {
        let of = |powers: [f64; 2]| slope(&[history(0, 0.04, powers[0], 6), history(1, 0.05, powers[1], 6)].concat()).expect("slopes");
        // Mean of −0.45 and −0.55, and 0.1/2 as its standard error.
        let (mean, error) = of([0.9, 1.1]);
        assert_relative_eq!(mean, -0.5, max_relative = 1e-12);
        assert_relative_eq!(error, 0.05, max_relative = 1e-12);
        assert_relative_eq!(of([-1.0; 2]).0, 0.5, max_relative = 1e-12);
        assert!(slope(&history(0, 0.04, 1.0, 2)).is_none(), "two checkpoints tell no slope");
    }

    /// The mean of R numbers has the error s/√R; `others` are averaged too.
    #[test]
    fn points_are_means_of_replicates() {
        let one = |replicate: u32, relmse: f64, other: f64| Measurement {
            replicate,
            samples: 8,
            seconds: 2.0,
            mse: 1.0,
            relmse,
            trimmed: 0.0,
            others: vec![other],
        };
        let points = points(&[one(0, 1.0, 5.0), one(1, 3.0, 5.0), one(2, 2.0, 8.0)]);
        assert_eq!(points.len(), 1);
        assert_relative_eq!(points[0].relmse.0, 2.0);
        assert_relative_eq!(points[0].relmse.1, (1.0f64 / 3.0).sqrt(), max_relative = 1e-12);
        assert_relative_eq!(points[0].others[0].0, 6.0);
        assert_relative_eq!(points[0].others[0].1, 1.0, max_relative = 1e-12);
    }

    #[test]
    fn the_mean_of_pictures_and_its_errors() {
        let pictures = [1.0, 2.0, 6.0].map(|value| image(|_| value, 0.0));
        let mean = mean(&pictures);
        assert_eq!(mean.rgb(3, 3), [3.0; 3]);
        // s² = (4 + 1 + 9)/2 = 7, and 7/3 for the mean.
        assert_relative_eq!(f64::from(mean.channel("StdErr.G").expect("errors")[5]), (7.0f64 / 3.0).sqrt(), max_relative = 1e-6);
        assert_relative_eq!(f64::from(one(&pictures, &mean).channel("StdErr.G").expect("errors")[5]), 7.0f64.sqrt(), max_relative = 1e-6);
    }
}
