//! Errors of the tiles of a picture, and the error that most of them do not exceed.
//!
//! Each of T tiles has an estimated error and an upper bound, which holds with the probability 1 − β. At most (1 − share) T tiles may exceed
//! the target. Half of this allowance is kept for tiles whose bounds do not hold: at most w of them, with
//!
//! ```text
//! w = ⌊(1 − share) T / 2⌋,     P(Binomial(T, β) > w) = I_β(w + 1, T − w) = α
//! ```
//!
//! With the probability 1 − α, therefore, ⌈share T⌉ tiles lie below the bound that is the (⌈share T⌉ + w)-th in size. The noise of different
//! tiles is independent, because each pixel has samples of its own.

use glam::UVec2;
use statrs::distribution::{Beta, ContinuousCDF};

use super::correlation::correlation;
use super::local_reference::PixelStatistics;
use super::relative::{Refusal, RelativeError, quantile};
use crate::film::{Crop, Film, MomentFilm};

/// Desired edge of the tiles (pixels). The actual tiles have equal sizes, as near to it as possible. In smaller tiles, often fewer than
/// thirty pixels effectively hold the noise, too few to estimate an error.
const TILE: u32 = 32;

/// Rectangle of a picture, with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// The rectangle.
    pub crop: Crop,
    /// Its relative error, with the ε of the whole picture.
    pub error: RelativeError,
}

/// 1 − confidence at which the error of most tiles is computed. Bounds of higher confidences are extrapolated from it and lie above what they
/// would have to be; those of lower ones are too low and must not be asked for.
const ALPHA: f64 = 0.05;

/// The tiles of a rectangle, in rows.
pub fn tiles(crop: Crop) -> impl Iterator<Item = Crop> {
    let size = crop.size();
    // The quotients rounded to the nearest whole number.
    let counts = ((size + TILE / 2) / TILE).max(UVec2::ONE);
    let corner = move |x: u32, y: u32| crop.min + UVec2::new(x, y) * size / counts;
    (0..counts.y).flat_map(move |y| (0..counts.x).map(move |x| Crop { min: corner(x, y), max: corner(x + 1, y + 1) }))
}

/// Errors of all tiles of a picture. `None` if its samples tell no error, or it is black.
pub fn tile_errors(film: &MomentFilm) -> Option<Vec<Tile>> {
    let crop = film.spec().crop;
    let picture = PixelStatistics::new(film, crop.size().x as usize)?;
    let contributions = picture.contributions();
    let correlation = correlation(film, picture.floor);
    let of_tile = |tile: Crop| {
        let row = |y: u32| &contributions[crop.index(UVec2::new(tile.min.x, y))..][..tile.size().x as usize];
        let own: Vec<_> = (tile.min.y..tile.max.y).flat_map(row).copied().collect();
        Tile { crop: tile, error: RelativeError::over(&own, &picture, correlation) }
    };
    Some(tiles(crop).map(of_tile).collect())
}

/// The tile with the greatest upper bound of its error; one whose error cannot be stated counts as greater than all others.
pub fn worst_tile(tiles: &[Tile], confidence: f64) -> Option<&Tile> {
    let size = |tile: &Tile| tile.error.below(confidence).unwrap_or(f64::INFINITY);
    tiles.iter().max_by(|a, b| size(a).total_cmp(&size(b)).then(a.error.value.total_cmp(&b.error.value)))
}

/// The error that this share of the tiles does not exceed.
pub(super) fn error_of_most(tiles: &[Tile], share: f64) -> Option<RelativeError> {
    let count = tiles.len();
    let needed = (share * count as f64).ceil() as usize;
    let wrong = ((count - needed) as f64 / 2.0) as usize;
    let beta = Beta::new((wrong + 1) as f64, (count - wrong) as f64).ok()?.inverse_cdf(ALPHA);
    let stated = |tile: &Tile| Some((tile.error.value, tile.error.below(1.0 - beta).ok()?));
    let (mut values, mut bounds): (Vec<f64>, Vec<f64>) = tiles.iter().filter_map(stated).unzip();
    if bounds.len() < needed + wrong {
        let heavy = tiles.iter().any(|tile| tile.error.refusal() == Some(Refusal::HeavyTail));
        return Some(RelativeError::refused(if heavy { Refusal::HeavyTail } else { Refusal::TooNoisy }));
    }
    let nth = |values: &mut [f64]| *values.select_nth_unstable_by(needed + wrong - 1, f64::total_cmp).1;
    // The estimate and the bound are both the n-th smallest of all tiles, with the same n. So the estimate is never above the bound, and
    // it is 0 only if the bound is 0.
    let (value, bound) = (nth(&mut values), nth(&mut bounds));
    let spread = if bound > 0.0 { (bound / value).ln() / quantile(1.0 - ALPHA) } else { 0.0 };
    Some(RelativeError { value, spread, effective_pixels: f64::INFINITY })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tiles have all pixels once, and edges from 24 to 47 pixels unless the picture is smaller.
    #[test]
    fn tiles_are_a_partition() {
        for size in [UVec2::new(1, 1), UVec2::new(47, 48), UVec2::new(640, 363), UVec2::new(100, 79)] {
            let crop = Crop { min: UVec2::new(5, 7), max: UVec2::new(5, 7) + size };
            let mut count = vec![0; crop.pixel_count() as usize];
            for tile in tiles(crop) {
                let [short, long] = [tile.size().min_element(), tile.size().max_element()];
                assert!(short >= size.min_element().min(24) && long <= 47, "{tile:?} of {crop:?}");
                crop.rows(tile).flatten().for_each(|pixel| count[pixel] += 1);
            }
            assert!(count.iter().all(|n| *n == 1), "{size}");
        }
    }
}
