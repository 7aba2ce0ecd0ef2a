//! Report of a comparison: numbers for programs, plots for papers, and a page for people.
//!
//! To add a plot: a file in `plot/`, a row in `plot::ALL`.

mod embedded_difference;
mod jeri;
mod names;
mod page;
mod pictures;
mod plot;
mod table;

use std::path::{Path, PathBuf};

pub use page::waiting;
pub use plot::{last_error, slope};

use page::Place;

use super::Comparison;
use crate::error::{Error, Result};
use crate::output;

/// Files to write, in this order, with their paths inside the report's folder.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// Writes the report into `folder`, which is created if it is missing:
///
/// - `convergence.csv`, `convergence.json`: every measurement, the statistics over the replicates, and the formulas
/// - `plots/*.svg`, `plots/*.png`
/// - `index.html`: table, plots and pictures in one file that needs no server and no network
/// - with `jeri`, `jeri/`: EXR pictures and the tree `data.js`, `data.json` for the JERI viewer
///
/// Everything is made in memory first. Each file appears whole, and the page is written last.
///
/// # Errors
/// `Io` if the system refuses; `Internal` for pictures that do not have the reference's size.
pub fn write(comparison: &Comparison, folder: &Path, jeri: bool) -> Result<()> {
    same_size(comparison)?;
    let mut files: Files = vec![("convergence.csv".into(), table::csv(comparison)), ("convergence.json".into(), table::json(comparison)?)];
    files.extend(plot::files(comparison)?);
    if jeri {
        files.extend(jeri::files(comparison)?);
    }
    files.push(("index.html".into(), page::html(comparison, Place::Folder)?.into_bytes()));
    for (name, bytes) in &files {
        let path = folder.join(name);
        let parent = output::folder(&path);
        std::fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
        output::replace(&path, bytes)?;
    }
    Ok(())
}

/// HTML page of a comparison that is still running, or has just ended: the page of the report, with a display of the progress.
///
/// - `version`: number of this page among those that show the comparison
/// - `is_last`: whether the comparison is over; the pages before have no FLIP
///
/// # Errors
/// `Internal` for pictures that do not have the reference's size.
pub fn live(comparison: &Comparison, version: u64, is_last: bool) -> Result<String> {
    same_size(comparison)?;
    page::html(comparison, Place::Live { version, is_last })
}

fn same_size(comparison: &Comparison) -> Result<()> {
    let size = comparison.reference.image.size;
    for method in &comparison.methods {
        let snapshots = method.snapshots.iter().map(|snapshot| &snapshot.image);
        for image in [&method.image, &method.sample].into_iter().chain(snapshots) {
            if image.size != size {
                let text = format!("the picture of {} is {}, its reference {}", method.name, image.size, size);
                return Err(Error::Internal(text));
            }
        }
    }
    Ok(())
}
