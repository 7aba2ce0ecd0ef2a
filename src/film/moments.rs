//! Sums whose result depends on the samples alone, not on who added them up when.

use std::ops::Range;

use super::Wave;
use crate::math::Spectrum;

/// Sums of powers of some samples: Σx and Σx² of each colour, Σy² and Σy³ of their mean y.
///
/// The third power tells how skewed the noise is: by how much a pixel that looks bright looks uncertain too.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    pub sum: [f64; 3],
    pub square: [f64; 3],
    pub gray: [f64; 2],
}

impl Moments {
    pub fn of(sample: Spectrum) -> Moments {
        let x = sample.to_rgb().map(|c| c as f64);
        let y = (x[0] + x[1] + x[2]) / 3.0;
        Moments { sum: x, square: x.map(|c| c * c), gray: [y * y, y * y * y] }
    }

    pub fn join(self, other: &Moments) -> Moments {
        let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let gray = Moments::join_gray(self.gray, &other.gray);
        Moments { sum: add(self.sum, other.sum), square: add(self.square, other.square), gray }
    }

    pub fn join_gray(a: [f64; 2], b: &[f64; 2]) -> [f64; 2] {
        [a[0] + b[0], a[1] + b[1]]
    }
}

/// Blocks of 2^level consecutive values, joined like the digits of a binary counter:
///
/// ```text
/// level 2   [ 0  1  2  3 ]
/// level 1   [ 0  1 ][ 2  3 ][ 4  5 ]
/// level 0   [0] [1] [2] [3] [4] [5] [6]
/// ```
///
/// Siblings join as soon as both are there. The joins, and so every rounding, follow from the
/// number of values alone: any split into aligned blocks gives the same bits, and so does a
/// running sum that pauses anywhere. It is also more accurate than one long sum.
///
/// A tree that starts later holds what a part of the values adds up to: the same blocks that the whole would
/// have joined, as far as they lie within.
#[derive(Clone, Debug)]
pub struct Tree<T> {
    values: Range<u64>,
    /// Side by side. From value 0 on their levels fall.
    blocks: Vec<(u32, T)>,
}

impl<T> Default for Tree<T> {
    fn default() -> Tree<T> {
        Tree::starting_at(0)
    }
}

impl<T> Tree<T> {
    /// Without values, of which the first will be this one.
    pub fn starting_at(first: u64) -> Tree<T> {
        Tree { values: first..first, blocks: vec![] }
    }

    pub fn clear(&mut self) {
        self.values.end = self.values.start;
        self.blocks.clear();
    }

    /// Which values are in it.
    pub fn values(&self) -> Range<u64> {
        self.values.clone()
    }

    /// The next 2^level values as one block; how many there are must be a multiple of 2^level, counted from value 0.
    pub fn push(&mut self, mut level: u32, mut block: T, join: impl Fn(T, &T) -> T) {
        let first = self.values.end;
        self.values.end += 1 << level;
        // A right child has an odd number among the blocks of its level.
        while (first >> level) & 1 == 1 && self.blocks.last().is_some_and(|last| last.0 == level) {
            if let Some((_, sibling)) = self.blocks.pop() {
                block = join(sibling, &block);
                level += 1;
            }
        }
        self.blocks.push((level, block));
    }

    /// The blocks and their places.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = (Wave, &T)> {
        let mut next = self.values.start;
        self.blocks.iter().map(move |(level, block)| {
            let first = next;
            next += 1 << level;
            (Wave { first, level: *level }, block)
        })
    }

    /// All of them, the shortest blocks first.
    pub fn total(&self, join: impl Fn(T, &T) -> T) -> Option<T>
    where
        T: Clone,
    {
        let (last, longer) = self.blocks.split_last()?;
        Some(longer.iter().rev().fold(last.1.clone(), |sum, (_, block)| join(sum, block)))
    }
}
