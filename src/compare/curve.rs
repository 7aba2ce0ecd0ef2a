//! Statistics over the measurements of a method: means, slopes, bias, prices.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::{CheckpointStats, Cost, Measurement, Method, MethodConfig, Reference, TARGETS};
use crate::film::{Channel, Image};
use crate::measure::error::{errors, floor};

/// Combines the measurements of one method.
///
/// - `pictures`: pictures of the replicates after the last checkpoint
pub fn method(config: MethodConfig, pictures: &[Image], measurements: Vec<Measurement>, reference: &Reference, confidence: f64) -> Method {
    let curve = points(&measurements);
    let image = mean(pictures);
    let bias = bias(&image, &reference.image);
    let slopes = Replicates::of(&measurements, slope);
    let prices = TARGETS.iter().map(|target| price(&measurements, *target, bias, confidence)).collect();
    Method {
        name: config.name,
        integrator: config.integrator_name,
        sampler: config.sampler_name,
        curve,
        sample: one(pictures, &image),
        image,
        slope: slopes.map(|slopes| (slopes.mean, slopes.error)),
        bias,
        prices,
        lacks: config.lacks,
        measurements,
    }
}

/// Mean and standard error over the replicates of each checkpoint.
fn points(measurements: &[Measurement]) -> Vec<CheckpointStats> {
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

/// Mean of the pictures; its standard error comes from their variance.
fn mean(pictures: &[Image]) -> Image {
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
    channels.extend(errors);
    Image { channels, ..first.clone() }
}

/// One of the pictures, with the standard errors that follow from the variance of all: √R times those of the mean.
fn one(pictures: &[Image], mean: &Image) -> Image {
    let Some(first) = pictures.first() else { return mean.clone() };
    let root = (pictures.len() as f32).sqrt();
    let wider = |channel: &Channel| Channel { values: channel.values.iter().map(|error| error * root).collect(), ..channel.clone() };
    let colors = first.channels.iter().filter(|channel| ["R", "G", "B"].contains(&channel.name.as_str())).cloned();
    let errors = mean.channels.iter().filter(|channel| channel.name.starts_with("StdErr.")).map(wider);
    Image { channels: colors.chain(errors).collect(), ..first.clone() }
}

/// Number of standard errors that a bias must exceed to be reported. For normal noise the probability of a false report is 10⁻⁴,
/// with room for heavy tails.
const SURE: f64 = 4.0;

/// Relative error √relMSE that more samples do not remove, with its standard error; `None` if noise explains the difference.
///
/// ```text
/// b² = 1/3P Σ ((x̄ − r)² − u) / (r² + ε),   u = v_x̄ + v_r
/// ```
///
/// By the noise, (x̄ − r)² has the variance 2u² + 4b²u. The colours are taken as fully correlated.
fn bias(image: &Image, reference: &Image) -> Option<(f64, f64)> {
    let floor = floor(reference)?;
    let errors = [errors(image), errors(reference)];
    let variance_of = |c: usize, i: usize| errors.iter().flatten().map(|channels| f64::from(channels[c][i]).powi(2)).sum::<f64>();
    let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
    for (i, (x, r)) in image.pixels().zip(reference.pixels()).enumerate() {
        let mut spread = 0.0;
        for c in 0..3 {
            let below = 3.0 * (f64::from(r[c]).powi(2) + floor);
            let u = variance_of(c, i);
            let square = f64::from(x[c] - r[c]).powi(2) - u;
            sum += square / below;
            spread += (2.0 * u * u + 4.0 * square.max(0.0) * u).sqrt() / below;
        }
        variance += spread * spread;
        count += 1.0;
    }
    let (square, error) = (sum / count, variance.sqrt() / count);
    (square > SURE * error && square > 0.0).then(|| (square.sqrt(), 0.5 * error / square.sqrt()))
}

/// Slope −d ln relMSE / d ln seconds of one replicate, by least squares over its last five checkpoints.
fn slope(of: &[&Measurement]) -> Option<f64> {
    let usable: Vec<(f64, f64)> = of.iter().rev().take(5).filter(|m| m.relmse > 0.0).map(|m| (m.seconds.ln(), m.relmse.ln())).collect();
    if usable.len() < 3 {
        return None;
    }
    let count = usable.len() as f64;
    let (x, y) = (usable.iter().map(|p| p.0).sum::<f64>() / count, usable.iter().map(|p| p.1).sum::<f64>() / count);
    let xx: f64 = usable.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = usable.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (xx > 0.0).then(|| -xy / xx)
}

/// Time that an error takes: where the curve of each replicate reaches the error, or its extrapolation does.
fn price(measurements: &[Measurement], target: f64, bias: Option<(f64, f64)>, confidence: f64) -> Option<Cost> {
    // A method cannot reach an error below its bias.
    if bias.is_some_and(|(bias, _)| bias >= target) {
        return None;
    }
    let crossings = |of: &[&Measurement]| crossing(of, target).map(|(ln_seconds, _)| ln_seconds);
    let times = Replicates::of(measurements, crossings)?;
    let beyond = |of: &[&Measurement]| crossing(of, target).map(|(_, extrapolated)| f64::from(u8::from(extrapolated)));
    let extrapolated = Replicates::of(measurements, beyond).is_some_and(|share| share.mean > 0.0);
    let reach = times.quantile(0.5 + 0.5 * confidence) * times.error;
    Some(Cost { seconds: times.mean.exp(), low: (times.mean - reach).exp(), high: (times.mean + reach).exp(), extrapolated })
}

/// ln of the seconds at which relMSE falls to target², and whether that is an extrapolation.
///
/// Between checkpoints the logarithms are interpolated linearly. Before the first and beyond the last, relMSE falls like 1/t, as
/// plain Monte Carlo does.
fn crossing(of: &[&Measurement], target: f64) -> Option<(f64, bool)> {
    let goal = 2.0 * target.ln();
    let points: Vec<(f64, f64)> = of.iter().filter(|m| m.relmse > 0.0).map(|m| (m.seconds.ln(), m.relmse.ln())).collect();
    let (first, last) = (points.first()?, points.last()?);
    if first.1 <= goal {
        return Some((first.0 + first.1 - goal, true));
    }
    let pair = points.windows(2).find(|pair| pair[0].1 > goal && pair[1].1 <= goal);
    Some(match pair {
        Some(pair) => {
            let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
            (pair[0].0 + share * (pair[1].0 - pair[0].0), false)
        }
        None => (last.0 + last.1 - goal, true),
    })
}

/// Mean of a number over the replicates.
struct Replicates {
    mean: f64,
    /// Standard error of the mean; 0 for one replicate.
    error: f64,
    count: f64,
}

impl Replicates {
    fn new(values: &[f64]) -> Replicates {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        Replicates { mean, error: if count > 1.0 { (squares / (count * (count - 1.0))).sqrt() } else { 0.0 }, count }
    }

    /// Takes a number of each replicate; `None` if one of the replicates has no such number.
    fn of(measurements: &[Measurement], value: impl Fn(&[&Measurement]) -> Option<f64>) -> Option<Replicates> {
        let replicates = measurements.iter().map(|m| m.replicate + 1).max()?;
        let one = |r: u32| value(&measurements.iter().filter(|m| m.replicate == r).collect::<Vec<_>>());
        let values: Vec<f64> = (0..replicates).map(one).collect::<Option<_>>()?;
        Some(Replicates::new(&values))
    }

    /// Quantile of Student's t, with one degree of freedom less than there are replicates.
    fn quantile(&self, p: f64) -> f64 {
        StudentsT::new(0.0, 1.0, (self.count - 1.0).max(1.0)).map_or(0.0, |t| t.inverse_cdf(p))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use glam::UVec2;

    use super::*;

    /// relMSE = v t⁻ᵇ at 1, 2, 4, … seconds.
    fn history(replicate: u32, v: f64, b: f64, checkpoints: u32) -> Vec<Measurement> {
        let at = |k: u32| {
            let seconds = f64::from(1u32 << k);
            let relmse = v * seconds.powf(-b);
            Measurement { replicate, samples: 1 << k, seconds, mse: relmse, relmse, trimmed: relmse, others: vec![] }
        };
        (0..checkpoints).map(at).collect()
    }

    fn all(histories: &[Vec<Measurement>]) -> Vec<Measurement> {
        histories.concat()
    }

    #[test]
    fn a_power_law_has_its_power() {
        let histories = [history(0, 0.04, 0.9, 6), history(1, 0.05, 1.1, 6)];
        let slopes = Replicates::of(&all(&histories), slope).expect("slopes");
        // Mean of 0.9 and 1.1, and 0.2/2 as its standard error.
        assert_relative_eq!(slopes.mean, 1.0, max_relative = 1e-12);
        assert_relative_eq!(slopes.error, 0.1, max_relative = 1e-12);
        assert!(Replicates::of(&history(0, 0.04, 1.0, 2), slope).is_none(), "two checkpoints tell no slope");
    }

    /// The price is where √relMSE = target: at t = (v / target²)^(1/b) between checkpoints, and by the law 1/t beyond them.
    #[test]
    fn prices_are_where_the_law_says() {
        let histories = all(&[history(0, 0.04, 1.0, 6), history(1, 0.04, 1.0, 6)]);
        for (target, seconds, extrapolated) in [(0.1, 4.0, false), (0.05, 16.0, false), (0.01, 400.0, true), (0.4, 0.25, true)] {
            let cost = price(&histories, target, None, 0.95).expect("a price");
            assert_relative_eq!(cost.seconds, seconds, max_relative = 1e-9);
            assert_eq!(cost.extrapolated, extrapolated, "{target}");
            assert_relative_eq!(cost.high / cost.low, 1.0, max_relative = 1e-9);
        }
        // Replicates that differ by a factor e: ln t = ln 4 ± ½, with one degree of freedom t₀.₉₇₅ = 12.706.
        let apart = all(&[history(0, 0.04 * 0.5f64.exp(), 1.0, 8), history(1, 0.04 * (-0.5f64).exp(), 1.0, 8)]);
        let cost = price(&apart, 0.1, None, 0.95).expect("a price");
        assert_relative_eq!(cost.seconds, 4.0, max_relative = 1e-9);
        assert_relative_eq!((cost.high / cost.low).ln(), 2.0 * 12.7062 * 0.5, max_relative = 1e-4);
        assert!(price(&histories, 0.1, Some((0.1, 0.01)), 0.95).is_none(), "never below its bias");
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

    fn image(value: impl Fn(usize) -> f32, error: f32) -> Image {
        let size = UVec2::new(32, 32);
        let channel = |name: &str, values: Vec<f32>| Channel { name: name.into(), values };
        let colors = ["R", "G", "B"].map(|name| channel(name, (0..1024).map(&value).collect()));
        let errors = ["StdErr.R", "StdErr.G", "StdErr.B"].map(|name| channel(name, vec![error; 1024]));
        Image { full_size: size, origin: UVec2::ZERO, size, channels: colors.into_iter().chain(errors).collect() }
    }

    /// A picture that is a fifth too bright, with noise of a tenth: b² = 0.2²/(1 + ε). Noise alone is no bias.
    #[test]
    fn bias_is_what_noise_does_not_explain() {
        // +0.1 and −0.1 equally often.
        let noise = |i: usize| if (i * 7919) % 1024 < 512 { 0.1 } else { -0.1 };
        let reference = image(|_| 1.0, 0.0);
        let (found, error) = bias(&image(|i| 1.2 + noise(i), 0.1), &reference).expect("a bias");
        let wanted = 0.2 / 1.01f64.sqrt();
        assert!((found - wanted).abs() < 4.0 * error && error < 0.05 * wanted, "{found} ± {error}, wanted {wanted}");
        assert!(bias(&image(|i| 1.0 + noise(i), 0.1), &reference).is_none());
        // The reference's own errors count as noise too.
        assert!(bias(&image(|i| 1.0 + noise(i), 0.0), &image(|_| 1.0, 0.1)).is_none());
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
