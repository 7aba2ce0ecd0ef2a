//! The figures of an effect, from replicates of pictures with and without it.
//!
//! ```text
//! light    Σ c / Σ x                              c: light of the paths that contain the effect, x: the picture
//! noise    1 − V′/V,   V = Σ g s²                 s²: variance among the replicates; ′: without the effect
//! time     1 − T′/T
//! mean     Σ (x′ − x) / Σ x
//! picture  √( Σ g d² ),   d = E[x′ − x]           as measured by d₁ · d₂ of two replicates
//! price    T′V′ / (T V)                           the time to the same error, as a ratio
//! g = 1/3P 1/(m² + ε),   ε = 0.01 · mean(m)²      m: mean over the replicates; P: number of pixels
//! ```
//!
//! Replicates are independent, and so are pairs of them; products and differences within a pair are unbiased. Each figure is a mean, or a
//! ratio of means, over replicates or pairs, with the interval of Student's t. A figure is not stated if one replicate or pair has most of
//! its variance. No noise is stated where the relative error of the pictures cannot be: [`RelativeError::stated`].

use super::pictures::Pixels;
use crate::measure::error::epsilon::floor_at;
use crate::measure::{Interval, Refusal, RelativeError, Replicates};

/// A figure with its interval, or the reason why none is stated.
pub type Figure = Result<Interval, Refusal>;

/// Rounding of sums over pictures of f32, relative to the light of the picture.
const ROUNDING: f64 = f32::EPSILON as f64;

/// Weights g of the pixels and colours, see the module, and the confidence of the intervals.
pub struct Scale {
    weights: Vec<f64>,
    confidence: f64,
}

/// What leaving an effect out changes.
pub struct Absence {
    /// Share of the noise that goes with it.
    pub noise: Figure,
    /// Change of the mean.
    pub mean: Figure,
    /// Relative error of the picture without it.
    pub picture: Figure,
    /// Noise without over noise with it.
    noise_ratio: Figure,
}

impl Scale {
    /// Weights by the mean of the pictures; `None` if they are black.
    pub fn new(with: &[&Pixels], confidence: f64) -> Option<Scale> {
        let mean = mean(with);
        let count = mean.len() as f64;
        let floor = floor_at(mean.iter().sum::<f64>() / count)?;
        Some(Scale { weights: mean.iter().map(|m| 1.0 / (count * (m * m + floor))).collect(), confidence })
    }

    /// Σ g a b
    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.weights.iter().zip(a).zip(b).map(|((g, a), b)| g * a * b).sum()
    }

    /// Noise that each pair of replicates tells: Σ g (x₁ − x₂)²/2.
    fn noise_of_pairs(&self, pictures: &[&Pixels]) -> Vec<f64> {
        let half = |pair: &[&Pixels]| {
            let difference = difference(pair[0], pair[1]);
            0.5 * self.product(&difference, &difference)
        };
        pictures.chunks_exact(2).map(half).collect()
    }

    /// Relative error of a single picture; [`RelativeError::refusal`] tells whether it may be stated.
    pub fn error(&self, pictures: &[&Pixels]) -> RelativeError {
        let mean = mean(pictures);
        let freedom = pictures.len() as f64 - 1.0;
        let square = |i: usize| pictures.iter().map(|picture| (f64::from(picture[i]) - mean[i]).powi(2)).sum::<f64>() / freedom;
        let of_value: Vec<f64> = self.weights.iter().enumerate().map(|(i, g)| g * square(i)).collect();
        let of_pixels: Vec<f64> = of_value.chunks(3).map(|pixel| pixel.iter().sum()).collect();
        let (sum, squares) = (of_pixels.iter().sum::<f64>(), of_pixels.iter().map(|c| c * c).sum::<f64>());
        let pairs = Replicates::new(&self.noise_of_pairs(pictures));
        match squares > 0.0 {
            true => RelativeError { value: sum.sqrt(), spread: 0.5 * pairs.error / pairs.mean, effective_pixels: sum * sum / squares },
            false => RelativeError { value: 0.0, spread: 0.0, effective_pixels: f64::INFINITY },
        }
    }

    /// Fraction of the light of the pictures that `parts` bring.
    pub fn light(&self, with: &[&Pixels], parts: &[&Pixels]) -> Figure {
        let sums = |pictures: &[&Pixels]| pictures.iter().map(|picture| sum(picture)).collect::<Vec<_>>();
        self.interval(&Replicates::ratio(&sums(parts), &sums(with)), ROUNDING)
    }

    /// Figures of leaving an effect out. Pictures of the same index in `with` and `without` must have the same random numbers.
    pub fn absence(&self, with: &[&Pixels], without: &[&Pixels]) -> Absence {
        let noise = self.stated(with).and(self.stated(without)).and_then(|()| {
            let [before, after] = [with, without].map(|pictures| self.noise_of_pairs(pictures));
            match [&before, &after].map(|noise| noise.iter().sum::<f64>() > 0.0) {
                [true, _] => Ok(Replicates::ratio(&after, &before).interval(self.confidence)),
                // Where there is no noise, none goes.
                [false, false] => Ok(Interval { value: 1.0, low: 1.0, high: 1.0 }),
                [false, true] => Err(Refusal::TooNoisy),
            }
        });
        let changes: Vec<Pixels> = with.iter().zip(without).map(|(x, y)| x.iter().zip(*y).map(|(x, y)| y - x).collect()).collect();
        let changes: Vec<&Pixels> = changes.iter().collect();
        let square = |pair: &[&Pixels]| self.product(&wide(pair[0]), &wide(pair[1]));
        let squares: Vec<f64> = changes.chunks_exact(2).map(square).collect();
        let squares = Replicates::new(&squares);
        let rounding = ROUNDING * (squares.mean.abs().sqrt() + ROUNDING);
        // Where no pixel is changed in both replicates of any pair, as by light that is rarely found, the products tell nothing. What rounding
        // changes is no change.
        let has_changes = changes.iter().any(|change| self.product(&wide(change), &wide(change)) > ROUNDING * ROUNDING);
        let picture = match has_changes && squares.mean == 0.0 && squares.error == 0.0 {
            true => Err(Refusal::TooNoisy),
            false => self.interval(&squares, rounding).map(|square| square.map(|x| x.max(0.0).sqrt())),
        };
        Absence { noise: noise.map(Interval::complement), mean: self.light(with, &changes), picture, noise_ratio: noise }
    }

    /// The interval of a mean, unless chance decides it.
    ///
    /// - `rounding`: error that the rounding of pictures to f32 makes, which tells nothing of chance
    fn interval(&self, replicates: &Replicates, rounding: f64) -> Figure {
        match replicates.has_heavy_tail() && replicates.error > rounding {
            true => Err(Refusal::HeavyTail),
            false => Ok(replicates.interval(self.confidence)),
        }
    }

    /// Whether anything can be said of the pictures' noise.
    fn stated(&self, pictures: &[&Pixels]) -> Result<(), Refusal> {
        self.error(pictures).refusal().map_or(Ok(()), Err)
    }

    /// Share of the time that goes without an effect.
    pub fn time(&self, with: &[f64], without: &[f64]) -> Interval {
        Replicates::ratio(without, with).interval(self.confidence).complement()
    }
}

impl Absence {
    /// Time to the same error without the effect, over that with it. The half widths of the logarithms are added in quadrature.
    ///
    /// - `time`: share of the time that goes
    pub fn price(&self, time: Interval) -> Figure {
        let (noise, time) = (self.noise_ratio?, time.complement());
        if noise.value == 0.0 {
            return Ok(Interval { value: 0.0, low: 0.0, high: 0.0 });
        }
        if noise.low <= 0.0 || time.low <= 0.0 {
            return Err(Refusal::TooNoisy);
        }
        let reach = (noise.high / noise.value).ln().hypot((time.high / time.value).ln());
        let value = noise.value * time.value;
        Ok(Interval { value, low: value * (-reach).exp(), high: value * reach.exp() })
    }
}

fn mean(pictures: &[&Pixels]) -> Vec<f64> {
    let count = pictures.len() as f64;
    let values = pictures.first().map_or(0, |first| first.len());
    (0..values).map(|i| pictures.iter().map(|picture| f64::from(picture[i])).sum::<f64>() / count).collect()
}

fn sum(picture: &Pixels) -> f64 {
    picture.iter().map(|x| f64::from(*x)).sum()
}

fn wide(picture: &Pixels) -> Vec<f64> {
    picture.iter().map(|x| f64::from(*x)).collect()
}

fn difference(a: &Pixels, b: &Pixels) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) - f64::from(*b)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight pictures of eight gray pixels. An effect that lights another pixel in each of them changes the mean; how much the picture
    /// differs without it they do not tell, while an effect that lights always the same pixel is told.
    #[test]
    fn sparse_effects_do_not_count_as_none() {
        let picture = |lit: Option<usize>| (0..24).map(|i| if lit == Some(i / 3) { 3.0 } else { 1.0 }).collect::<Pixels>();
        let without = vec![picture(None); 8];
        let absence = |lit: &dyn Fn(usize) -> usize| {
            let with: Vec<Pixels> = (0..8).map(|k| picture(Some(lit(k)))).collect();
            let [with, without] = [&with, &without].map(|pictures| pictures.iter().collect::<Vec<&Pixels>>());
            Scale::new(&with, 0.95).expect("light").absence(&with, &without)
        };
        assert_eq!(absence(&|k| k).picture, Err(Refusal::TooNoisy));
        // g = 1/24 1/(9 + 0.01 · 1.25²) in the lit pixel, d = −2 in its three colours
        let expected = (3.0 / 24.0 * 4.0 / (9.0 + 0.01 * 1.25f64.powi(2))).sqrt();
        let found = absence(&|_| 5).picture.expect("a figure");
        // All sums are exact but for the last digits of f64.
        assert!((found.value / expected - 1.0).abs() < 1e-12, "{found:?}, not {expected}");
    }
}
