//! Words of a text file: parses numbers, and makes names and words printable.

/// Parses a finite number in the range of `f32`.
pub fn finite(word: &str) -> Result<f32, String> {
    let value = number(word)?;
    let is_written_finite = || !word.contains(['n', 'N', '#']);
    match value.is_finite() {
        true => Ok(value),
        false if is_written_finite() => Err(format!("{} is beyond the range of f32", shown(word))),
        false => Err(format!("{} is not a finite number", shown(word))),
    }
}

/// Parses a number. The ways in which C libraries write NaN and infinity (`-1.#IND00`, `nan(ind)`) become NaN.
pub fn number(word: &str) -> Result<f32, String> {
    let is_no_number = || {
        let lower = word.to_ascii_lowercase();
        ["#ind", "#inf", "#qnan", "#snan", "nan("].iter().any(|mark| lower.contains(mark))
    };
    match word.parse() {
        Ok(value) => Ok(value),
        Err(_) if is_no_number() => Ok(f32::NAN),
        Err(_) => Err(format!("expected a number, found {}", shown(word))),
    }
}

/// A name with its control characters replaced by U+FFFD.
pub fn name(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

/// A word for a message, cut to 40 characters.
pub fn shown(word: &str) -> String {
    match word.char_indices().nth(40) {
        Some((end, _)) => name(&word[..end]) + "…",
        None => name(word),
    }
}
