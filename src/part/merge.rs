//! Merging of parts, in any order.

use std::ops::Range;
use std::path::Path;

use super::{Part, Stored};
use crate::error::{Error, Fault, Result};
use crate::film::{Film, MomentFilm, Wave};
use crate::measure::ErrorHistory;
use crate::render::{KEPT_INVALID, RenderReport};

/// Adds parts of one picture. The parts need not cover all samples.
///
/// Blocks are read one at a time in the order of their samples, so that only one is in memory in addition to the sums.
///
/// # Errors
/// `Invalid` for parts of different pictures, and for samples that are in two of them; `Limit`; `Io`.
pub fn merge(parts: Vec<Stored>) -> Result<Part> {
    let first = parts.first().ok_or_else(|| Error::Usage("expected parts to merge".into()))?;
    for other in &parts[1..] {
        if let Some(difference) = other.about.difference(&first.about) {
            let message = format!("not of the same picture as {}: {difference}", first.path.display());
            return Err(Error::invalid(Fault::new(message).in_file(&other.path)));
        }
    }
    refuse_overlaps(&parts)?;
    let mut blocks: Vec<(Wave, &Stored, usize)> =
        parts.iter().flat_map(|part| part.waves().iter().enumerate().map(move |(i, wave)| (*wave, part, i))).collect();
    blocks.sort_by_key(|(wave, ..)| wave.first);
    let mut films: Vec<MomentFilm> = vec![];
    for (wave, part, index) in blocks {
        if films.last().is_none_or(|film| film.range().end != wave.first) {
            films.push(first.about.film());
        }
        if let Some(film) = films.last_mut() {
            film.add(wave, part.block(index)?);
        }
    }
    // The checkpoints of a single render remain valid.
    let checkpoints = if parts.len() == 1 { first.history.checkpoints.clone() } else { vec![] };
    let history = ErrorHistory { checkpoints, ..first.history };
    Ok(Part { about: first.about.clone(), films, report: report(&parts), history })
}

/// Sum of the reports.
fn report(parts: &[Stored]) -> RenderReport {
    let mut sum = RenderReport::default();
    for Stored { report, .. } in parts {
        sum.samples += report.samples;
        sum.invalid += report.invalid;
        sum.elapsed += report.elapsed;
        sum.first_invalid.extend(&report.first_invalid);
    }
    sum.first_invalid.sort_unstable_by_key(|id| (id.index, id.pixel));
    sum.first_invalid.truncate(KEPT_INVALID);
    sum
}

/// Fails if samples are in two parts.
fn refuse_overlaps(parts: &[Stored]) -> Result<()> {
    let mut runs: Vec<(Range<u64>, &Path)> =
        parts.iter().flat_map(|part| part.ranges().into_iter().map(|run| (run, part.path.as_path()))).collect();
    runs.sort_by_key(|(run, _)| (run.start, run.end));
    for pair in runs.windows(2) {
        let [(a, one), (b, other)] = pair else { continue };
        if b.start < a.end {
            let (end, one) = (a.end.min(b.end), one.display());
            let message = format!("samples {}..{end} are in {one} too", b.start);
            return Err(Error::invalid(Fault::new(message).in_file(other)));
        }
    }
    Ok(())
}
