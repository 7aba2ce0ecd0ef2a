//! Distance of a picture from a reference.

use std::collections::HashSet;

use super::error::{errors, floor};
use crate::film::Image;

/// Mean squared distances of a picture from a reference. What the reference's own standard errors add to them is subtracted.
///
/// ```text
/// mse    = 1/3P Σ ((x − r)² − v_r)
/// relmse = 1/3P Σ ((x − r)² − v_r) / (r² + ε),   ε = 0.01 · mean(r)²
/// ```
///
/// Sums run over P pixels and three colours. A distance is below 0 where the picture is closer to the truth than the reference is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Mean squared error.
    pub mse: f64,
    /// Relative mean squared error.
    pub relmse: f64,
    /// relMSE without the largest 0.1 % of the pixels, so that a few bright pixels do not decide it.
    pub trimmed: f64,
}

/// Share of the pixels that the trimmed mean leaves out.
const TRIMMED: f64 = 1e-3;

impl Distance {
    /// Distance of an image from a reference; `None` for pictures of different sizes and for a black reference.
    pub fn between(image: &Image, reference: &Image) -> Option<Distance> {
        Distance::without(image, reference, &[])
    }

    /// Distance of an image from a reference, without some of the pixels. ε is still that of the whole reference.
    ///
    /// - `aside`: indices of the pixels that do not count
    pub fn without(image: &Image, reference: &Image, aside: &[usize]) -> Option<Distance> {
        let aside: HashSet<usize> = aside.iter().copied().collect();
        let floor = floor(reference).filter(|_| image.size == reference.size)?;
        let errors = errors(reference);
        let variance = |i: usize, c: usize| errors.map_or(0.0, |channels| f64::from(channels[c][i]).powi(2));
        let (mut mse, mut shares) = (0.0, Vec::with_capacity(image.pixels().count()));
        for (i, (x, r)) in image.pixels().zip(reference.pixels()).enumerate().filter(|(i, _)| !aside.contains(i)) {
            let mut share = 0.0;
            for c in 0..3 {
                let (x, r) = (f64::from(x[c]), f64::from(r[c]));
                let square = (x - r).powi(2) - variance(i, c);
                mse += square / 3.0;
                share += square / (3.0 * (r * r + floor));
            }
            shares.push(share);
        }
        let count = shares.len() as f64;
        let relmse = shares.iter().sum::<f64>() / count;
        shares.sort_unstable_by(f64::total_cmp);
        let kept = &shares[..shares.len() - (TRIMMED * count) as usize];
        Some(Distance { mse: mse / count, relmse, trimmed: kept.iter().sum::<f64>() / kept.len() as f64 })
    }
}
