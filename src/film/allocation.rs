//! How densely each pixel is sampled.

use std::sync::Arc;

/// Pixel i takes 2^lᵢ samples in the time in which a plain pixel takes one.
///
/// Samples are counted in *rounds*: after n of them pixel i has n·2^lᵢ. The samples of one round of a pixel are an
/// aligned block of its own indices, so that what [`Wave`](super::Wave) and [`Tree`](super::Tree) say of samples holds of
/// rounds: any split into aligned waves gives the same bits, and a power of two of rounds is one of samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Allocation {
    /// lᵢ, row by row over the crop; `None` where all are 0.
    levels: Option<Arc<[u8]>>,
}

impl Allocation {
    /// - `levels`: lᵢ ≤ [`Allocation::MAX_LEVEL`] of every pixel of the crop
    pub fn new(levels: Vec<u8>) -> Allocation {
        debug_assert!(levels.iter().all(|&level| level <= Allocation::MAX_LEVEL));
        Allocation { levels: Some(levels.into()) }
    }

    /// Sixty-four samples beside one.
    pub const MAX_LEVEL: u8 = 6;

    pub fn is_even(&self) -> bool {
        self.levels.is_none()
    }

    pub fn level(&self, pixel: usize) -> u32 {
        self.levels.as_ref().map_or(0, |levels| levels[pixel].into())
    }

    /// The samples of a pixel after so many rounds.
    pub fn samples(&self, pixel: usize, rounds: u64) -> u64 {
        rounds << self.level(pixel)
    }

    /// Samples per round, the mean of all pixels.
    pub fn mean(&self) -> f64 {
        let mean = |levels: &Arc<[u8]>| levels.iter().map(|&level| f64::from(1u32 << level)).sum::<f64>() / levels.len().max(1) as f64;
        self.levels.as_ref().map_or(1.0, mean)
    }

    /// The least and the most samples of a pixel per round.
    pub fn range(&self) -> [u64; 2] {
        let bounds = |levels: &Arc<[u8]>| {
            let extreme = |level: Option<&u8>| 1 << level.copied().unwrap_or(0);
            [extreme(levels.iter().min()), extreme(levels.iter().max())]
        };
        self.levels.as_ref().map_or([1, 1], bounds)
    }
}
