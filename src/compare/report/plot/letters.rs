//! Letters as outlines, for pictures of dots, and their widths.
//!
//! The font is Roboto, Latin and Greek only (Google, Apache License 2.0: `assets/roboto.txt`). What it lacks shows as its box.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, OutlinedGlyph, PxScale, ScaleFont, point};

use super::drawing::Spot;

static FONT: LazyLock<FontRef<'static>> =
    LazyLock::new(|| FontRef::try_from_slice(include_bytes!("../assets/roboto.ttf")).expect("the font of the crate is whole"));

/// `size` is that of the em square, as in CSS; the crate's scale is that of ascent and descent.
fn scale(size: f64) -> PxScale {
    let em = FONT.units_per_em().unwrap_or(1000.0);
    PxScale::from(size as f32 * FONT.height_unscaled() / em)
}

/// Glyphs and how far each moves the pen.
fn glyphs(text: &str, size: f64) -> impl Iterator<Item = (GlyphId, f64)> {
    let font = FONT.as_scaled(scale(size));
    text.chars().map(move |c| (font.glyph_id(c), f64::from(font.h_advance(font.glyph_id(c)))))
}

pub fn width(text: &str, size: f64) -> f64 {
    glyphs(text, size).map(|(_, advance)| advance).sum()
}

/// From `at` on the baseline to the right.
pub fn outlines(text: &str, at: Spot, size: f64) -> Vec<OutlinedGlyph> {
    let mut pen = at[0];
    let mut found = vec![];
    for (id, advance) in glyphs(text, size) {
        let glyph = id.with_scale_and_position(scale(size), point(pen as f32, at[1] as f32));
        found.extend(FONT.outline_glyph(glyph));
        pen += advance;
    }
    found
}
