//! What a picture takes while it is rendered and written.

use super::Slots;
use crate::error::memory::fallible;

/// Bytes that a render of so many pixels and samples takes at most, the scene itself not counted.
///
/// ```text
/// 8 s · blocks of the tree + the larger of
///   2 · 8 s          a wave's block, and the tiles that it is put together from
///   8 s + 132        at the end: their sum; means and errors (48), seven channels (28), and twice that for the file;
///                    a channel at most, thrice too, for each number of a layer (12)
/// ```
///
/// for each pixel, with s its numbers in a block.
pub fn needed(pixels: u64, slots: Slots, samples: u64) -> u128 {
    let block = 8 * slots.all() as u128;
    u128::from(pixels) * (block * u128::from(blocks(samples)) + (2 * block).max(block + 132 + 12 * slots.layers as u128))
}

/// Blocks that the tree of so many samples holds at most.
///
/// One for each binary digit that can be 1 at a time. Waves are at most 64 long; shorter ones are an eighth of what is there, or
/// longer: four digits.
fn blocks(samples: u64) -> u32 {
    let on_the_way = (samples / 64 + 1).ilog2().max((samples + 1).ilog2().min(4));
    samples.count_ones().max(on_the_way).max(1)
}

/// Whether so many bytes can be had.
pub fn can_be_had(bytes: u128) -> bool {
    usize::try_from(bytes).is_ok_and(|bytes| fallible(|| Vec::<u8>::new().try_reserve_exact(bytes).is_ok()))
}
