//! Different numbers of samples for different pixels.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::Crop;

/// Number of samples of each pixel per *round* of samples, as a power of two.
///
/// In each round pixel i takes 2^lᵢ samples, so that it has n·2^lᵢ samples after n rounds. The samples of one round are an aligned
/// block of the pixel's sample indices. Statements of [`Wave`](super::Wave) and [`Tree`](super::Tree) about samples therefore hold for
/// rounds: any split into aligned waves gives the same bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Allocation {
    /// Levels lᵢ in rows over the crop; `None` if all are 0.
    levels: Option<Arc<[u8]>>,
}

impl Allocation {
    /// An allocation with the given levels lᵢ ≤ [`Allocation::MAX_LEVEL`] of all pixels of the crop.
    pub fn new(levels: Vec<u8>) -> Allocation {
        debug_assert!(levels.iter().all(|&level| level <= Allocation::MAX_LEVEL));
        Allocation { levels: Some(levels.into()) }
    }

    /// The allocation of some of the pixels.
    ///
    /// - `crop`: rectangle of this allocation
    /// - `inner`: rectangle within it
    pub fn cropped(&self, crop: Crop, inner: Crop) -> Allocation {
        let levels = self.levels.as_ref().map(|levels| crop.rows(inner).flat_map(|row| levels[row].iter().copied()).collect());
        Allocation { levels }
    }

    /// Greatest level: 64 samples per round.
    pub const MAX_LEVEL: u8 = 6;

    /// Whether all pixels take one sample per round.
    pub fn is_even(&self) -> bool {
        self.levels.is_none()
    }

    /// Levels lᵢ of all pixels, in rows over the crop; `None` if all are 0.
    pub fn all(&self) -> Option<&[u8]> {
        self.levels.as_deref()
    }

    /// What the numbers of samples in messages count.
    pub fn unit(&self) -> &'static str {
        if self.is_even() { "samples" } else { "rounds" }
    }

    /// Level lᵢ of a pixel, by its index in the crop.
    pub fn level(&self, pixel: usize) -> u32 {
        self.levels.as_ref().map_or(0, |levels| levels[pixel].into())
    }

    /// Number of samples of a pixel after `rounds` rounds.
    pub fn samples(&self, pixel: usize, rounds: u64) -> u64 {
        rounds << self.level(pixel)
    }

    /// Number of samples per round, averaged over all pixels.
    pub fn mean(&self) -> f64 {
        let mean = |levels: &Arc<[u8]>| levels.iter().map(|&level| f64::from(1u32 << level)).sum::<f64>() / levels.len().max(1) as f64;
        self.levels.as_ref().map_or(1.0, mean)
    }

    /// Least and greatest level.
    pub fn levels(&self) -> RangeInclusive<u32> {
        let bounds = |levels: &Arc<[u8]>| {
            let extreme = |level: Option<&u8>| level.copied().unwrap_or(0).into();
            extreme(levels.iter().min())..=extreme(levels.iter().max())
        };
        self.levels.as_ref().map_or(0..=0, bounds)
    }

    /// Least and greatest number of samples of a pixel per round.
    pub fn range(&self) -> [u64; 2] {
        let levels = self.levels();
        [levels.start(), levels.end()].map(|level| 1 << level)
    }
}
