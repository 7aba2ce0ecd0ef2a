//! Spectrum of the errors of several renders: whether the errors of neighbouring pixels belong together.
//!
//! ```text
//! P(f) = |Σ (e(x) − ē) exp(−2πi f·x)|² / N,     e = render − reference, N pixels
//! ```
//!
//! P is averaged over rings of equal frequency, over the three colours and over the renders. Errors that are independent from pixel to pixel,
//! with the variance σ² in the mean over the pixels, have P = σ² at every frequency. Errors that neighbours share, of light paths that are
//! splatted or mutated, or of a filter, are stronger at long periods; errors that are spread evenly on purpose, as blue noise is, are weaker there. An
//! offset that all pixels share is left out (ē): it is the bias of the mean brightness.
//!
//! Source: Celarek, Jakob, Wimmer, Lehtinen, *Quantifying the Error of Light Transport Algorithms* (2019). Tests: tests/it/spectrum.rs.

use std::f64::consts::SQRT_2;
use std::sync::Arc;

use rustfft::algorithm::{BluesteinsAlgorithm, Radix4};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection};

use crate::film::Image;
use crate::measure::Mean;
use crate::measure::error::errors;

/// Part of a spectrum: periods from one value to √2 times as much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Period of the errors (pixels): the geometric middle of the ring.
    pub period: f64,
    /// Mean of P over the ring and the renders, over the squared mean of the reference.
    pub power: f64,
    /// Standard error of `power`, from the spread of the renders; 0 for one render.
    pub deviation: f64,
    /// Number of frequencies in the ring. Those of f and −f tell the same.
    pub frequencies: usize,
}

/// Smallest number of frequencies of a ring.
const FEWEST: usize = 8;

/// Spectrum of the errors of some renders, from short periods to long ones. The noise of the reference is subtracted. Empty if there
/// are no renders, or the reference is black, or a value is not finite.
pub fn error_spectrum(renders: &[Image], reference: &Image) -> Vec<Ring> {
    let mean = reference.pixels().flatten().map(f64::from).sum::<f64>() / (3 * reference.pixels().count()) as f64;
    let noise = errors(reference).map_or(0.0, |channels| {
        let squares: f64 = channels.iter().flat_map(|channel| channel.iter()).map(|x| f64::from(*x).powi(2)).sum();
        squares / (3 * reference.pixels().count()) as f64
    });
    let spectra: Vec<Vec<f64>> = renders.iter().map(|render| powers(render, reference)).collect();
    let rings = rings(reference);
    if mean <= 0.0 || spectra.iter().flatten().any(|power| !power.is_finite()) {
        return vec![];
    }
    let ring = |(index, ring): (usize, &Vec<usize>)| {
        let of_render = |powers: &Vec<f64>| ring.iter().map(|k| powers[*k]).sum::<f64>() / ring.len() as f64;
        let all: Vec<f64> = spectra.iter().map(|powers| (of_render(powers) - noise) / (mean * mean)).collect();
        let over = Mean::from_sums(all.iter().sum(), all.iter().map(|power| power * power).sum(), all.len() as u64);
        let deviation = if all.len() > 1 { over.standard_error() } else { 0.0 };
        Ring { period: SQRT_2.powf(index as f64 + 1.5), power: over.value, deviation, frequencies: ring.len() }
    };
    if spectra.is_empty() { vec![] } else { rings.iter().enumerate().filter(|(_, ring)| ring.len() >= FEWEST).map(ring).collect() }
}

/// P of every frequency but 0, which has 0: the mean over the colours.
fn powers(render: &Image, reference: &Image) -> Vec<f64> {
    let [width, height] = reference.size.to_array().map(|side| side as usize);
    let count = width * height;
    let mut sum = vec![0.0; count];
    for color in 0..3 {
        let difference = render.pixels().zip(reference.pixels()).map(|(x, r)| f64::from(x[color]) - f64::from(r[color]));
        let mut values: Vec<Complex<f64>> = difference.map(Complex::from).collect();
        let mean = values.iter().sum::<Complex<f64>>() / count as f64;
        values.iter_mut().for_each(|value| *value -= mean);
        transform(&mut values, width, height);
        sum.iter_mut().zip(&values).skip(1).for_each(|(sum, value)| *sum += value.norm_sqr() / (3 * count) as f64);
    }
    sum
}

/// Fourier transform of rows, then of columns, in place.
fn transform(values: &mut [Complex<f64>], width: usize, height: usize) {
    plan(width).process(values);
    let along = plan(height);
    let mut column = vec![Complex::default(); height];
    for x in 0..width {
        (0..height).for_each(|y| column[y] = values[y * width + x]);
        along.process(&mut column);
        (0..height).for_each(|y| values[y * width + x] = column[y]);
    }
}

/// The transform of `length` values.
///
/// The planner of the library chooses among thirty algorithms, which take seconds to compile; these two transform any length.
fn plan(length: usize) -> Arc<dyn Fft<f64>> {
    let radix4 = |length| Arc::new(Radix4::new(length, FftDirection::Forward));
    if length.is_power_of_two() {
        radix4(length)
    } else {
        Arc::new(BluesteinsAlgorithm::new(length, radix4((2 * length - 1).next_power_of_two())))
    }
}

/// Indices of the frequencies of each ring: ring k has the periods from √2^(k + 1) to √2^(k + 2) pixels.
fn rings(image: &Image) -> Vec<Vec<usize>> {
    let [width, height] = image.size.to_array().map(|side| side as usize);
    let frequency = |index: usize, count: usize| index.min(count - index) as f64 / count as f64;
    let mut rings: Vec<Vec<usize>> = vec![];
    for index in 1..width * height {
        let period = frequency(index % width, width).hypot(frequency(index / width, height)).recip();
        // The shortest period, of a chess board, is √2 and may be rounded down.
        let ring = (2.0 * period.log2() - 1.0).floor().max(0.0) as usize;
        if rings.len() <= ring {
            rings.resize(ring + 1, vec![]);
        }
        rings[ring].push(index);
    }
    rings
}
