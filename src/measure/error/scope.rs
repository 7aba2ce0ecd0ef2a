//! The pixels whose error a target asks for: the whole picture, a region of it, or most of its tiles.

use super::relative::RelativeError;
use super::tiles;
use crate::film::{Crop, MomentFilm};

/// Pixels whose error counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scope {
    /// All pixels.
    #[default]
    Picture,
    /// A rectangle within the film's crop. Its error is that of a picture of the rectangle alone: dark pixels count by the mean brightness
    /// of the rectangle.
    Region(Crop),
    /// Most of the [tiles](super::Tile), each by itself. Confidences must be 95 % or more.
    Tiles {
        /// Share of the tiles whose error must be at most the target, above 0 and below 1.
        share: f64,
    },
}

/// Smallest number of pixels that a region or a tile must have. With fewer the error is hardly ever established.
pub const FEWEST_PIXELS: u64 = 64;

impl Scope {
    /// Why no error of these pixels can be a target, in words that begin with the name of the option; `None` if it can.
    ///
    /// - `whole`: pixels of the picture
    /// - `splats`: whether paths bring light to other pixels than their own
    /// - `confidence`: of the target
    pub fn refusal(&self, whole: Crop, splats: bool, confidence: f64) -> Option<String> {
        let name = match self {
            Scope::Picture => return None,
            Scope::Region(_) => "region",
            Scope::Tiles { .. } => "tiles",
        };
        if splats {
            return Some(format!("{name}: expected an integrator whose paths bring light to their own pixel, such as nee"));
        }
        match *self {
            Scope::Region(region) if region.min.cmpge(region.max).any() || whole.intersection(region) != region => {
                let what = "expected X0 < X1 and Y0 < Y1 within the picture";
                Some(format!("{name} {region}: {what}, {whole}"))
            }
            Scope::Region(region) if region.pixel_count() < FEWEST_PIXELS => {
                Some(format!("{name} {region}: expected at least {FEWEST_PIXELS} pixels: fewer tell no error"))
            }
            Scope::Tiles { .. } if confidence < 0.95 => Some(format!("{name}: expected a confidence of 95 % or more")),
            Scope::Tiles { .. } if tiles::tiles(whole).any(|tile| tile.pixel_count() < FEWEST_PIXELS) => {
                let size = whole.size();
                Some(format!("{name}: a picture of {}×{} is too small: a tile needs at least {FEWEST_PIXELS} pixels", size.x, size.y))
            }
            _ => None,
        }
    }

    /// Relative error of these pixels; for tiles the error that the requested share of them does not exceed. `None` if the samples tell no
    /// error, or the pixels are black.
    ///
    /// Tests: a_region_has_the_error_of_its_crop, most_tiles_have_at_most_the_stated_error.
    pub fn error(&self, film: &MomentFilm) -> Option<RelativeError> {
        match self {
            Scope::Picture => RelativeError::of(film),
            Scope::Region(crop) => RelativeError::of(&film.cropped(*crop)),
            Scope::Tiles { share } => tiles::error_of_most(&tiles::tile_errors(film)?, *share),
        }
    }
}
