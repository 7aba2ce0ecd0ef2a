//! `pt image`: pictures compared, looked into, converted. One file per verb.

pub mod args;
mod average;
mod convert;
mod diff;
mod falsecolor;
mod hash;
mod info;
mod label;

use std::path::Path;
use std::process::ExitCode;

use crate::error::{Error, Fault, Result};
use crate::film::Image;
use crate::measure::words;
use crate::output::{self, Pick};
use args::Verb;

pub fn image(verb: &Verb) -> Result<ExitCode> {
    match verb {
        Verb::Diff(args) => return diff::diff(args),
        Verb::Info { files } => info::info(files)?,
        Verb::Hash { files } => hash::hash(files)?,
        Verb::Convert(args) => convert::convert(args)?,
        Verb::Average(args) => average::average(args)?,
        Verb::Falsecolor(args) => falsecolor::falsecolor(args)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// A picture file, and what was picked of it.
fn picked(path: &Path, pick: &Pick) -> Result<Image> {
    only(pick, &output::read(path)?.0, path)
}

fn only(pick: &Pick, image: &Image, path: &Path) -> Result<Image> {
    pick.of(image).map_err(|message| Error::invalid(Fault::new(message).in_file(path)))
}

/// Six digits that count.
fn number(x: f64) -> String {
    words::number(x, 6)
}
