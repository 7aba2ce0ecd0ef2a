//! Independent random numbers.

use glam::{UVec2, Vec2};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::dimension::BLOCK;
use super::hash::{dimension_key, mix, pixel_key};
use super::{SampleKey, Sampler};
use crate::math::float::unit_f32;

/// Independent uniform numbers.
///
/// Each block of 8 dimensions has a xoshiro256++ stream seeded by (seed, pixel, index, block), which is filled when a number of the
/// block is requested. Dimension d is number d mod 8 of its stream. Each 64-bit draw gives two numbers.
///
/// Source: Blackman and Vigna, *Scrambled Linear Pseudorandom Number Generators* (2021).
pub struct Independent {
    /// Seed of all numbers.
    pub seed: u64,
}

impl Sampler for Independent {
    fn key(&self, pixel: UVec2, index: u64) -> SampleKey {
        SampleKey { hash: mix(pixel_key(self.seed, pixel) ^ index), index }
    }

    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        let [x] = Block::default().get(key, dimension);
        x
    }

    fn get_2d(&self, key: SampleKey, dimension: u32) -> Vec2 {
        Vec2::from(Block::default().get(key, dimension))
    }
}

/// Independent uniform numbers in [0, 1) without an end.
#[derive(Clone, Debug)]
pub struct Stream(Xoshiro256PlusPlus);

impl Stream {
    pub(super) fn new(seed: u64) -> Stream {
        Stream(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// The next number.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        unit_f32((self.0.next_u64() >> 32) as u32)
    }
}

/// The block of one sample's numbers that was asked for last. The stream of a block is computed once for all its numbers.
#[derive(Clone, Copy, Default)]
pub struct Block {
    /// Index of the block; `None` before the first number.
    index: Option<u32>,
    numbers: [f32; BLOCK as usize],
}

impl Block {
    /// Numbers of `N` dimensions from the given one on. The key must be that of the same sample in each call.
    #[inline]
    pub fn get<const N: usize>(&mut self, key: SampleKey, dimension: u32) -> [f32; N] {
        let (index, place) = (dimension / BLOCK, (dimension % BLOCK) as usize);
        if place + N > BLOCK as usize {
            return std::array::from_fn(|k| self.get::<1>(key, dimension.wrapping_add(k as u32))[0]);
        }
        if self.index != Some(index) {
            self.fill(key, index);
        }
        std::array::from_fn(|k| self.numbers[place + k])
    }

    fn fill(&mut self, key: SampleKey, index: u32) {
        let mut stream = Xoshiro256PlusPlus::seed_from_u64(dimension_key(key.hash, index));
        for pair in self.numbers.chunks_exact_mut(2) {
            let bits = stream.next_u64();
            pair.copy_from_slice(&[unit_f32((bits >> 32) as u32), unit_f32(bits as u32)]);
        }
        self.index = Some(index);
    }
}
