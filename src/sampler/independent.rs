//! Independent random numbers.

use glam::{UVec2, Vec2};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::dimension::BLOCK;
use super::hash::{dimension_key, mix, pixel_key};
use super::{Sampler, dimension};
use crate::math::float::unit_f32;

/// Independent uniform numbers.
///
/// Each block of 8 dimensions has a xoshiro256++ stream seeded by (seed, pixel, index, block), which is filled when a number of the
/// block is requested. Dimension d is number d mod 8 of its stream. Each 64-bit draw gives two numbers.
///
/// Source: Blackman and Vigna, *Scrambled Linear Pseudorandom Number Generators* (2021).
pub struct Independent {
    seed: u64,
    key: u64,
    dimension: u32,
    /// Block that `numbers` belongs to; `None` before the first.
    block: Option<u32>,
    numbers: [f32; dimension::BLOCK as usize],
}

impl Independent {
    /// A sampler with the given seed.
    pub fn new(seed: u64) -> Independent {
        Independent { seed, key: pixel_key(seed, UVec2::ZERO), dimension: 0, block: None, numbers: [0.0; BLOCK as usize] }
    }

    /// The next `N` numbers, which lie in one block.
    #[inline]
    fn take<const N: usize>(&mut self, block: u32, place: usize) -> [f32; N] {
        if self.block != Some(block) {
            self.fill(block);
        }
        self.dimension = self.dimension.wrapping_add(N as u32);
        std::array::from_fn(|k| self.numbers[place + k])
    }

    fn fill(&mut self, block: u32) {
        let mut stream = Xoshiro256PlusPlus::seed_from_u64(dimension_key(self.key, block));
        for pair in self.numbers.chunks_exact_mut(2) {
            let bits = stream.next_u64();
            pair.copy_from_slice(&[unit_f32((bits >> 32) as u32), unit_f32(bits as u32)]);
        }
        self.block = Some(block);
    }

    /// Block of the next number and offset within the block.
    fn place(&self) -> (u32, usize) {
        (self.dimension / BLOCK, (self.dimension % BLOCK) as usize)
    }
}

impl Sampler for Independent {
    fn start(&mut self, pixel: UVec2, index: u64) {
        self.key = mix(pixel_key(self.seed, pixel) ^ index);
        self.dimension = 0;
        self.block = None;
    }

    fn at(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    fn next_1d(&mut self) -> f32 {
        let (block, place) = self.place();
        let [x] = self.take(block, place);
        x
    }

    fn next_2d(&mut self) -> Vec2 {
        match self.place() {
            (block, place) if place + 1 < BLOCK as usize => Vec2::from(self.take(block, place)),
            _ => Vec2::new(self.next_1d(), self.next_1d()),
        }
    }
}
