//! A picture as sure of itself as its neighbourhoods allow.

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::around::around;
use super::relative::floor_at;
use super::share::{Calm, Known, Share};
use crate::film::MomentFilm;
use crate::film::block::{Estimate, Skew, estimate};

/// What each pixel of a film knows of itself and of those around it.
///
/// The calm place of a pixel is the mean of the pixels around it that differ from their median by no more than noise does. The pixel
/// alone would not do: one bright sample makes it bright as well as uncertain.
pub(super) struct Picture {
    width: usize,
    /// ν
    pub freedom: f64,
    /// ε
    floor: f64,
    /// Value and variance of each colour.
    pixels: Vec<Estimate>,
    /// The same of their mean.
    gray: Vec<Gray>,
    /// κ₃/v of their mean.
    pull: Vec<f64>,
}

#[derive(Clone, Copy)]
struct Gray {
    value: f64,
    variance: f64,
}

/// Neighbours this far away count (pixels).
const REACH: usize = 1;
const AROUND: usize = (2 * REACH + 1) * (2 * REACH + 1);

impl Picture {
    /// `None` where samples tell no error, and for a black picture.
    pub fn new(film: &MomentFilm, width: usize) -> Option<Picture> {
        let (block, freedom) = (film.total(), film.freedom());
        let samples = |(i, pixel)| (pixel, film.samples_of(i));
        let pixels: Vec<Estimate> = block.pixels().enumerate().map(samples).map(|(pixel, n)| estimate(block.spread(), pixel, n)).collect();
        let skews: Vec<Skew> = block.pixels().enumerate().map(samples).map(|(pixel, n)| Skew::of(block.spread(), pixel, n)).collect();
        let gray: Vec<Gray> = pixels.iter().map(Gray::of).collect();
        let mean = gray.iter().map(|gray| gray.value).sum::<f64>() / gray.len() as f64;
        let floor = floor_at(mean).filter(|_| freedom > 0.0)?;
        let narrower = narrower(&gray, &skews, floor);
        let pull = skews.iter().map(|skew| narrower * skew.pull).collect();
        Some(Picture { width, freedom, floor, pixels, gray, pull })
    }

    /// What each pixel adds to relMSE, the mean of its colours.
    pub fn shares(&self) -> Vec<Share> {
        (0..self.pixels.len()).into_par_iter().map(|i| self.share(i)).collect()
    }

    /// relMSE · P, had each pixel been its own reference.
    pub fn uncorrected(&self) -> f64 {
        self.pixels.iter().flatten().map(|(x, v)| v / (3.0 * (x * x + self.floor))).sum()
    }

    fn share(&self, i: usize) -> Share {
        let typical = self.typical(i);
        let others: ArrayVec<(usize, f64), AROUND> = self.around(i).map(|q| (q, self.likeness(q, typical))).collect();
        let all: f64 = others.iter().map(|(_, likeness)| likeness).sum();
        // Where the pixel is of another kind than most around it, it stands for itself.
        let own = if all > 0.0 { 1.0 - self.likeness(i, typical) } else { 1.0 };
        let noise = self.gray[i].variance.sqrt();
        let color = |c: usize| {
            let (x, v) = self.pixels[i][c];
            // ν/(ν + 2): the square of v is that much too large for σ⁴.
            let alone = Calm { value: own * x, variance: own * v * self.freedom / (self.freedom + 2.0) };
            let calm = others.iter().filter(|_| own < 1.0).fold(alone, |calm, (q, likeness)| {
                let (weight, (x, v)) = ((1.0 - own) * likeness / all, self.pixels[*q][c]);
                Calm { value: calm.value + weight * x, variance: calm.variance + weight * v }
            });
            // A colour is as skewed as the mean of the colours, in the measure of its own noise.
            let pull = if noise > 0.0 { self.pull[i] * v.sqrt() / noise } else { 0.0 };
            Share::new(&Known { value: x, variance: v, pull, freedom: self.freedom }, &calm, self.floor)
        };
        Share::mean([color(0), color(1), color(2)])
    }

    /// The pixels within reach of pixel i.
    fn around(&self, i: usize) -> impl Iterator<Item = usize> {
        around(i, REACH, self.width, self.pixels.len()).filter(move |q| *q != i)
    }

    /// The medians of value and variance around a pixel: neither a bright sample nor an edge moves them far.
    fn typical(&self, i: usize) -> Gray {
        let median = |f: fn(&Gray) -> f64| {
            let mut values: ArrayVec<f64, AROUND> = self.around(i).chain([i]).map(|q| f(&self.gray[q])).collect();
            let middle = values.len() / 2;
            *values.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        Gray { value: median(|gray| gray.value), variance: median(|gray| gray.variance) }
    }

    /// 1 where a pixel differs from what is typical by no more than noise does, falling to 0.
    fn likeness(&self, q: usize, typical: Gray) -> f64 {
        let (distance, noise) = ((self.gray[q].value - typical.value).powi(2), self.gray[q].variance + typical.variance);
        if distance <= noise { 1.0 } else { (0.5 * (1.0 - distance / noise)).exp() }
    }
}

impl Gray {
    /// The colours move together: their errors add, not their variances.
    fn of(pixel: &Estimate) -> Gray {
        let mean = |f: fn(&(f64, f64)) -> f64| pixel.iter().map(f).sum::<f64>() / 3.0;
        Gray { value: mean(|c| c.0), variance: mean(|c| c.1.sqrt()).powi(2) }
    }
}

/// By how much scramblings narrow the noise of independent samples: the ratio of the standard deviations, over the whole picture.
///
/// The narrower noise is taken to be as skewed as the wider one, so that κ₃/v shrinks in this measure.
fn narrower(gray: &[Gray], skews: &[Skew], floor: f64) -> f64 {
    let relative = |variance: f64, value: f64| variance / (value * value + floor);
    let found: f64 = gray.iter().map(|gray| relative(gray.variance, gray.value)).sum();
    let independent: f64 = gray.iter().zip(skews).map(|(gray, skew)| relative(skew.variance, gray.value)).sum();
    if independent > found { (found / independent).sqrt() } else { 1.0 }
}
