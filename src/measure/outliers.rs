//! Search for the samples that make most of a picture's noise.

use std::time::Instant;

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::EPSILON;
use crate::film::neighborhood::neighborhood;
use crate::film::{Film, MomentFilm};
use crate::math::Spectrum;
use crate::render::{Render, SampleId};

/// A sample with its share of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Pixel and index of the sample.
    pub id: SampleId,
    /// Value with which the sample counts in its pixel.
    pub value: Spectrum,
    /// Share of the noise of all samples of the picture; all shares add up to 1.
    pub share: f64,
}

/// Noisiest samples of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct Outliers {
    /// Samples, the noisiest first.
    pub samples: Vec<Outlier>,
    /// Whether no other sample can be noisier than these. If not, only the most likely pixels were searched.
    pub complete: bool,
}

/// Finds the samples that add most to the squared relative error of a picture.
///
/// ```text
/// noise of sample y of pixel p = (y − m_p)² / (n_p² (d_p + ε)),   ε = 0.01 · mean(m)²
/// ```
///
/// y is the mean of the colours, m_p the mean of the pixel's n_p samples, and d_p the median of m² over the pixel and its
/// neighbours. The pixel's own m² would not do: one bright sample makes it large and so hides itself.
///
/// Nothing is stored for this during the render. The sums that the film has of each pixel bound the distance of a sample from the
/// mean,
///
/// ```text
/// |y − m| ≤ √Σ(y − m)²,   and for y ≥ 0   y ≤ ∛Σy³
/// ```
///
/// and pixels are searched in the order of these bounds, by computing their samples again, until the next bound lies below the
/// samples that were found. That takes a few pixels if a few samples make the noise. At most one pixel in a hundred is searched,
/// but at least `count`. The result does not depend on the number of threads.
///
/// - `render`: the render that made `film`
///
/// Tests: `a_planted_firefly_is_the_worst_sample`, `the_worst_are_those_of_a_search_of_all_samples`.
pub fn find_outliers(render: &Render, film: &MomentFilm, count: usize) -> Outliers {
    let noise = NoiseBounds::new(film);
    let pixels = noise.pixels.len();
    let mut found: Vec<Outlier> = vec![];
    if noise.total <= 0.0 || count == 0 {
        return Outliers { samples: found, complete: true };
    }
    let mut order: Vec<usize> = (0..pixels).collect();
    order.par_sort_unstable_by(|&a, &b| noise.pixels[b].bound.total_cmp(&noise.pixels[a].bound).then(a.cmp(&b)));
    let most = (pixels / SEARCHED_ONE_IN).max(count).min(pixels);
    for batch in order[..most].chunks(BATCH) {
        let worse = |p: &&usize| found.len() < count || noise.pixels[**p].bound >= found[count - 1].share;
        let batch: Vec<usize> = batch.iter().take_while(worse).copied().collect();
        if batch.is_empty() {
            break;
        }
        let crop = film.spec().crop;
        let id =
            |p: usize, index| SampleId { pixel: (crop.min.x + p as u32 % crop.size().x, crop.min.y + p as u32 / crop.size().x), index };
        let searched = batch.par_iter().flat_map_iter(|&p| (0..film.samples_of(p)).map(move |index| (p, index))).map(|(p, index)| {
            let id = id(p, index);
            let value = render.replay(id, None);
            // An invalid sample counts as black.
            let value = if value.is_finite() { value } else { Spectrum::BLACK };
            Outlier { id, value, share: noise.share(p, value) }
        });
        found.extend(searched.collect::<Vec<_>>());
        found.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.id.cmp(&b.id)));
        found.truncate(count);
    }
    let least = found.last().filter(|_| found.len() == count).map_or(0.0, |last| last.share);
    let complete = order.get(most).is_none_or(|&next| noise.pixels[next].bound <= least);
    Outliers { samples: found, complete }
}

/// Pixels that add most to the squared relative error of a picture, each with its share of the noise, the noisiest first. Equal pixels
/// are in the order of the picture. Pixels without noise are left out.
///
/// ```text
/// share of pixel p = Σ_y (y − m_p)² / (n_p² (d_p + ε)),   over the sum of all pixels; see [`find_outliers`]
/// ```
///
/// No sample is computed again: the sums of the film suffice.
///
/// Tests: `the_noisiest_pixels_are_those_of_all_samples`.
pub fn noisiest_pixels(film: &MomentFilm, count: usize) -> Vec<((u32, u32), f64)> {
    let noise = NoiseBounds::new(film);
    let crop = film.spec().crop;
    let noisy = noise.pixels.iter().enumerate().filter(|(_, pixel)| pixel.share > 0.0);
    let mut found: Vec<(usize, f64)> = noisy.map(|(p, pixel)| (p, pixel.share)).collect();
    let order = |a: &(usize, f64), b: &(usize, f64)| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0));
    if found.len() > count && count > 0 {
        found.select_nth_unstable_by(count - 1, order);
    }
    found.truncate(count);
    found.sort_unstable_by(order);
    let place = |p: usize| (crop.min.x + p as u32 % crop.size().x, crop.min.y + p as u32 / crop.size().x);
    found.into_iter().map(|(p, share)| (place(p), share)).collect()
}

/// The sample of a pixel that is farthest from the mean of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelOutlier {
    /// The sample, with its share of the squared distances of the pixel's samples.
    pub worst: Outlier,
    /// Mean of the samples and of the colours.
    pub mean: f64,
    /// Number of samples that were computed.
    pub searched: u64,
}

/// Computes samples of a pixel again, and finds the one that is farthest from their mean. `None` if there are none.
///
/// - `indices`: the samples
/// - `deadline`: time after which no further sample is computed
///
/// Tests: `a_planted_firefly_is_the_worst_sample_of_its_pixel`.
pub fn worst_of_pixel(render: &Render, pixel: (u32, u32), indices: impl Iterator<Item = u64>, deadline: Instant) -> Option<PixelOutlier> {
    let value = |index| {
        let id = SampleId { pixel, index };
        // An invalid sample counts as black.
        let value = Some(render.replay(id, None)).filter(|value| value.is_finite()).unwrap_or(Spectrum::BLACK);
        (id, value)
    };
    let mut values: Vec<(SampleId, Spectrum)> = vec![];
    for index in indices {
        values.push(value(index));
        if Instant::now() >= deadline {
            break;
        }
    }
    let mean = values.iter().map(|(_, value)| gray(*value)).sum::<f64>() / values.len() as f64;
    let distance = |value: Spectrum| (gray(value) - mean).powi(2);
    let total: f64 = values.iter().map(|(_, value)| distance(*value)).sum();
    // The first of equal samples.
    let (id, value) = values.iter().copied().rev().max_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    let share = if total > 0.0 { distance(value) / total } else { 0.0 };
    Some(PixelOutlier { worst: Outlier { id, value, share }, mean, searched: values.len() as u64 })
}

/// Mean of the colours.
fn gray(value: Spectrum) -> f64 {
    value.to_rgb().into_iter().map(f64::from).sum::<f64>() / 3.0
}

/// At most one pixel in this many is searched.
const SEARCHED_ONE_IN: usize = 100;
/// Number of pixels that are searched before the bounds are checked again.
const BATCH: usize = 16;

/// Bounds for the noise of single samples.
struct NoiseBounds {
    pixels: Vec<PixelNoise>,
    /// Noise of all samples of all pixels.
    total: f64,
}

#[derive(Clone, Copy)]
struct PixelNoise {
    mean: f64,
    /// Divisor of squared differences: n² (d + ε), and times the total once that is known.
    scale: f64,
    /// Largest share that a single sample can have.
    bound: f64,
    /// Share of all samples of the pixel together.
    share: f64,
}

impl NoiseBounds {
    fn new(film: &MomentFilm) -> NoiseBounds {
        let block = film.total();
        let count = |p: usize| film.samples_of(p).max(1) as f64;
        let means: Vec<f64> = block.sums().enumerate().map(|(p, sum)| sum.iter().sum::<f64>() / (3.0 * count(p))).collect();
        let floor = EPSILON * (means.iter().sum::<f64>() / means.len().max(1) as f64).powi(2);
        let width = film.spec().crop.size().x as usize;
        let positive = film.spec().filter.is_positive();
        let mut total = 0.0;
        let mut pixels: Vec<PixelNoise> = vec![];
        for (p, sums) in block.pixels().enumerate() {
            let &[.., squares, cubes] = sums else { continue };
            let (mean, n) = (means[p], count(p));
            // Equal samples leave a rest by rounding, which is not noise.
            let spread = Some(squares - n * mean * mean).filter(|spread| *spread > ROUNDING * squares).unwrap_or(0.0);
            let farthest = if positive { spread.sqrt().min((cubes.cbrt() - mean).max(mean)) } else { spread.sqrt() };
            let scale = n * n * (median_square(&means, width, p) + floor);
            total += spread / scale;
            let bound = if spread > 0.0 { farthest * farthest * (1.0 + ROUNDING) / scale } else { 0.0 };
            pixels.push(PixelNoise { mean, scale, bound, share: spread / scale });
        }
        for pixel in &mut pixels {
            pixel.scale *= total;
            pixel.bound /= total;
            pixel.share /= total;
        }
        NoiseBounds { pixels, total }
    }

    fn share(&self, p: usize, value: Spectrum) -> f64 {
        let PixelNoise { mean, scale, .. } = self.pixels[p];
        let y = gray(value);
        (y - mean) * (y - mean) / scale
    }
}

/// Relative size below which a sum of squares counts as rounding: above the error of f64 sums, below any real noise.
const ROUNDING: f64 = 1e-12;

/// Median of m² over a pixel and its neighbours.
fn median_square(means: &[f64], width: usize, p: usize) -> f64 {
    let mut squares: ArrayVec<f64, 9> = neighborhood(p, 1, width, means.len()).map(|q| means[q] * means[q]).collect();
    squares.sort_unstable_by(f64::total_cmp);
    squares[squares.len() / 2]
}
