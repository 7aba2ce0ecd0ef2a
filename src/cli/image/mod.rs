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
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let exponent = x.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) { format!("{x:.*}", (5 - exponent) as usize) } else { format!("{x:.5e}") }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_six_digits() {
        let table = [(0.0, "0"), (1.0, "1.00000"), (-12.5, "-12.5000"), (1e-5, "1.00000e-5"), (123_456.7, "123457"), (1.5e9, "1.50000e9")];
        for (x, text) in table {
            assert_eq!(number(x), text);
        }
        assert_eq!((number(f64::INFINITY).as_str(), number(f64::NAN).as_str()), ("inf", "NaN"));
    }
}
