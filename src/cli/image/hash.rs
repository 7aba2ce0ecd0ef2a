//! `pt image hash FILE...`: one line each, as checksum programs print them.

use std::path::PathBuf;

use crate::cli::say;
use crate::error::Result;
use crate::output;

pub fn hash(files: &[PathBuf]) -> Result<()> {
    files.iter().try_for_each(|path| say(&format!("{}  {}\n", output::hash(&output::read(path)?.0), path.display())))
}
