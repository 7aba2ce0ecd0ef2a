//! Forecasts from the history of a render: how many samples, and how much time, a smaller error takes.
//!
//! Let n be the number of samples of the last checkpoint and x = ln(m/n) the distance to m samples. The error falls as
//!
//! ```text
//! ln relMSE(m) = ln relMSE(n) − f(x),     f(x) = b∞ x + (b − b∞) d (1 − e^(−x/d))
//! ```
//!
//! For independent samples b = b∞ = 1, and nothing is uncertain but the error of today. The samples of low-discrepancy sequences are
//! spread so evenly that relMSE falls faster than 1/n at first: b is the slope of the checkpoints so far. This advantage fades, because
//! it ends where edges and unevenly distributed light decide, so that the slope returns to b∞ over a distance d: to 1 for Sobol'
//! sequences, and to a little more for Halton's, whose samples take longer to be spread evenly.
//!
//! The interval of x contains the uncertainties of the error of today, of b, and of b∞, each multiplied by its part of the distance:
//!
//! ```text
//! σₓ = √( (2 σ_ln error)² + (σ_b h)² + (σ_b∞ (x − h))² ) / f′(x),     h = d (1 − e^(−x/d))
//! ```
//!
//! The constants were fitted to the error curves of seven scenes with up to three samplers; `cargo bench --bench accuracy -- prices` shows how
//! often the intervals hold, for other scenes too.

use statrs::distribution::{ContinuousCDF, Normal};

use super::error_history::is_coarse;
use super::{Checkpoint, ErrorHistory};
use crate::sampler::Kind;

/// A number that a render will need, with the interval that holds it with the requested confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Most likely number.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// b∞ of a sampler: mean and standard deviation from scene to scene.
///
/// In the curves that `cargo bench --bench accuracy -- curves` prints, from 512 samples to an error of 1 or 0.3 %, five scenes had 1.05 to
/// 1.19 with `halton` and 0.98 to 1.03 with `sobol`. `stratified` was not measured.
fn far(sampler: Kind) -> [f64; 2] {
    match sampler {
        Kind::Independent => [1.0, 0.0],
        Kind::Halton => [1.1, 0.07],
        Kind::Sobol | Kind::Stratified => [1.0, 0.07],
    }
}

/// b before any checkpoint: mean and standard deviation of the prior.
const NEAR: [f64; 2] = [1.1, 0.2];
/// Smallest and greatest slope that is believed. A slope below 1 means that rare bright samples are still missing.
const SLOPES: [f64; 2] = [1.0, 2.0];
/// d, the distance over which the slope returns to b∞: a factor of 4.5 in samples.
const FADING: f64 = 1.5;
/// Additional standard deviation of ln relMSE at a single sample per pixel: rare bright samples are still missing. It falls with the
/// square root of the number of samples. For sequences it is twice as large, because they are not even yet.
const BEGINNING: f64 = 0.5;
/// Standard deviation of the logarithm of the time of a sample, from one moment of a machine to another.
const CLOCK: f64 = 0.03;

/// Law by which the error falls, as far as the checkpoints tell.
struct Decline {
    /// b and its standard deviation.
    near: [f64; 2],
    /// b∞ and its standard deviation.
    far: [f64; 2],
    /// Standard deviation of ln relMSE of today.
    today: f64,
}

impl Decline {
    fn of(history: &ErrorHistory, last: &Checkpoint) -> Option<Decline> {
        let beginning = BEGINNING / (last.samples as f64).sqrt();
        let today = |beginning: f64| last.error.map(|error| beginning.hypot(2.0 * error.spread));
        let far = far(history.sampler);
        Some(match history.sampler {
            Kind::Independent => Decline { near: far, far, today: today(beginning)? },
            _ => Decline { near: slope(history, last), far, today: today(2.0 * beginning)? },
        })
    }

    /// f(x), by which ln relMSE falls over a distance x.
    fn fall(&self, x: f64) -> f64 {
        let [b, far] = [self.near[0], self.far[0]];
        if x > 0.0 { far * x + (b - far) * near_part(x) } else { b * x }
    }

    /// x with f(x) = `fall`.
    fn distance(&self, fall: f64) -> f64 {
        // f′ is between 1 and 2.
        let (mut low, mut high) = (fall.min(0.0), fall.max(0.0));
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (low + high);
            if self.fall(middle) < fall { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Standard deviation of x at f(x).
    fn deviation(&self, x: f64) -> f64 {
        let near = near_part(x);
        let slope = self.far[0] + (self.near[0] - self.far[0]) * (-x.max(0.0) / FADING).exp();
        self.today.hypot(self.near[1] * near).hypot(self.far[1] * (x - near)) / slope
    }
}

/// h, the part of a distance over which b counts.
fn near_part(x: f64) -> f64 {
    if x > 0.0 { FADING * (1.0 - (-x / FADING).exp()) } else { x }
}

/// The exponent b in relMSE ~ n⁻ᵇ at the last checkpoint, with its standard deviation.
///
/// It is a least-squares fit of ln relMSE over ln n, over the last factor of 16 in n, weighted by certainty, with the prior as one more
/// observation.
fn slope(history: &ErrorHistory, last: &Checkpoint) -> [f64; 2] {
    // Checkpoints close to each other share nearly all of their samples, and tell no more than one.
    let recent = history.checkpoints.iter().filter(|c| c.samples * 16 >= last.samples && (is_coarse(c.samples) || *c == last));
    // x = ln n, y = −ln relMSE, w = 1/(variance of y)
    let point = |c: &Checkpoint| {
        let error = c.error.filter(|error| error.value > 0.0 && error.refusal().is_none())?;
        Some(((c.samples as f64).ln(), -2.0 * error.value.ln(), (2.0 * error.spread.max(f64::EPSILON)).powi(-2)))
    };
    let points: Vec<(f64, f64, f64)> = recent.filter_map(point).collect();
    let all: f64 = points.iter().map(|p| p.2).sum();
    let mean = |f: fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| p.2 / all * f(p)).sum::<f64>();
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let xx: f64 = points.iter().map(|p| p.2 * (p.0 - x).powi(2)).sum();
    let xy: f64 = points.iter().map(|p| p.2 * (p.0 - x) * (p.1 - y)).sum();
    let prior = NEAR[1].powi(-2);
    [((xy + NEAR[0] * prior) / (xx + prior)).clamp(SLOPES[0], SLOPES[1]), (xx + prior).powf(-0.5)]
}

impl ErrorHistory {
    /// Number of samples per pixel at which the error will be `target`, with an interval of this confidence.
    ///
    /// `None` before the first error, and where no error can be stated.
    pub fn samples_for(&self, target: f64, confidence: f64) -> Option<Forecast> {
        self.forecast(target, confidence, |_| (1.0, 0.0))
    }

    /// Render time (s) at which the error will be `target`, with an interval of this confidence that contains the uncertainty of the
    /// clock.
    ///
    /// `None` before the first error, and where no error can be stated.
    pub fn price(&self, target: f64, confidence: f64) -> Option<Forecast> {
        self.forecast(target, confidence, |history| history.seconds_per_sample())
    }

    /// Error to expect after this number of samples; `None` where no error can be stated.
    pub fn error_at(&self, samples: u64) -> Option<f64> {
        let last = self.last()?;
        let error = last.error.filter(|error| error.refusal().is_none())?;
        let fall = Decline::of(self, last)?.fall((samples as f64 / last.samples as f64).ln());
        Some(error.value * (-0.5 * fall).exp())
    }

    /// - `unit`: factor from samples to the number to forecast, and the standard deviation of its logarithm
    fn forecast(&self, target: f64, confidence: f64, unit: fn(&ErrorHistory) -> (f64, f64)) -> Option<Forecast> {
        let last = self.last()?;
        let error = last.error?.stated(confidence).ok()?;
        if error.value == 0.0 {
            return Some(Forecast { value: 0.0, low: 0.0, high: 0.0 });
        }
        let decline = Decline::of(self, last)?;
        let x = decline.distance(2.0 * (error.value / target).ln());
        let (unit, clock) = unit(self);
        let reach = Normal::standard().inverse_cdf(0.5 + 0.5 * confidence) * decline.deviation(x).hypot(clock);
        let value = unit * last.samples as f64 * x.exp();
        Some(Forecast { value, low: value * (-reach).exp(), high: value * reach.exp() })
    }

    /// Seconds of a sample of each pixel, and the standard deviation of the logarithm: at least [`CLOCK`], and more if the last samples
    /// took another time than all together.
    fn seconds_per_sample(&self) -> (f64, f64) {
        let rate = |seconds: f64, samples: u64| seconds / samples as f64;
        let Some(last) = self.last() else { return (0.0, 0.0) };
        let all = rate(last.seconds, last.samples);
        let before = self.checkpoints.iter().rev().find(|before| before.samples < last.samples);
        let latest = before.map_or(all, |before| rate(last.seconds - before.seconds, last.samples - before.samples));
        let change = if latest > 0.0 && all > 0.0 { (latest / all).ln() } else { 0.0 };
        (all, CLOCK.hypot(0.5 * change))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::RelativeError;

    fn history(sampler: Kind, errors: &[(u64, f64)]) -> ErrorHistory {
        let error = |value| Some(RelativeError { value, spread: 0.01, effective_pixels: 1e4 });
        let checkpoint = |&(samples, value): &(u64, f64)| Checkpoint { samples, seconds: samples as f64 / 8.0, error: error(value) };
        ErrorHistory { checkpoints: errors.iter().map(checkpoint).collect(), sampler }
    }

    /// error = 0.8/√n: 1 % needs n = 6400, which takes 800 s. The variance of ln n is 0.02² + (0.5/√64)², and that of ln T 0.03² more.
    #[test]
    fn independent_samples_cost_the_square() {
        let history = history(Kind::Independent, &[(4, 0.4), (16, 0.21), (64, 0.1)]);
        let samples = history.samples_for(0.01, 0.95).expect("a number");
        assert!((samples.value - 6400.0).abs() < 1e-6, "{samples:?}");
        assert!(((samples.high / samples.low).ln() - 2.0 * 1.959_964 * (0.0004f64 + 0.0625f64.powi(2)).sqrt()).abs() < 1e-6, "{samples:?}");
        let price = history.price(0.01, 0.95).expect("a price");
        assert!((price.value - 800.0).abs() < 1e-6, "{price:?}");
        assert!(((price.high / price.low).ln() - 2.0 * 1.959_964 * (0.0013f64 + 0.0625f64.powi(2)).sqrt()).abs() < 1e-6, "{price:?}");
        assert!((history.error_at(6400).expect("an error") - 0.01).abs() < 1e-9);
    }

    /// A steep slope is carried on near the checkpoints, and no further: relMSE ~ n^−1.6 up to n = 256, and far away each factor e in
    /// samples buys a factor e^1.1.
    #[test]
    fn a_steep_slope_returns_to_that_of_far_away() {
        let steep = history(Kind::Halton, &[16u64, 32, 64, 128, 256].map(|n| (n, (n as f64).powf(-0.8))));
        let samples = |error: f64| steep.samples_for(error, 0.95).expect("a number").value;
        let last = 256f64.powf(-0.8);
        let slope = |error: f64| 2.0 * (1.001f64).ln() / (samples(error / 1.001) / samples(error)).ln();
        assert!((slope(last) - 1.6).abs() < 0.03, "{}", slope(last));
        assert!((slope(last / 1000.0) - far(Kind::Halton)[0]).abs() < 1e-3, "{}", slope(last / 1000.0));
    }

    /// The further away, the less is certain. An error that does not fall is extrapolated with the smallest slope, not with its own.
    #[test]
    fn intervals_widen_with_distance() {
        let flat = history(Kind::Halton, &[(16, 0.1), (32, 0.1), (64, 0.1), (128, 0.1)]);
        let width = |target: f64| flat.samples_for(target, 0.95).map(|n| (n.high / n.low).ln()).expect("a number");
        assert!(width(0.05) < width(0.01) && width(0.01) < width(0.001));
        let near = flat.samples_for(0.0999, 0.95).expect("a number").value;
        assert!((near / 128.0).ln() <= 2.0 * (0.1f64 / 0.0999).ln() * 1.0001, "{near}");
        assert_eq!(ErrorHistory::default().samples_for(0.01, 0.95), None);
        let exact = history(Kind::Halton, &[(16, 0.0)]).samples_for(0.01, 0.95);
        assert_eq!(exact, Some(Forecast { value: 0.0, low: 0.0, high: 0.0 }), "no noise, no samples");
    }

    /// A pilot whose last samples took twice as long as the first is not sure of its clock.
    #[test]
    fn an_uneven_clock_widens_the_price() {
        let mut slow = history(Kind::Independent, &[(4, 0.4), (8, 0.28)]);
        let even = slow.price(0.01, 0.95).expect("a price");
        slow.checkpoints[1].seconds = 1.5;
        let uneven = slow.price(0.01, 0.95).expect("a price");
        // The last four samples took 0.25 s each, all eight 0.1875 s: half of ln(4/3) is added to what both have.
        let width = |price: Forecast| (price.high / price.low).ln() / (2.0 * 1.959_964);
        let more = width(uneven).powi(2) - width(even).powi(2);
        assert!((more - (0.5 * (4f64 / 3.0).ln()).powi(2)).abs() < 1e-6, "{even:?} {uneven:?}");
    }
}
