//! Error of a render over time, and the cost of a smaller error.

use super::RelativeError;

/// State of a render at one of its checkpoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkpoint {
    /// Samples per pixel.
    pub samples: u64,
    /// Render time.
    pub seconds: f64,
    /// Estimated error of the picture; `None` if the samples tell none.
    pub error: Option<RelativeError>,
}

/// Checkpoints of one render, in order.
#[derive(Clone, Debug, Default)]
pub struct ErrorHistory {
    /// Checkpoints, in order of samples.
    pub checkpoints: Vec<Checkpoint>,
}

/// Time that an error costs, and the interval that holds it with the requested confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// Most likely render time.
    pub seconds: f64,
    /// Lower end of the interval (seconds).
    pub low: f64,
    /// Upper end of the interval (seconds).
    pub high: f64,
}

/// Numbers of samples per pixel at which the error of a render is measured: 2, 3, 4, 6, 8, 12, … below `total`, and `total`.
///
/// The checkpoints are planned ahead. A render that measured its error at any time and stopped when the error seems small would stop at
/// lucky moments, and its error would be underestimated.
pub fn checkpoints(total: u64) -> impl Iterator<Item = u64> {
    planned().take_while(move |samples| *samples < total).chain([total])
}

/// Planned numbers of samples, without an end.
fn planned() -> impl Iterator<Item = u64> {
    (0..122).map(|k: u32| if k.is_multiple_of(2) { 2u64 << (k / 2) } else { 3u64 << (k / 2) })
}

/// Steepest slope that is believed. Errors fall at least like 1/√n; a much steeper fit is noise.
const STEEPEST: f64 = 2.0;

impl ErrorHistory {
    /// The latest checkpoint.
    pub fn last(&self) -> Option<&Checkpoint> {
        self.checkpoints.last()
    }

    /// Checkpoints at planned numbers of samples, which a longer render measures too.
    pub fn planned(&self) -> impl Iterator<Item = &Checkpoint> {
        self.checkpoints.iter().filter(|checkpoint| planned().any(|samples| samples == checkpoint.samples))
    }

    /// The exponent b in relMSE ~ n⁻ᵇ over the last checkpoints: 1 for independent samples, more for low-discrepancy points.
    ///
    /// It is a least-squares fit of ln relMSE over ln n, over the last factor of 16 in n, weighted by certainty. A prior of one
    /// observation at 1 with a standard deviation of 0.2 is added. A slope below 1 means that rare bright samples are still
    /// missing, and is not used for promises.
    pub fn slope(&self) -> f64 {
        let Some(last) = self.last() else { return 1.0 };
        let recent = self.checkpoints.iter().filter(|c| c.samples * 16 >= last.samples);
        // x = ln n, y = −ln relMSE, w = 1/(variance of y)
        let point = |c: &Checkpoint| {
            let error = c.error.filter(|error| error.value > 0.0)?;
            Some(((c.samples as f64).ln(), -2.0 * error.value.ln(), (2.0 * error.spread.max(f64::EPSILON)).powi(-2)))
        };
        let points: Vec<(f64, f64, f64)> = recent.filter_map(point).collect();
        let all: f64 = points.iter().map(|p| p.2).sum();
        let mean = |f: fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| p.2 / all * f(p)).sum::<f64>();
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        // With fewer than two checkpoints xx is 0 and only the prior counts.
        let xx = points.iter().map(|p| p.2 * (p.0 - x).powi(2)).sum::<f64>();
        let xy = points.iter().map(|p| p.2 * (p.0 - x) * (p.1 - y)).sum::<f64>();
        let (precision, fitted) = if xx > 0.0 { (xx, xy / xx) } else { (0.0, 1.0) };
        let prior = PRIOR.powi(-2);
        ((fitted * precision + prior) / (precision + prior)).clamp(1.0, STEEPEST)
    }

    /// Render time at which the error will be `target`, with an interval of this confidence.
    ///
    /// T* = T (relMSE / target²)^(1/b)
    ///
    /// `None` before the first error, and where the error is not established or too vague.
    pub fn price(&self, target: f64, confidence: f64) -> Option<Price> {
        let last = self.last()?;
        let error = last.error.filter(|error| error.is_established() && !error.is_vague())?;
        let exponent = 2.0 / self.slope();
        let at = |error: f64| last.seconds * (error / target).powf(exponent);
        let [low, high] = error.interval(confidence);
        Some(Price { seconds: at(error.value), low: at(low), high: at(high) })
    }
}

/// Standard deviation of the prior of the slope, about 1.
const PRIOR: f64 = 0.2;

#[cfg(test)]
mod tests {
    use super::*;

    fn history(errors: &[(u64, f64)]) -> ErrorHistory {
        let error = |value| Some(RelativeError { value, spread: 0.01, effective_pixels: 1e4 });
        let checkpoint = |&(samples, value): &(u64, f64)| Checkpoint { samples, seconds: samples as f64 / 8.0, error: error(value) };
        ErrorHistory { checkpoints: errors.iter().map(checkpoint).collect() }
    }

    #[test]
    fn checkpoints_are_planned() {
        assert_eq!(checkpoints(20).collect::<Vec<_>>(), [2, 3, 4, 6, 8, 12, 16, 20]);
        assert_eq!(checkpoints(16).last(), Some(16));
        assert_eq!(checkpoints(1).collect::<Vec<_>>(), [1]);
        assert_eq!(checkpoints(u64::MAX).last(), Some(u64::MAX));
    }

    /// error = 0.8/√n: 1 % needs n = 6400, which takes 800 s.
    #[test]
    fn independent_samples_cost_the_square() {
        let history = history(&[(4, 0.4), (16, 0.2), (64, 0.1)]);
        assert!((history.slope() - 1.0).abs() < 1e-9);
        let price = history.price(0.01, 0.95).expect("a price");
        assert!((price.seconds - 800.0).abs() < 1e-6 && price.low < 800.0 && price.high > 800.0, "{price:?}");
        // ± 2 · 1.96 · 0.01 in ln T.
        assert!(((price.high / price.seconds).ln() - 0.0392).abs() < 1e-4);
    }

    /// A fit to relMSE ~ n^−1.5 is believed where it is certain. An error that does not fall is not extrapolated.
    #[test]
    fn slopes_are_fitted() {
        let power = |b: f64| [4u64, 8, 16, 32, 64].map(|n| (n, (n as f64).powf(-0.5 * b)));
        assert!((history(&power(1.5)).slope() - 1.5).abs() < 0.02);
        assert_eq!(history(&power(0.3)).slope(), 1.0);
        assert_eq!(history(&power(4.0)).slope(), STEEPEST);
        assert_eq!(history(&[(4, 0.1)]).slope(), 1.0);
        assert_eq!(ErrorHistory::default().slope(), 1.0);
        assert_eq!(ErrorHistory::default().price(0.01, 0.95), None);
    }
}
