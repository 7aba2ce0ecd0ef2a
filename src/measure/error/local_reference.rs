//! Values of the neighbourhood of each pixel, which serve as references for its error.

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::contribution::{Contribution, LocalReference, PixelEstimate, common_part};
use super::epsilon::floor_at;
use crate::film::neighborhood::neighborhood;
use crate::film::pixel_sums::{Estimate, Skew, estimate};
use crate::film::{Film, MomentFilm};
use crate::sampler::ErrorEstimator;

/// Estimates of every pixel of a film, with access to those of its neighbours.
///
/// The local reference of a pixel is the mean of the neighbours that differ from their median by no more than noise explains. The
/// value of the pixel itself would not do: one bright sample makes it bright as well as noisy.
pub(super) struct PixelStatistics {
    width: usize,
    /// ν, the degrees of freedom of the variances.
    pub freedom: f64,
    /// ε of the relative error.
    pub floor: f64,
    /// Value and variance of each colour, per pixel.
    pixels: Vec<Estimate>,
    /// Value and variance of the mean of the colours, per pixel.
    gray: Vec<Gray>,
    /// Variance by which the mean of the colours is compared with neighbours, per pixel: that of independent samples.
    comparison_variance: Vec<f64>,
    /// κ₃/v of the mean of the colours, per pixel.
    skewness_ratio: Vec<f64>,
}

#[derive(Clone, Copy)]
struct Gray {
    value: f64,
    variance: f64,
}

/// Radius of the neighbourhood (pixels).
const REACH: usize = 1;
const AROUND: usize = (2 * REACH + 1) * (2 * REACH + 1);
/// Largest square of the difference between a pixel and the median around it, over the variance of that difference, which noise explains. A lower
/// limit makes pixels with a few bright samples their own references, so that the stated error is too small; a higher one takes structure
/// for noise, so that it is too large.
const MAX_SQUARED_DEVIATION: f64 = 2.0;

impl PixelStatistics {
    /// Statistics of a film; `None` if its samples tell no error, or it is black.
    pub fn new(film: &MomentFilm, width: usize) -> Option<PixelStatistics> {
        let (block, freedom) = (film.total(), film.freedom());
        let set = film.sample_set();
        let samples = |(i, pixel)| (pixel, set.of_pixel(film.spec().allocation.level(i)));
        let pixels: Vec<Estimate> =
            block.pixels().enumerate().map(samples).map(|(pixel, samples)| estimate(block.error_estimator(), pixel, samples)).collect();
        let skews: Vec<Skew> = block
            .pixels()
            .enumerate()
            .map(samples)
            .map(|(pixel, samples)| Skew::of(block.error_estimator(), pixel, samples.count()))
            .collect();
        let gray: Vec<Gray> = pixels.iter().map(Gray::of).collect();
        let mean = gray.iter().map(|gray| gray.value).sum::<f64>() / gray.len() as f64;
        let floor = floor_at(mean).filter(|_| freedom > 0.0)?;
        let qmc_stddev_ratio = qmc_stddev_ratio(&gray, &skews, floor);
        let skewness_ratio = skews.iter().map(|skew| qmc_stddev_ratio * skew.skewness_ratio).collect();
        let is_scrambled = matches!(block.error_estimator(), ErrorEstimator::Scramblings(_));
        // With few scramblings the variance of a pixel is mostly chance. What decides whether a pixel is compared with its neighbours must not
        // depend on it: pixels with a large variance would be treated in another way than those with a small one. It is not scaled to the
        // noise of the picture, because even distribution does not help against rare bright samples.
        let comparison_variance = match is_scrambled {
            true => skews.iter().map(|skew| skew.variance).collect(),
            false => gray.iter().map(|gray| gray.variance).collect(),
        };
        let mut picture = PixelStatistics { width, freedom, floor, pixels, gray, comparison_variance, skewness_ratio };
        if is_scrambled {
            let share = picture.skewness_share();
            picture.skewness_ratio.iter_mut().for_each(|ratio| *ratio *= share);
        }
        Some(picture)
    }

    /// Contribution of each pixel to relMSE, averaged over its colours, with the index of the pixel.
    pub fn contributions(&self) -> Vec<(usize, Contribution)> {
        (0..self.pixels.len()).into_par_iter().map(|i| (i, self.contribution(i))).collect()
    }

    /// Contribution of a pixel without any correction: it is divided by its own value.
    pub fn uncorrected(&self, i: usize) -> f64 {
        self.pixels[i].iter().map(|(x, v)| v / (3.0 * (x * x + self.floor))).sum()
    }

    fn contribution(&self, i: usize) -> Contribution {
        Contribution::mean(self.colors(i).map(|(pixel, local)| Contribution::new(&pixel, &local, self.floor)))
    }

    /// Factor from 0 to 1 for the skewness ratios: the covariance of brightness and noise that the picture shows, over the covariance that
    /// the ratios predict, both summed over all pixels.
    ///
    /// The ratios are those of independent samples, scaled to the noise. Evenly distributed points may also make the noise less skewed, which
    /// the samples of a single pixel cannot tell.
    fn skewness_share(&self) -> f64 {
        let of_pixel = |i| {
            let colors = self.colors(i).map(|(pixel, local)| common_part(&pixel, &local, self.floor));
            colors.into_iter().fold((0.0, 0.0), |sum: (f64, f64), part| (sum.0 + part.0, sum.1 + part.1))
        };
        let parts: Vec<(f64, f64)> = (0..self.pixels.len()).into_par_iter().map(of_pixel).collect();
        let (found, predicted) = parts.into_iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        // Both sums are negative where noise is skewed towards bright values.
        if predicted < 0.0 { (found / predicted).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Estimate and local reference of each colour of a pixel.
    fn colors(&self, i: usize) -> [(PixelEstimate, LocalReference); 3] {
        let median = self.median(i);
        // Pushed one by one, because the compiler does not always inline `collect`.
        let mut others: ArrayVec<(usize, f64), AROUND> = ArrayVec::new();
        self.neighbors(i).for_each(|q| others.push((q, self.similarity(q, median))));
        let all: f64 = others.iter().map(|(_, similarity)| similarity).sum();
        // A pixel that differs from most of its neighbours is its own reference.
        let own = if all > 0.0 { 1.0 - self.similarity(i, median) } else { 1.0 };
        let noise = self.gray[i].variance.sqrt();
        std::array::from_fn(|c| {
            let (x, v) = self.pixels[i][c];
            // The square of v overestimates σ⁴ by (ν + 2)/ν.
            let alone = LocalReference { value: own * x, variance: own * v * self.freedom / (self.freedom + 2.0), own };
            let local = others.iter().filter(|_| own < 1.0).fold(alone, |local, (q, similarity)| {
                let (weight, (x, v)) = ((1.0 - own) * similarity / all, self.pixels[*q][c]);
                LocalReference { value: local.value + weight * x, variance: local.variance + weight * v, own }
            });
            // A colour is taken to be as skewed as the mean of the colours, in units of its own noise.
            let skewness_ratio = if noise > 0.0 { self.skewness_ratio[i] * v.sqrt() / noise } else { 0.0 };
            (PixelEstimate { value: x, variance: v, skewness_ratio, freedom: self.freedom }, local)
        })
    }

    /// The neighbours of pixel i, without i.
    fn neighbors(&self, i: usize) -> impl Iterator<Item = usize> {
        neighborhood(i, REACH, self.width, self.pixels.len()).filter(move |q| *q != i)
    }

    /// Medians of value and of the variance of comparison around a pixel. A bright sample or an edge hardly changes them.
    fn median(&self, i: usize) -> Gray {
        let (mut values, mut variances) = (ArrayVec::<f64, AROUND>::new(), ArrayVec::<f64, AROUND>::new());
        self.neighbors(i).chain([i]).for_each(|q| {
            values.push(self.gray[q].value);
            variances.push(self.comparison_variance[q]);
        });
        Gray { value: median(values), variance: median(variances) }
    }

    /// Weight of a pixel: 1 where it differs from the median by no more than noise explains, falling towards 0 beyond.
    fn similarity(&self, q: usize, median: Gray) -> f64 {
        let (distance, noise) = ((self.gray[q].value - median.value).powi(2), self.comparison_variance[q] + median.variance);
        if distance <= MAX_SQUARED_DEVIATION * noise { 1.0 } else { (0.5 * (MAX_SQUARED_DEVIATION - distance / noise)).exp() }
    }
}

/// Middle one of some numbers, the upper one of two.
fn median(mut numbers: ArrayVec<f64, AROUND>) -> f64 {
    if let Ok(nine) = numbers.as_slice().try_into() {
        return median_of_nine(nine);
    }
    let middle = numbers.len() / 2;
    *numbers.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Median of nine numbers by 19 exchanges without a branch. Most pixels have eight neighbours, and selecting their medians took most of the time of
/// stating an error.
///
/// Source: Paeth, *Median Finding on a 3-by-3 Grid* (Graphics Gems, 1990). Tests: nine_numbers_have_their_median.
fn median_of_nine(mut x: [f64; AROUND]) -> f64 {
    const EXCHANGES: [[usize; 2]; 19] = [
        [1, 2],
        [4, 5],
        [7, 8],
        [0, 1],
        [3, 4],
        [6, 7],
        [1, 2],
        [4, 5],
        [7, 8],
        [0, 3],
        [5, 8],
        [4, 7],
        [3, 6],
        [1, 4],
        [2, 5],
        [4, 7],
        [2, 4],
        [4, 6],
        [2, 4],
    ];
    for [low, high] in EXCHANGES {
        (x[low], x[high]) = if x[high] < x[low] { (x[high], x[low]) } else { (x[low], x[high]) };
    }
    x[4]
}

impl Gray {
    /// Mean of the colours. Colours move together, so their errors add, not their variances.
    fn of(pixel: &Estimate) -> Gray {
        let mean = |f: fn(&(f64, f64)) -> f64| pixel.iter().map(f).sum::<f64>() / 3.0;
        Gray { value: mean(|c| c.0), variance: mean(|c| c.1.sqrt()).powi(2) }
    }
}

/// Ratio of the standard deviation of the picture's noise to that of independent samples, over the whole picture. Scrambled
/// low-discrepancy points make it less than 1.
///
/// If the noise of such points has the same skewness as that of independent samples, κ₃/v shrinks by this ratio;
/// [`PixelStatistics::skewness_share`] corrects that.
fn qmc_stddev_ratio(gray: &[Gray], skews: &[Skew], floor: f64) -> f64 {
    let relative = |variance: f64, value: f64| variance / (value * value + floor);
    let found: f64 = gray.iter().map(|gray| relative(gray.variance, gray.value)).sum();
    let independent: f64 = gray.iter().zip(skews).map(|(gray, skew)| relative(skew.variance, gray.value)).sum();
    if independent > found { (found / independent).sqrt() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::super::epsilon::EPSILON;
    use super::*;
    use crate::film::{FilmSpec, Moments, PixelSums, Wave};
    use crate::math::Spectrum;
    use crate::sampler::hash::mix;

    const EDGE: u32 = 64;
    /// Samples of each of two scramblings, as a power of two.
    const LEVEL: u32 = 4;

    /// Share of the samples that are bright.
    const BRIGHT: f64 = 0.3;

    /// Picture by two scramblings. Three in ten samples are bright, those of the smallest u.
    ///
    /// - `number`: u from the index of a sample in its scrambling and a random number
    fn film(seed: u64, number: fn(u64, f64) -> f64) -> MomentFilm {
        let count = 1 << LEVEL;
        let mut block = PixelSums::with_capacity(ErrorEstimator::Scramblings(2), (EDGE * EDGE) as usize);
        for pixel in 0..u64::from(EDGE * EDGE) {
            let sample = |scrambling: u64, i: u64| {
                let random = (mix(mix(seed << 32 | pixel) ^ (scrambling << 32 | i)) >> 11) as f64 / (1u64 << 53) as f64;
                Moments::of(Spectrum::gray(if number(i, random) < BRIGHT { 1.0 } else { 0.0 }))
            };
            let of = |scrambling| (0..count).map(|i| sample(scrambling, i)).reduce(|a, b| a.join(&b)).expect("samples");
            let both = [of(0), of(1)];
            block.push(&both, Moments::join_gray(both[0].gray, &both[1].gray));
        }
        let mut film = MomentFilm::new(FilmSpec::new(EDGE, EDGE));
        film.add(Wave { first: 0, level: LEVEL + 1 }, block);
        film
    }

    /// Share of the skewness that a picture shows.
    fn share(number: fn(u64, f64) -> f64) -> f64 {
        let (film, count) = (film(0, number), 1 << LEVEL);
        let picture = PixelStatistics::new(&film, EDGE as usize).expect("statistics");
        // The ratios of the picture contain the share already; without it they would be these.
        let skews = film.total();
        let skews: Vec<Skew> = skews.pixels().map(|pixel| Skew::of(ErrorEstimator::Scramblings(2), pixel, 2 * count)).collect();
        let ratio = qmc_stddev_ratio(&picture.gray, &skews, picture.floor);
        let (found, whole) =
            (picture.skewness_ratio.iter().sum::<f64>(), skews.iter().map(|skew| ratio * skew.skewness_ratio).sum::<f64>());
        found / whole
    }

    /// A network of exchanges that finds the median of all sequences of zeros and ones finds that of all sequences (the 0-1 principle).
    #[test]
    fn nine_numbers_have_their_median() {
        for ones in 0u32..1 << AROUND {
            let numbers = std::array::from_fn(|k| f64::from(ones >> k & 1));
            assert_eq!(median_of_nine(numbers), if ones.count_ones() > 4 { 1.0 } else { 0.0 }, "{numbers:?}");
        }
    }

    /// The variance of two scramblings has one degree of freedom. Its chance must not decide how a pixel is corrected: the error of pictures with
    /// 27 % noise was 6 % too large when it did. The mean over these pictures is known to 0.4 %.
    #[test]
    fn large_noise_with_few_scramblings_is_not_overstated() {
        const PICTURES: u64 = 6;
        let contributions =
            |seed| PixelStatistics::new(&film(seed, |_, random| random), EDGE as usize).expect("statistics").contributions();
        let all: f64 = (0..PICTURES).flat_map(contributions).map(|(_, contribution)| contribution.value).sum();
        let stated = (all / f64::from(EDGE * EDGE) / PICTURES as f64).sqrt();
        let truth = ((1.0 - BRIGHT) / (f64::from(2u32 << LEVEL) * BRIGHT * (1.0 + EPSILON))).sqrt();
        assert!((stated / truth - 1.0).abs() < 0.035, "stated {stated}, true {truth}");
    }

    /// Independent samples keep most of their skewness: fading the expansion out far away takes a part of it. Where each of 16 equal intervals of
    /// u has one sample, four of them are bright and one is with a probability of 0.8, which is skewed the other way.
    #[test]
    fn the_skewness_of_the_noise_is_found() {
        let independent = share(|_, random| random);
        assert!(independent > 0.5, "{independent}");
        let stratified = share(|i, random| (i as f64 + random) / 16.0);
        assert!(stratified < 0.1, "{stratified}");
    }
}
