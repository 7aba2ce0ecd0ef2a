//! Sums over the samples of one pixel.

use super::aovs::Aovs;
use crate::film::{FilmSpec, Moments, PixelSums, Tree};
use crate::math::Spectrum;
use crate::recorder::PathRecorder;

/// Accumulator of the samples of one pixel, reused for all pixels of a tile.
pub struct PixelAccumulator {
    /// Colour moments of each sequence.
    sequences: Vec<Tree<Moments>>,
    /// Σy² and Σy³ over all samples, in sample order.
    gray: Tree<[f64; 2]>,
    /// Totals of the sequences. The vector is kept so that its memory is used again.
    totals: Vec<Moments>,
    /// Layers, if the picture has any.
    pub aovs: Option<Aovs>,
}

impl PixelAccumulator {
    /// An accumulator without samples.
    ///
    /// - `sequences`: number of sequences among which the samples are divided
    pub fn new(spec: &FilmSpec, sequences: usize) -> PixelAccumulator {
        PixelAccumulator { sequences: vec![Tree::default(); sequences], gray: Tree::default(), totals: vec![], aovs: Aovs::new(spec) }
    }

    /// Removes all samples, for the next pixel.
    pub fn clear(&mut self) {
        self.sequences.iter_mut().for_each(Tree::clear);
        self.gray.clear();
        self.aovs.iter_mut().for_each(Aovs::clear);
    }

    /// Recorder for the next sample, if a layer needs its light.
    pub fn recorder(&mut self) -> Option<&mut dyn PathRecorder> {
        self.aovs.as_mut().and_then(Aovs::recorder)
    }

    /// Adds the next sample, which belongs to the given sequence. A value that is not finite counts as black. Returns whether it is
    /// finite.
    #[inline(always)]
    pub fn add(&mut self, sequence: usize, value: Spectrum) -> bool {
        let is_valid = value.is_finite();
        let sample = Moments::of(if is_valid { value } else { Spectrum::BLACK });
        self.gray.push(0, sample.gray, Moments::join_gray);
        self.sequences[sequence].push(0, sample, Moments::join);
        is_valid
    }

    /// Appends the colour sums of the pixel.
    pub fn push_colors(&mut self, sums: &mut PixelSums) {
        self.totals.clear();
        self.totals.extend(self.sequences.iter().map(|tree| tree.total(Moments::join).unwrap_or_default()));
        sums.push(&self.totals, self.gray.total(Moments::join_gray).unwrap_or_default());
    }
}
