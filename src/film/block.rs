//! What the samples of one wave add up to.

use super::Moments;
use crate::sampler::Spread;

/// Sums over some samples of every pixel, rows of the crop from the top.
///
/// A pixel has as many numbers as its [`Spread`] needs:
///
/// ```text
/// Samples          Σr Σg Σb  Σr² Σg² Σb²   Σy² Σy³    the spread of the samples tells the error of their mean
/// Scramblings(K)   Σr Σg Σb of each        Σy² Σy³    the spread of the K means tells the error of their mean
/// ```
///
/// with y the mean of the colours. What [layers](super::layer) add up follows them. All are sums, so that blocks join by adding.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    slots: Slots,
    sums: Vec<f64>,
}

/// Which numbers a pixel has: those of its colours, then those of its layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slots {
    pub spread: Spread,
    /// How many numbers layers add up.
    pub layers: usize,
}

impl Slots {
    fn colors(self) -> usize {
        match self.spread {
            Spread::Samples => 6 + GRAY,
            Spread::Scramblings(k) => 3 * k as usize + GRAY,
        }
    }

    /// Numbers per pixel.
    pub fn all(self) -> usize {
        self.colors() + self.layers
    }
}

/// Without layers.
impl From<Spread> for Slots {
    fn from(spread: Spread) -> Slots {
        Slots { spread, layers: 0 }
    }
}

impl Block {
    /// Nothing yet, with room for so many pixels.
    pub fn with_capacity(slots: impl Into<Slots>, pixels: usize) -> Block {
        let slots = slots.into();
        Block { slots, sums: Vec::with_capacity(pixels * slots.all()) }
    }

    /// No light in so many pixels.
    pub fn black(slots: impl Into<Slots>, pixels: usize) -> Block {
        let slots = slots.into();
        Block { slots, sums: vec![0.0; pixels * slots.all()] }
    }

    /// Of independent samples.
    pub fn of_samples(pixels: &[Moments]) -> Block {
        let mut block = Block::with_capacity(Spread::Samples, pixels.len());
        pixels.iter().for_each(|moments| block.push(std::slice::from_ref(moments), moments.gray));
        block
    }

    pub fn spread(&self) -> Spread {
        self.slots.spread
    }

    pub fn slots(&self) -> Slots {
        self.slots
    }

    /// From the numbers of another block of these slots, which may have been in a file; `None` for a share of a pixel.
    pub fn from_numbers(slots: Slots, sums: Vec<f64>) -> Option<Block> {
        sums.len().is_multiple_of(slots.all()).then_some(Block { slots, sums })
    }

    /// All of them, pixel after pixel.
    pub fn numbers(&self) -> &[f64] {
        &self.sums
    }

    /// The samples of the next pixel, sequence by sequence. Where there are layers, [`Block::push_layers`] completes it.
    ///
    /// - `gray`: Σy² and Σy³ of all of them in their own order, in which any split joins them again
    pub fn push(&mut self, sequences: &[Moments], gray: [f64; GRAY]) {
        sequences.iter().for_each(|moments| self.sums.extend(moments.sum));
        if self.spread() == Spread::Samples {
            sequences.iter().for_each(|moments| self.sums.extend(moments.square));
        }
        self.sums.extend(gray);
    }

    /// What the layers of the pixel just pushed add up.
    pub fn push_layers(&mut self, sums: &[f64]) {
        debug_assert_eq!(sums.len(), self.slots.layers);
        self.sums.extend(sums);
    }

    pub fn len(&self) -> usize {
        self.sums.len() / self.slots.all()
    }

    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// The numbers of pixel after pixel, those of their colours.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.sums.chunks_exact(self.slots.all()).map(|pixel| &pixel[..self.slots.colors()])
    }

    /// The numbers of pixel after pixel, those of their layers.
    pub fn layers(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.sums.chunks_exact(self.slots.all()).map(|pixel| &pixel[self.slots.colors()..])
    }

    /// Σx of each pixel, over all its scramblings.
    pub fn sums(&self) -> impl Iterator<Item = [f64; 3]> {
        self.pixels().map(|pixel| total(self.spread(), pixel))
    }

    /// Both must have the same pixels and the same slots.
    pub fn join(mut self, other: &Block) -> Block {
        self.sums.iter_mut().zip(&other.sums).for_each(|(a, b)| *a += b);
        self
    }

    /// A row of `from` becomes pixels `start`… of this block.
    pub(crate) fn put(&mut self, start: usize, from: &Block, pixels: std::ops::Range<usize>) {
        let slots = self.slots.all();
        self.sums[start * slots..][..pixels.len() * slots].copy_from_slice(&from.sums[pixels.start * slots..pixels.end * slots]);
    }
}

/// Σy² and Σy³, the last numbers of a pixel's colours.
const GRAY: usize = 2;

/// A mean and its variance, for each colour of a pixel.
pub type Estimate = [(f64, f64); 3];

/// Mean and the variance of that mean, of each colour of a pixel after n samples.
///
/// ```text
/// Samples          v = (Σx² − (Σx)²/n) / (n (n − 1))
/// Scramblings(K)   v = Σ_r n_r (m_r − m)² / (n (K − 1)),  m_r the mean of the n_r samples of scrambling r
/// ```
///
/// - `pixel`: numbers of [`Block::pixels`]
pub fn estimate(spread: Spread, pixel: &[f64], n: u64) -> Estimate {
    let sum = total(spread, pixel);
    let count = n.max(1) as f64;
    std::array::from_fn(|c| {
        let mean = sum[c] / count;
        let squares = match spread {
            Spread::Samples => (pixel[3 + c] - sum[c] * mean).max(0.0),
            Spread::Scramblings(k) => {
                let of = |r: u64| (pixel[3 * r as usize + c], dealt(n, k.into(), r));
                let deviation = |(sum, count): (f64, f64)| if count > 0.0 { count * (sum / count - mean).powi(2) } else { 0.0 };
                (0..k.into()).map(|r| deviation(of(r))).sum()
            }
        };
        (mean, squares / (count * freedom(spread, n)))
    })
}

/// How the mean of a pixel's colours would spread if its samples were independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skew {
    /// v = σ²/n, of the mean of the samples.
    pub variance: f64,
    /// κ₃/v = μ₃/(n σ²), its third cumulant over its variance: by how much brighter it is where it looks noisier. 0 where there is no noise.
    pub pull: f64,
}

impl Skew {
    /// - `pixel`: numbers of [`Block::pixels`]; `n`: its samples
    pub fn of(spread: Spread, pixel: &[f64], n: u64) -> Skew {
        let n = n.max(1) as f64;
        let mean = total(spread, pixel).iter().sum::<f64>() / (3.0 * n);
        let &[.., square, cube] = pixel else { return Skew { variance: 0.0, pull: 0.0 } };
        let variance = square / n - mean * mean;
        // What rounding leaves of equal samples is not noise.
        if variance <= 1e-12 * mean * mean {
            return Skew { variance: 0.0, pull: 0.0 };
        }
        let third = cube / n - mean * (3.0 * square / n - 2.0 * mean * mean);
        Skew { variance: variance / (n - 1.0).max(1.0), pull: third / (n * variance) }
    }
}

/// How many of n samples belong to scrambling r of k.
fn dealt(n: u64, k: u64, r: u64) -> f64 {
    (n.saturating_sub(r)).div_ceil(k) as f64
}

/// ν, the degrees of freedom of the variances: n − 1 or K − 1. 0 where there is no telling.
pub fn freedom(spread: Spread, n: u64) -> f64 {
    match spread {
        Spread::Samples => n.saturating_sub(1) as f64,
        // With fewer than two samples each a scrambling is no better than a sample.
        Spread::Scramblings(k) if n < 2 * u64::from(k) => 0.0,
        Spread::Scramblings(k) => f64::from(k) - 1.0,
    }
}

fn total(spread: Spread, pixel: &[f64]) -> [f64; 3] {
    match spread {
        Spread::Samples => std::array::from_fn(|c| pixel[c]),
        Spread::Scramblings(k) => {
            pixel[..3 * k as usize].as_chunks::<3>().0.iter().fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
        }
    }
}
