//! Merging of parts, in any order.

use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::planes::chunk_pixels;
use super::{About, Job, Part, Stored};
use crate::error::memory::fallible;
use crate::error::{Error, Fault, Result};
use crate::film::{Film, MomentFilm, PixelSums, Wave};
use crate::measure::ErrorHistory;
use crate::render::{KEPT_INVALID, RenderReport};

/// Adds parts of one picture. The parts need not cover all samples. A part that is there twice, with the same numbers, counts once.
///
/// The pixels are added some at a time, so that no more than the sums and a little of each part is in memory.
///
/// # Errors
/// `Invalid` for parts of different pictures, and for samples that are in two of them; `Limit`; `Io`.
pub fn merge(parts: Vec<Stored>) -> Result<Part> {
    let (parts, copies) = without_copies(parts);
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
    let planned = parts.iter().map(|part| part.about.job.samples).max().unwrap_or(0);
    let about = About { job: Job { samples: planned, ..first.about.job.clone() }, ..first.about.clone() };
    let film = sum(&about, &blocks)?;
    // The checkpoints of a single render remain valid.
    let checkpoints = if parts.len() == 1 { first.history.checkpoints.clone() } else { vec![] };
    let history = ErrorHistory { checkpoints, ..first.history };
    Ok(Part { about, film, report: report(&parts), history, copies })
}

/// Leaves out parts that are there twice, as they come from jobs that ran twice, and returns their names.
fn without_copies(parts: Vec<Stored>) -> (Vec<Stored>, Vec<PathBuf>) {
    let (mut kept, mut copies): (Vec<Stored>, Vec<PathBuf>) = (vec![], vec![]);
    for part in parts {
        match kept.iter().any(|other| other.is_same(&part) && other.about.difference(&part.about).is_none()) {
            true => copies.push(part.path),
            false => kept.push(part),
        }
    }
    (kept, copies)
}

/// Chunks that each thread adds before the sums are put together.
const CHUNKS_PER_THREAD: usize = 4;

/// Adds blocks, which are in order, over the tree of their samples.
fn sum(about: &About, blocks: &[(Wave, &Stored, usize)]) -> Result<MomentFilm> {
    let (layout, pixels) = (about.layout(), about.crop.pixel_count() as usize);
    let each = chunk_pixels(layout.all());
    let chunks: Vec<Range<usize>> = (0..pixels).step_by(each).map(|start| start..pixels.min(start + each)).collect();
    let added = |chunk: &Range<usize>| -> Result<MomentFilm> {
        let mut film = about.film();
        blocks.iter().try_for_each(|(wave, part, block)| part.chunk(*block, chunk.clone()).map(|sums| film.add(*wave, sums)))?;
        Ok(film)
    };
    let mut sums: Vec<(Wave, Vec<f64>)> = vec![];
    for some in chunks.chunks(CHUNKS_PER_THREAD * rayon::current_num_threads()) {
        for film in some.par_iter().map(added).collect::<Result<Vec<_>>>()? {
            if sums.is_empty() {
                sums = film.blocks().map(|(wave, _)| Ok((wave, room(pixels * layout.all())?))).collect::<Result<_>>()?;
            }
            sums.iter_mut().zip(film.blocks()).for_each(|((_, sum), (_, block))| sum.extend(block.numbers()));
        }
    }
    let mut film = about.film();
    for (wave, numbers) in sums {
        film.add(wave, PixelSums::from_numbers(layout, numbers).ok_or_else(|| Error::Internal("a share of a pixel".into()))?);
    }
    Ok(film)
}

/// Memory for numbers.
fn room(numbers: usize) -> Result<Vec<f64>> {
    let mut room = vec![];
    let full = |_| Error::Limit(Fault::new("the sums of the parts do not fit into memory"));
    fallible(|| room.try_reserve_exact(numbers)).map_err(full)?;
    Ok(room)
}

/// Sum of the reports.
fn report(parts: &[Stored]) -> RenderReport {
    let mut sum = RenderReport::default();
    for Stored { report, .. } in parts {
        sum.samples += report.samples;
        sum.invalid = sum.invalid.saturating_add(report.invalid);
        sum.elapsed = sum.elapsed.saturating_add(report.elapsed);
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
    let unit = parts.first().map_or("samples", |part| part.about.allocation.unit());
    for pair in runs.windows(2) {
        let [(a, one), (b, other)] = pair else { continue };
        if b.start < a.end {
            let (end, one) = (a.end.min(b.end), one.display());
            let message = format!("{unit} {}..{end} are in {one} too", b.start);
            return Err(Error::invalid(Fault::new(message).in_file(other)));
        }
    }
    Ok(())
}
