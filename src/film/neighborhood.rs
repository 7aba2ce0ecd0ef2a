//! Neighbourhood of a pixel.

/// Indices of the pixels of the square around pixel i, with i itself, row by row. The square is cut off at the edges of the
/// picture.
///
/// - `pixels`: number of pixels of the picture, in rows of `width`
/// - `reach`: distance from the pixel in the middle to the edge of the square (pixels)
pub(crate) fn neighborhood(i: usize, reach: usize, width: usize, pixels: usize) -> impl Iterator<Item = usize> {
    let span = move |at: usize, end: usize| at.saturating_sub(reach)..(at + reach + 1).min(end);
    let (across, down) = (span(i % width, width), span(i / width, pixels / width));
    down.flat_map(move |y| across.clone().map(move |x| y * width + x))
}
