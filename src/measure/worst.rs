//! The samples that make most of a picture's noise.

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::EPSILON;
use super::around::around;
use crate::film::{Film, MomentFilm};
use crate::math::Spectrum;
use crate::render::{Render, SampleId};

/// A sample, and how much it matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noisy {
    pub id: SampleId,
    /// As it counts in its pixel.
    pub value: Spectrum,
    /// Of the noise of all samples of the picture; all shares together are 1.
    pub share: f64,
}

/// The worst samples of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// The worst first.
    pub samples: Vec<Noisy>,
    /// Whether no other sample can be worse than these: else only the likeliest pixels were searched.
    pub complete: bool,
}

/// The samples that add most to the squared relative error of a picture.
///
/// ```text
/// noise of sample y of pixel p = (y − m_p)² / (n_p² (d_p + ε)),   ε = 0.01 · mean(m)²
/// ```
///
/// with y the mean of the colours, m_p the mean of the pixel's n_p samples, and d_p the median of m² over the pixel and its
/// neighbours: a pixel that one bright sample made bright must not excuse itself.
///
/// Nothing is kept for this while the picture is rendered. From what the film knows of a pixel follows how far any of its
/// samples can be from their mean,
///
/// ```text
/// |y − m| ≤ √Σ(y − m)²,   and for y ≥ 0   y ≤ ∛Σy³
/// ```
///
/// so that pixels are searched in the order of these bounds, by computing their samples again, until the next bound lies below
/// what was found: a few pixels where a few samples make the noise, and never more than one in a hundred of those there are (but
/// at least `count`). Threads have no say in what is found.
///
/// - `render`: the one that made `film`
///
/// Tests: `a_planted_firefly_is_the_worst_sample`, `the_worst_are_those_of_a_search_of_all_samples`.
pub fn worst(render: &Render, film: &MomentFilm, count: usize) -> Worst {
    let noise = Noise::new(film);
    let pixels = noise.pixels.len();
    let mut found: Vec<Noisy> = vec![];
    if noise.total <= 0.0 || count == 0 {
        return Worst { samples: found, complete: true };
    }
    let mut order: Vec<usize> = (0..pixels).collect();
    order.par_sort_unstable_by(|&a, &b| noise.pixels[b].bound.total_cmp(&noise.pixels[a].bound).then(a.cmp(&b)));
    let most = (pixels / BUDGET).max(count).min(pixels);
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
            Noisy { id, value, share: noise.share(p, value) }
        });
        found.extend(searched.collect::<Vec<_>>());
        found.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.id.cmp(&b.id)));
        found.truncate(count);
    }
    let least = found.last().filter(|_| found.len() == count).map_or(0.0, |last| last.share);
    let complete = order.get(most).is_none_or(|&next| noise.pixels[next].bound <= least);
    Worst { samples: found, complete }
}

/// One pixel in so many is searched at most.
const BUDGET: usize = 100;
/// Pixels searched between two looks at the bounds.
const BATCH: usize = 16;

/// What is known of each pixel.
struct Noise {
    pixels: Vec<Pixel>,
    /// Of all samples of all pixels.
    total: f64,
}

#[derive(Clone, Copy)]
struct Pixel {
    mean: f64,
    /// What squares are divided by: n² (d + ε), times the total once that is known.
    scale: f64,
    /// The greatest share that a single sample can have.
    bound: f64,
}

impl Noise {
    fn new(film: &MomentFilm) -> Noise {
        let block = film.total();
        let count = |p: usize| film.samples_of(p).max(1) as f64;
        let means: Vec<f64> = block.sums().enumerate().map(|(p, sum)| sum.iter().sum::<f64>() / (3.0 * count(p))).collect();
        let floor = EPSILON * (means.iter().sum::<f64>() / means.len().max(1) as f64).powi(2);
        let width = film.spec().crop.size().x as usize;
        let positive = film.spec().filter.is_positive();
        let mut total = 0.0;
        let mut pixels: Vec<Pixel> = vec![];
        for (p, sums) in block.pixels().enumerate() {
            let &[.., squares, cubes] = sums else { continue };
            let (mean, n) = (means[p], count(p));
            // What rounding leaves of equal samples is no noise.
            let spread = Some(squares - n * mean * mean).filter(|spread| *spread > ROUNDING * squares).unwrap_or(0.0);
            let farthest = if positive { spread.sqrt().min((cubes.cbrt() - mean).max(mean)) } else { spread.sqrt() };
            let scale = n * n * (median_square(&means, width, p) + floor);
            total += spread / scale;
            pixels.push(Pixel { mean, scale, bound: if spread > 0.0 { farthest * farthest * (1.0 + ROUNDING) / scale } else { 0.0 } });
        }
        for pixel in &mut pixels {
            pixel.scale *= total;
            pixel.bound /= total;
        }
        Noise { pixels, total }
    }

    fn share(&self, p: usize, value: Spectrum) -> f64 {
        let Pixel { mean, scale, .. } = self.pixels[p];
        let y = value.to_rgb().into_iter().map(f64::from).sum::<f64>() / 3.0;
        (y - mean) * (y - mean) / scale
    }
}

/// More than the sums of f64 are off, less than anything seen.
const ROUNDING: f64 = 1e-12;

/// The median of m² over a pixel and those around it.
fn median_square(means: &[f64], width: usize, p: usize) -> f64 {
    let mut squares: ArrayVec<f64, 9> = around(p, 1, width, means.len()).map(|q| means[q] * means[q]).collect();
    squares.sort_unstable_by(f64::total_cmp);
    squares[squares.len() / 2]
}
