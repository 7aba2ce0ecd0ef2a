//! `pt image hash FILE...`: prints a line per file, as checksum programs do.

use std::path::PathBuf;

use crate::cli::print_stdout;
use crate::error::Result;
use crate::output;

/// Runs the command.
pub fn hash(files: &[PathBuf]) -> Result<()> {
    files.iter().try_for_each(|path| print_stdout(&format!("{}  {}\n", output::hash(&output::read(path)?.0), path.display())))
}
