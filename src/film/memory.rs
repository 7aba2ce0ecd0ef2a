//! Memory that a picture needs while it is rendered and written.

use super::PixelLayout;

/// Upper bound of the bytes that a render needs, without the scene itself.
///
/// ```text
/// 8 s · blocks of the tree + the larger of
///   2 · 8 s          the sums of a wave, and the tiles they are assembled from
///   8 s + 132        at the end: the total; means and errors (48), seven channels (28), and twice that for the file;
///                    for each layer sum at most one channel, also three times (12)
/// ```
///
/// per pixel, where s is the number of sums of a pixel.
pub fn needed(pixels: u64, layout: PixelLayout, samples: u64) -> u128 {
    let block = 8 * layout.all() as u128;
    u128::from(pixels) * (block * u128::from(blocks(samples)) + (2 * block).max(block + 132 + 12 * layout.layers as u128))
}

/// Greatest number of blocks that the tree holds during a render of `samples` samples.
///
/// There is one block for each binary digit of the sample count that is 1. Waves of 64 samples leave the digits below 2⁶ at 0, and waves that
/// the time limit shortens leave at most the four highest digits at 1.
fn blocks(samples: u64) -> u32 {
    let during_render = (samples / 64 + 1).ilog2().max((samples + 1).ilog2().min(4));
    samples.count_ones().max(during_render).max(1)
}
