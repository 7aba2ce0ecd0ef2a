//! Labels of numbers in a picture: a font of digits, three by five dots.

/// Pixels per dot.
const DOT: usize = 2;
/// Height of a line (pixels).
pub const HEIGHT: usize = 5 * DOT;
/// Distance from glyph to glyph, with the gap (pixels).
const ADVANCE: usize = 4 * DOT;

/// Glyphs as rows from the top, three bits each, the leftmost first.
const GLYPHS: [(char, [u8; 5]); 13] = [
    ('0', [0b111, 0b101, 0b101, 0b101, 0b111]),
    ('1', [0b010, 0b110, 0b010, 0b010, 0b111]),
    ('2', [0b111, 0b001, 0b111, 0b100, 0b111]),
    ('3', [0b111, 0b001, 0b111, 0b001, 0b111]),
    ('4', [0b101, 0b101, 0b111, 0b001, 0b001]),
    ('5', [0b111, 0b100, 0b111, 0b001, 0b111]),
    ('6', [0b111, 0b100, 0b111, 0b101, 0b111]),
    ('7', [0b111, 0b001, 0b010, 0b010, 0b010]),
    ('8', [0b111, 0b101, 0b111, 0b101, 0b111]),
    ('9', [0b111, 0b101, 0b111, 0b001, 0b111]),
    ('.', [0b000, 0b000, 0b000, 0b000, 0b010]),
    ('-', [0b000, 0b000, 0b111, 0b000, 0b000]),
    ('e', [0b000, 0b111, 0b111, 0b100, 0b111]),
];

/// Number with three significant digits.
pub fn short(x: f64) -> String {
    let fixed = x == 0.0 || (1e-3..1e4).contains(&x.abs());
    let text = if fixed { format!("{x:.*}", (2 - x.abs().max(1e-3).log10().floor() as i32).max(0) as usize) } else { format!("{x:.2e}") };
    if x == 0.0 { "0".into() } else { text }
}

/// Width of a text (pixels).
pub fn width(text: &str) -> usize {
    (text.chars().count() * ADVANCE).saturating_sub(DOT)
}

/// Calls `dot` for every pixel that a text covers, relative to its upper left corner.
pub fn write(text: &str, mut dot: impl FnMut(usize, usize)) {
    for (i, c) in text.chars().enumerate() {
        let Some((_, rows)) = GLYPHS.iter().find(|(glyph, _)| *glyph == c) else { continue };
        for (y, x) in (0..HEIGHT).flat_map(|y| (0..3 * DOT).map(move |x| (y, x))) {
            if rows[y / DOT] >> (2 - x / DOT) & 1 == 1 {
                dot(i * ADVANCE + x, y);
            }
        }
    }
}
