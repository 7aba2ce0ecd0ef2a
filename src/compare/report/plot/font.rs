//! Outlines of text for raster pictures, and text widths.
//!
//! The font is Roboto, Latin and Greek only (Google, Apache License 2.0: `assets/roboto.txt`). Missing glyphs show as a box.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, OutlinedGlyph, PxScale, ScaleFont, point};

use super::drawing::Point;

static FONT: LazyLock<FontRef<'static>> =
    LazyLock::new(|| FontRef::try_from_slice(include_bytes!("../assets/roboto.ttf")).expect("the font of the crate is whole"));

/// Converts a size of the em square, as CSS has it, to the crate's scale, which is that of ascent and descent.
fn scale(size: f64) -> PxScale {
    let em = FONT.units_per_em().unwrap_or(1000.0);
    PxScale::from(size as f32 * FONT.height_unscaled() / em)
}

/// Glyphs of a text with their advance widths.
fn glyphs(text: &str, size: f64) -> impl Iterator<Item = (GlyphId, f64)> {
    let font = FONT.as_scaled(scale(size));
    text.chars().map(move |c| (font.glyph_id(c), f64::from(font.h_advance(font.glyph_id(c)))))
}

/// Width of a text.
pub fn width(text: &str, size: f64) -> f64 {
    glyphs(text, size).map(|(_, advance)| advance).sum()
}

/// Width of a text in any font that the reader may have: common fonts are at most a fifth wider than the one that is measured.
pub fn width_in_any_font(text: &str, size: f64) -> f64 {
    1.2 * width(text, size)
}

/// Outlines of a text that starts at `at` on the baseline.
pub fn outlines(text: &str, at: Point, size: f64) -> Vec<OutlinedGlyph> {
    let mut pen = at[0];
    let mut found = vec![];
    for (id, advance) in glyphs(text, size) {
        let glyph = id.with_scale_and_position(scale(size), point(pen as f32, at[1] as f32));
        found.extend(FONT.outline_glyph(glyph));
        pen += advance;
    }
    found
}
