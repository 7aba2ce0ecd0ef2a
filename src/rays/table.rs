//! Tables of numbers, such as rays and points: one row in each line.

use crate::error::Fault;

/// The lines of a table, `N` numbers each, with commas or spaces between. A first line with words is a heading; empty lines and those that
/// begin with # are left out.
///
/// # Errors
/// A fault with the line, for anything else.
pub fn rows<const N: usize>(text: &str) -> Result<Vec<[f64; N]>, Fault> {
    let mut rows = vec![];
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#')) {
        let words: Vec<&str> = line.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty()).collect();
        let values: Option<Vec<f64>> = words.iter().map(|word| word.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        let is_heading = rows.is_empty() && words.iter().all(|word| word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '"'));
        match values.as_deref().map(<[f64; N]>::try_from) {
            Some(Ok(row)) => rows.push(row),
            None if is_heading => {}
            _ => return Err(Fault::new(format!("found {:?}, expected {N} numbers", line.trim())).at_line(k + 1)),
        }
    }
    Ok(rows)
}
