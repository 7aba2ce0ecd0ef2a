//! Saved progress: `.ptc` files.

use std::fs;
use std::path::Path;

use pt::math::hash::Hasher;
use pt::part::{Stored, merge as sum};

use super::judged;

/// A file as it is, and with the checksum that would fit it, without which hardly a change gets far.
pub fn merge(at: &Path, bytes: &[u8]) -> Result<bool, String> {
    let is_read = merge_file(at, bytes)?;
    let mut fitting = bytes.to_vec();
    if let Some(end) = fitting.len().checked_sub(16).filter(|end| *end >= 12) {
        let mut sum = Hasher::default();
        sum.bytes(&fitting[..end]);
        fitting[end..].copy_from_slice(&sum.finish().0.to_le_bytes());
    }
    Ok(merge_file(at, &fitting)? && is_read)
}

fn merge_file(at: &Path, bytes: &[u8]) -> Result<bool, String> {
    let path = at.join("a.ptc");
    fs::write(&path, bytes).expect("write");
    let Some(stored) = judged(Stored::open(&path))? else { return Ok(false) };
    stored.ranges();
    let Some(part) = judged(sum(vec![stored]))? else { return Ok(false) };
    let _ = part.whole();
    part.film.image();
    Ok(true)
}
