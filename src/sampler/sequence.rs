//! Sequence of samples, and the numbers of one sample.

use glam::{UVec2, Vec2};

use super::hash::{dimension_key, mix};
use super::independent::{Block, Stream};
use super::{Halton, Independent, SampleKey, Sampler, Sobol, Stratified};

/// Sampler with its settings, shared by all threads.
///
/// pt's own samplers are variants of the enum, so that drawing a number needs no virtual call.
pub enum Sequence {
    /// Independent numbers.
    Independent(Independent),
    /// Stratified numbers.
    Stratified(Stratified),
    /// Scrambled Halton sequence.
    Halton(Halton),
    /// Scrambled Sobol' sequences.
    Sobol(Sobol),
    /// A sampler of another crate.
    Other(Box<dyn Sampler>),
}

/// Evaluates an expression with the sampler of a sequence, whatever its type.
macro_rules! with_sampler {
    ($sequence:expr, $sampler:ident => $value:expr) => {
        match $sequence {
            Sequence::Independent($sampler) => $value,
            Sequence::Stratified($sampler) => $value,
            Sequence::Halton($sampler) => $value,
            Sequence::Sobol($sampler) => $value,
            Sequence::Other($sampler) => $value,
        }
    };
}

impl Sequence {
    /// Numbers of the sample `index` of a pixel.
    #[inline]
    pub fn sample(&self, pixel: UVec2, index: u64) -> SampleNumbers<'_> {
        let key = with_sampler!(self, sampler => sampler.key(pixel, index));
        SampleNumbers { sequence: self, key, block: Block::default() }
    }
}

/// Random numbers of one sample, by dimension. They do not depend on the order in which they are asked for.
///
/// Tests: a_sample_has_the_numbers_of_its_key.
#[derive(Clone, Copy)]
pub struct SampleNumbers<'a> {
    pub(super) sequence: &'a Sequence,
    key: SampleKey,
    /// The independent numbers that were computed last.
    block: Block,
}

impl SampleNumbers<'_> {
    /// Key from which the numbers are computed.
    pub fn key(&self) -> SampleKey {
        self.key
    }

    /// Independent numbers without an end, for uses that cannot say beforehand how many they need. They belong to a dimension, and are other
    /// numbers than that of [`SampleNumbers::get_1d`].
    pub fn stream(&self, dimension: u32) -> Stream {
        // The hash of some samplers is that of the pixel alone.
        Stream::new(dimension_key(mix(!self.key.hash) ^ mix(self.key.index), dimension))
    }

    /// Number of a dimension.
    #[inline]
    pub fn get_1d(&mut self, dimension: u32) -> f32 {
        match self.sequence {
            Sequence::Independent(_) => self.block.get::<1>(self.key, dimension)[0],
            other => with_sampler!(other, sampler => sampler.get_1d(self.key, dimension)),
        }
    }

    /// Numbers of a dimension and of the next one, which belong together.
    #[inline]
    pub fn get_2d(&mut self, dimension: u32) -> Vec2 {
        match self.sequence {
            Sequence::Independent(_) => Vec2::from(self.block.get(self.key, dimension)),
            other => with_sampler!(other, sampler => sampler.get_2d(self.key, dimension)),
        }
    }

    /// Number of a dimension, such as for a choice, and the numbers of the next two, which belong together.
    #[inline]
    pub fn get_3d(&mut self, dimension: u32) -> (f32, Vec2) {
        match self.sequence {
            Sequence::Independent(_) => {
                let [choice, x, y] = self.block.get(self.key, dimension);
                (choice, Vec2::new(x, y))
            }
            other => with_sampler!(other, sampler => sampler.get_3d(self.key, dimension)),
        }
    }
}
