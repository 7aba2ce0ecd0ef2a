//! Reads tables of lenses, in the form of pbrt's lens files.

use crate::camera::realistic::LensTable;
use crate::{Error, Fault, Result};

/// Reads the surfaces of a lens, a row on each line: radius of curvature, thickness, index of refraction, diameter. What follows a `#`
/// is a comment.
///
/// # Errors
/// `Invalid` where a line has no four numbers, or the rows describe no lens ([`LensTable::new`]).
pub fn read(content: &[u8], name: &str) -> Result<LensTable> {
    let refused = |line: Option<usize>, message: String| {
        let fault = Fault::new(message).in_file(name);
        Error::invalid(line.map_or(fault.clone(), |line| fault.at_line(line)))
    };
    let text = String::from_utf8_lossy(content);
    let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.split('#').next().unwrap_or_default().trim()));
    let mut rows = vec![];
    for (line, row) in lines.filter(|(_, row)| !row.is_empty()) {
        let numbers: Option<Vec<f64>> = row.split_whitespace().map(|word| word.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| <[f64; 4]>::try_from(numbers).ok());
        let expected = "expected four numbers: radius of curvature, thickness, index of refraction, diameter";
        rows.push((line, numbers.ok_or_else(|| refused(Some(line), expected.to_owned()))?));
    }
    let (lines, rows): (Vec<usize>, Vec<[f64; 4]>) = rows.into_iter().unzip();
    LensTable::new(&rows).map_err(|fault| refused(fault.row.map(|row| lines[row]), fault.message))
}
