//! The neighbourhood of a pixel.

/// The pixels of the square around pixel i, itself among them, row by row; cut off at the edges of the picture.
///
/// - `pixels`: of the picture, in rows of `width`; `reach`: half the edge of the square, its middle not counted
pub(super) fn around(i: usize, reach: usize, width: usize, pixels: usize) -> impl Iterator<Item = usize> {
    let span = move |at: usize, end: usize| at.saturating_sub(reach)..(at + reach + 1).min(end);
    let (across, down) = (span(i % width, width), span(i / width, pixels / width));
    down.flat_map(move |y| across.clone().map(move |x| y * width + x))
}
