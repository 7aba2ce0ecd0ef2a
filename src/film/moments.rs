//! Sums that depend on the samples alone, not on the order in which threads add them.

use std::ops::Range;

use super::Wave;
use crate::math::Spectrum;

/// Sums of powers of some samples: Σx and Σx² of each colour, Σy² and Σy³ of the mean y of the colours.
///
/// The third power gives the third central moment, which is n² times the
/// covariance of the mean of a pixel and the estimated variance of that mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Σx of each colour.
    pub sum: [f64; 3],
    /// Σx² of each colour.
    pub square: [f64; 3],
    /// Σy² and Σy³.
    pub gray: [f64; 2],
}

impl Moments {
    /// Moments of one sample.
    pub fn of(sample: Spectrum) -> Moments {
        Moments::of_rgb(sample.to_rgb().map(f64::from))
    }

    /// Moments of one sample with these colours.
    pub fn of_rgb(x: [f64; 3]) -> Moments {
        let y = (x[0] + x[1] + x[2]) / 3.0;
        Moments { sum: x, square: x.map(|c| c * c), gray: [y * y, y * y * y] }
    }

    /// Moments of both sets of samples.
    pub fn join(self, other: &Moments) -> Moments {
        let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let gray = Moments::join_gray(self.gray, &other.gray);
        Moments { sum: add(self.sum, other.sum), square: add(self.square, other.square), gray }
    }

    /// Sums of the gray moments.
    pub fn join_gray(a: [f64; 2], b: &[f64; 2]) -> [f64; 2] {
        [a[0] + b[0], a[1] + b[1]]
    }
}

/// Binary tree of sums: blocks of 2^level consecutive values, joined like the digits of a binary counter.
///
/// ```text
/// level 2   [ 0  1  2  3 ]
/// level 1   [ 0  1 ][ 2  3 ][ 4  5 ]
/// level 0   [0] [1] [2] [3] [4] [5] [6]
/// ```
///
/// Two siblings are joined as soon as both exist. The order of additions, and with it every rounding, follows from the number of
/// values alone: any split into aligned blocks, and any pause, gives the same bits. The result is also more accurate than one long
/// sum.
///
/// A tree that starts at a later value holds a part of the values, in the same blocks that the complete tree would have joined.
#[derive(Clone, Debug)]
pub struct Tree<T> {
    values: Range<u64>,
    /// Levels and sums of adjacent blocks. In a tree from value 0 on, the levels decrease.
    blocks: Vec<(u32, T)>,
}

impl<T> Default for Tree<T> {
    fn default() -> Tree<T> {
        Tree::starting_at(0)
    }
}

impl<T> Tree<T> {
    /// An empty tree whose first value will have the index `first`.
    pub fn starting_at(first: u64) -> Tree<T> {
        Tree { values: first..first, blocks: vec![] }
    }

    /// Removes all values.
    pub fn clear(&mut self) {
        self.values.end = self.values.start;
        self.blocks.clear();
    }

    /// Indices of the values.
    pub fn values(&self) -> Range<u64> {
        self.values.clone()
    }

    /// Adds the next 2^level values as one block. The index of the first of them must be a multiple of 2^level.
    // Always inlined into the loop over the samples.
    #[inline(always)]
    pub fn push(&mut self, mut level: u32, mut block: T, join: impl Fn(T, &T) -> T) {
        let first = self.values.end;
        self.values.end += 1 << level;
        // A block is a right child if its number among the blocks of its level is odd.
        while (first >> level) & 1 == 1 && self.blocks.last().is_some_and(|last| last.0 == level) {
            if let Some((_, sibling)) = self.blocks.pop() {
                block = join(sibling, &block);
                level += 1;
            }
        }
        self.blocks.push((level, block));
    }

    /// Blocks with the ranges of their values.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = (Wave, &T)> {
        let mut next = self.values.start;
        self.blocks.iter().map(move |(level, block)| {
            let first = next;
            next += 1 << level;
            (Wave { first, level: *level }, block)
        })
    }

    /// Sum of all values, added from the shortest block on.
    pub fn total(&self, join: impl Fn(T, &T) -> T) -> Option<T>
    where
        T: Clone,
    {
        let (last, longer) = self.blocks.split_last()?;
        Some(longer.iter().rev().fold(last.1.clone(), |sum, (_, block)| join(sum, block)))
    }
}
