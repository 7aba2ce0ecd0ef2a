//! Functions that the tests of all dialects share: scenes in a folder, and the tables of docs/import.md.

use std::fs;
use std::path::Path;

use pt::build::{Built, Source};
use pt::describe;
use pt::import::{Imported, import};

const PAGE: &str = include_str!("../../../docs/import.md");

/// A folder with these files.
pub fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).expect("a file"));
    folder
}

/// The scene in a file, read and built.
pub fn built(path: &Path) -> pt::Result<(Imported, Built)> {
    let imported = import(path, false)?;
    let scene = describe::read(&imported.root, &imported.file)?;
    let built = pt::build::build(&scene, Source { root: &imported.root, file: &imported.file, files: &imported.files })?;
    Ok((imported, built))
}

/// Outcome of a construct: the first word of its row in the documentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Read without a note.
    Read,
    /// With a note.
    Approximated,
    Refused,
}

impl Outcome {
    pub fn of(scene: &Path) -> Outcome {
        match built(scene) {
            Err(pt::Error::Invalid(_)) => Outcome::Refused,
            Err(other) => panic!("{other}"),
            Ok((imported, _)) if imported.notes.is_empty() => Outcome::Read,
            Ok(_) => Outcome::Approximated,
        }
    }
}

/// The constructs of a dialect's section, with their documented outcomes.
pub fn table(dialect: &str) -> Vec<(String, Outcome)> {
    let (_, section) = PAGE.split_once(&format!("\n## {dialect}\n")).unwrap_or_else(|| panic!("a section on {dialect}"));
    let section = section.split("\n## ").next().unwrap_or_default();
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2);
    let outcome = |text: &str| match text.split([' ', ':', ';']).next() {
        Some("read") => Outcome::Read,
        Some("approximated") => Outcome::Approximated,
        Some("refused") => Outcome::Refused,
        _ => panic!("read, approximated or refused? {text}"),
    };
    rows.map(|row| {
        let (construct, becomes) = row.trim_matches('|').split_once(" | ").unwrap_or_else(|| panic!("two cells: {row}"));
        (construct.trim().to_owned(), outcome(becomes.trim()))
    })
    .collect()
}
