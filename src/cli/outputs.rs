//! Checks of output files, before any work is done.

use std::path::{Path, PathBuf};

use std::io::{IsTerminal, stdout};

use crate::error::{Error, Result};
use crate::film::MomentFilm;
use crate::measure::ErrorHistory;
use crate::output::{self, Format};
use crate::part::{self, About};
use crate::render::RenderReport;

/// Kinds of files that a command can write.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum OutputKinds {
    Pictures,
    Parts,
    Both,
}

impl OutputKinds {
    fn accept(self, path: &Path) -> bool {
        self != OutputKinds::Parts && Format::of(path).is_some() || self != OutputKinds::Pictures && is_part(path)
    }

    fn names(self) -> String {
        match self {
            OutputKinds::Pictures => Format::EXTENSIONS.into(),
            OutputKinds::Parts => ".ptc: some samples of each pixel are no picture yet".into(),
            OutputKinds::Both => format!("{}, or .ptc", Format::EXTENSIONS),
        }
    }
}

/// Returns whether a name is that of a part of a render; `-` is one on stdout.
pub fn is_part(path: &Path) -> bool {
    is_pipe(path) || path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ptc"))
}

/// Returns whether a name stands for stdout, or stdin.
pub fn is_pipe(path: &Path) -> bool {
    path == Path::new("-")
}

/// Writes a part to a file, or to stdout.
///
/// # Errors
/// `Io`.
pub fn write_part(path: &Path, about: &About, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) -> Result<()> {
    match is_pipe(path) {
        true => part::write_to(stdout().lock(), "stdout", about, film, report, history),
        false => part::write(path, about, film, report, history),
    }
}

/// Checks that results can be written under these names.
///
/// - `inputs`: files that must not be overwritten; `is_input` describes them: `is the scene file`
///
/// # Errors
/// `Usage` for a name given twice, an unknown extension, a folder, an input, and a part on a terminal; `Io` if the folder is missing or read-only.
pub fn check_outputs(outputs: &[PathBuf], kinds: OutputKinds, inputs: &[&Path], is_input: &str) -> Result<()> {
    for (i, path) in outputs.iter().enumerate() {
        let usage = |message: &str| Error::Usage(format!("{}: {message}", path.display()));
        if outputs[..i].iter().any(|other| is_same_file(other, path)) {
            return Err(usage("given twice as an output"));
        }
        if !kinds.accept(path) {
            return Err(usage(&format!("expected a name that ends in {}", kinds.names())));
        }
        if is_pipe(path) {
            match stdout().is_terminal() {
                true => return Err(usage("a part of a render (.ptc) on stdout, which is a terminal")),
                false => continue,
            }
        }
        if path.is_dir() {
            return Err(usage("is a folder, expected a file"));
        }
        let is = |input: &Path| path.canonicalize().is_ok_and(|path| input.canonicalize().is_ok_and(|input| path == input));
        if inputs.iter().any(|input| is(input)) {
            return Err(usage(&format!("{is_input}, which would be overwritten")));
        }
        output::check_folder(path)?;
    }
    Ok(())
}

/// Returns whether two outputs, which need not exist yet, are the same file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    let [a, b] = [a, b].map(|path| output::target(path).unwrap_or(path.to_owned()));
    let folder = |path: &Path| output::folder(path).canonicalize().ok();
    a.file_name() == b.file_name() && folder(&a) == folder(&b)
}
