//! Sums over samples for every pixel, and the estimates made from them.

use std::ops::Range;

use super::{Crop, Moments, PixelSamples};
use crate::sampler::ErrorEstimator;

/// Sums over some samples of every pixel, in rows of the crop from the top.
///
/// The [`ErrorEstimator`] determines the numbers of a pixel:
///
/// ```text
/// Samples          Σr Σg Σb  Σr² Σg² Σb²      Σy² Σy³    the variance of the samples gives the error of their mean
/// Scramblings(K)   Σr Σg Σb per scrambling    Σy² Σy³    the variance of the K means gives the error of their mean
/// ```
///
/// where y is the mean of the three colours. The sums of the [layers](super::layer) follow. Because all numbers are sums, two sets
/// of samples are joined by addition.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelSums {
    layout: PixelLayout,
    sums: Vec<f64>,
}

/// Layout of the numbers of a pixel: colour sums, then layer sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelLayout {
    /// Estimator of the error, which determines the colour sums.
    pub error_estimator: ErrorEstimator,
    /// Number of layer sums.
    pub layers: usize,
}

impl PixelLayout {
    /// Number of colour sums.
    fn colors(self) -> usize {
        match self.error_estimator {
            ErrorEstimator::Samples => 6 + GRAY,
            ErrorEstimator::Scramblings(k) => 3 * k as usize + GRAY,
        }
    }

    /// Total number of sums per pixel.
    pub fn all(self) -> usize {
        self.colors() + self.layers
    }
}

/// Layout without layers.
impl From<ErrorEstimator> for PixelLayout {
    fn from(error_estimator: ErrorEstimator) -> PixelLayout {
        PixelLayout { error_estimator, layers: 0 }
    }
}

impl PixelSums {
    /// Sums without pixels, with room for `pixels` of them.
    pub fn with_capacity(layout: impl Into<PixelLayout>, pixels: usize) -> PixelSums {
        let layout = layout.into();
        PixelSums { layout, sums: Vec::with_capacity(pixels * layout.all()) }
    }

    /// Sums of `pixels` black pixels.
    pub fn black(layout: impl Into<PixelLayout>, pixels: usize) -> PixelSums {
        let layout = layout.into();
        PixelSums { layout, sums: vec![0.0; pixels * layout.all()] }
    }

    /// Sums of independent samples, from the moments of each pixel.
    pub fn of_samples(pixels: &[Moments]) -> PixelSums {
        let mut sums = PixelSums::with_capacity(ErrorEstimator::Samples, pixels.len());
        pixels.iter().for_each(|moments| sums.push(std::slice::from_ref(moments), moments.gray));
        sums
    }

    /// Estimator of the error.
    pub fn error_estimator(&self) -> ErrorEstimator {
        self.layout.error_estimator
    }

    /// Layout of a pixel.
    pub fn layout(&self) -> PixelLayout {
        self.layout
    }

    /// Sums from the numbers of [`PixelSums::numbers`], for example from a file; `None` if the last pixel is incomplete.
    pub fn from_numbers(layout: PixelLayout, sums: Vec<f64>) -> Option<PixelSums> {
        sums.len().is_multiple_of(layout.all()).then_some(PixelSums { layout, sums })
    }

    /// All numbers, pixel after pixel.
    pub fn numbers(&self) -> &[f64] {
        &self.sums
    }

    /// Appends the colour sums of the next pixel, one sequence after the other. [`PixelSums::push_layers`] must follow if there are
    /// layers.
    ///
    /// - `gray`: Σy² and Σy³ over all samples, added in sample order, so that any split of the samples gives the same bits
    pub fn push(&mut self, sequences: &[Moments], gray: [f64; GRAY]) {
        sequences.iter().for_each(|moments| self.sums.extend(moments.sum));
        if self.error_estimator() == ErrorEstimator::Samples {
            sequences.iter().for_each(|moments| self.sums.extend(moments.square));
        }
        self.sums.extend(gray);
    }

    /// Appends the layer sums of the pixel pushed last.
    pub fn push_layers(&mut self, sums: &[f64]) {
        debug_assert_eq!(sums.len(), self.layout.layers);
        self.sums.extend(sums);
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.sums.len() / self.layout.all()
    }

    /// Whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Colour sums of each pixel.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.sums.chunks_exact(self.layout.all()).map(|pixel| &pixel[..self.layout.colors()])
    }

    /// Layer sums of each pixel.
    pub fn layers(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.sums.chunks_exact(self.layout.all()).map(|pixel| &pixel[self.layout.colors()..])
    }

    /// Σr, Σg, Σb of each pixel over all its scramblings.
    pub fn sums(&self) -> impl Iterator<Item = [f64; 3]> {
        self.pixels().map(|pixel| total(self.error_estimator(), pixel))
    }

    /// Σr, Σg, Σb of a pixel over all its scramblings.
    pub fn sum(&self, pixel: usize) -> [f64; 3] {
        let width = self.layout.all();
        total(self.error_estimator(), &self.sums[pixel * width..(pixel + 1) * width])
    }

    /// Adds the sums of other samples of the same pixels. Both must have the same layout.
    pub fn join(mut self, other: &PixelSums) -> PixelSums {
        self.sums.iter_mut().zip(&other.sums).for_each(|(a, b)| *a += b);
        self
    }

    /// Adds light to each pixel, where all pixels hold a single sample, of the sequence `sequence`.
    ///
    /// - `light`: for each pixel red, green and blue, then as many numbers as there are layer sums
    pub(crate) fn add_to_sample(&mut self, sequence: usize, light: &[f64]) {
        let (colors, layout) = (self.layout.colors(), self.layout);
        for (pixel, light) in self.sums.chunks_exact_mut(layout.all()).zip(light.chunks_exact(3 + layout.layers)) {
            let (sums, layers) = pixel.split_at_mut(colors);
            let sample = Moments::of_rgb(std::array::from_fn(|c| sums[3 * sequence + c] + light[c]));
            sums[3 * sequence..][..3].copy_from_slice(&sample.sum);
            if layout.error_estimator == ErrorEstimator::Samples {
                sums[3..6].copy_from_slice(&sample.square);
            }
            sums[colors - GRAY..].copy_from_slice(&sample.gray);
            layers.iter_mut().zip(&light[3..]).for_each(|(sum, light)| *sum += light);
        }
    }

    /// The sums of some of the pixels.
    ///
    /// - `crop`: rectangle of all pixels
    /// - `inner`: rectangle within it
    pub(crate) fn cropped(&self, crop: Crop, inner: Crop) -> PixelSums {
        let width = self.layout.all();
        let row = |row: Range<usize>| self.sums[row.start * width..row.end * width].iter().copied();
        PixelSums { layout: self.layout, sums: crop.rows(inner).flat_map(row).collect() }
    }

    /// Copies the pixels `pixels` of `from` to the pixels from `start` on.
    pub(crate) fn put(&mut self, start: usize, from: &PixelSums, pixels: Range<usize>) {
        let width = self.layout.all();
        self.sums[start * width..][..pixels.len() * width].copy_from_slice(&from.sums[pixels.start * width..pixels.end * width]);
    }
}

/// Number of gray sums, Σy² and Σy³, at the end of a pixel's colour sums.
const GRAY: usize = 2;

/// Mean and variance of the mean for each colour of a pixel.
pub type Estimate = [(f64, f64); 3];

/// Estimates the mean, and the variance of the mean, of each colour of a pixel with n samples.
///
/// ```text
/// Samples          v = (Σx² − (Σx)²/n) / (n (n − 1))
/// Scramblings(K)   v = Σ_r n_r (m_r − m)² / (n (K − 1)),  where m_r is the mean of the n_r samples of scrambling r
/// ```
///
/// Any samples will do, also with gaps between them: the scramblings are independent of one another. Where they have the same number of
/// samples, at the same indices, v is right on average; where they do not, and the variance of m_r falls faster than 1/n_r, it is too
/// large.
///
/// - `pixel`: colour sums from [`PixelSums::pixels`]
pub fn estimate(error_estimator: ErrorEstimator, pixel: &[f64], samples: PixelSamples) -> Estimate {
    let sum = total(error_estimator, pixel);
    let count = samples.count().max(1) as f64;
    std::array::from_fn(|c| {
        let mean = sum[c] / count;
        let squares = match error_estimator {
            ErrorEstimator::Samples => (pixel[3 + c] - sum[c] * mean).max(0.0),
            ErrorEstimator::Scramblings(k) => {
                let of = |r: u64| (pixel[3 * r as usize + c], samples.of_scrambling(k.into(), r) as f64);
                let deviation = |(sum, count): (f64, f64)| if count > 0.0 { count * (sum / count - mean).powi(2) } else { 0.0 };
                (0..k.into()).map(|r| deviation(of(r))).sum()
            }
        };
        (mean, squares / (count * freedom(error_estimator, samples)))
    })
}

/// Variance and skewness that the mean of a pixel's colours would have if its samples were independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skew {
    /// Variance v = σ²/n of the mean of the samples.
    pub variance: f64,
    /// Skewness ratio κ₃/v = μ₃/(n σ²), the third cumulant of the mean over its variance: how much brighter a pixel tends to look
    /// when it looks noisier. 0 if there is no noise.
    pub skewness_ratio: f64,
}

impl Skew {
    /// Estimates variance and skewness ratio from the sums of a pixel.
    ///
    /// - `pixel`: colour sums from [`PixelSums::pixels`]; `n`: number of samples
    pub fn of(error_estimator: ErrorEstimator, pixel: &[f64], n: u64) -> Skew {
        let n = n.max(1) as f64;
        let mean = total(error_estimator, pixel).iter().sum::<f64>() / (3.0 * n);
        let &[.., square, cube] = pixel else { return Skew { variance: 0.0, skewness_ratio: 0.0 } };
        let variance = square / n - mean * mean;
        // Equal samples leave a small variance by rounding, which is not noise.
        if variance <= 1e-12 * mean * mean {
            return Skew { variance: 0.0, skewness_ratio: 0.0 };
        }
        let third = cube / n - mean * (3.0 * square / n - 2.0 * mean * mean);
        Skew { variance: variance / (n - 1.0).max(1.0), skewness_ratio: third / (n * variance) }
    }
}

/// Degrees of freedom ν of the variances, n − 1 or K − 1; 0 if there are too few samples for an estimate.
pub fn freedom(error_estimator: ErrorEstimator, samples: PixelSamples) -> f64 {
    match error_estimator {
        ErrorEstimator::Samples => samples.count().saturating_sub(1) as f64,
        // With fewer than two samples each, scramblings are no more even than samples.
        ErrorEstimator::Scramblings(k) if (0..k.into()).any(|r| samples.of_scrambling(k.into(), r) < 2) => 0.0,
        ErrorEstimator::Scramblings(k) => f64::from(k) - 1.0,
    }
}

/// Σr, Σg, Σb over all scramblings.
fn total(error_estimator: ErrorEstimator, pixel: &[f64]) -> [f64; 3] {
    match error_estimator {
        ErrorEstimator::Samples => std::array::from_fn(|c| pixel[c]),
        ErrorEstimator::Scramblings(k) => {
            pixel[..3 * k as usize].as_chunks::<3>().0.iter().fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
        }
    }
}
