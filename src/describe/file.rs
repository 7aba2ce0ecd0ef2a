//! Opens files that a user named.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::Path;

use crate::reader::closest;
use crate::{Error, Fault, Result};

/// Opens a regular file, which messages call `name`. It checks the kind of file first: a pipe may block, a device may never end.
///
/// # Errors
/// `Invalid` for a file that is missing or not regular, `Io` for one that cannot be opened.
pub(super) fn open(path: &Path, name: &str) -> Result<File> {
    let invalid = |message: &str| Error::invalid(Fault::new(message).in_file(name));
    let refused = |error: io::Error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => invalid(&format!("no such file{}", neighbour(path, name))),
        ErrorKind::InvalidInput | ErrorKind::InvalidFilename => invalid("not a file name"),
        _ => Error::io(name, error),
    };
    if !path.metadata().map_err(refused)?.is_file() {
        return Err(invalid("not a regular file"));
    }
    File::open(path).map_err(refused)
}

/// Returns `, did you mean "scenes/cornell-box.json"?` if a file in the same folder has a similar name, and nothing otherwise.
///
/// - `name`: the file as messages call it, with the same last part as `path`
fn neighbour(path: &Path, name: &str) -> String {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let entries = folder.read_dir().into_iter().flatten().flatten().take(MOST_NEIGHBOURS);
    let names: Vec<String> = entries.filter(|e| e.path().is_file()).filter_map(|e| e.file_name().into_string().ok()).collect();
    let wanted = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let near = nearest(&wanted, &names).filter(|near| !near.contains(char::is_control));
    let shown = |near: &str| name.strip_suffix(wanted.as_str()).map(|before| format!("{before}{near}"));
    near.and_then(shown).map_or_else(String::new, |near| format!(", did you mean {near:?}?"))
}

/// The largest number of entries of a folder that are searched.
const MOST_NEIGHBOURS: usize = 10_000;

/// Finds the file that was probably meant.
///
/// Its stem differs from the wanted one by a typing error, and the extensions are equal or none was given; or only the extension
/// differs.
fn nearest<'n>(wanted: &str, names: &'n [String]) -> Option<&'n str> {
    let parts =
        |name: &str| name.rsplit_once('.').map_or((name.to_lowercase(), String::new()), |(a, b)| (a.to_lowercase(), b.to_lowercase()));
    let (stem, extension) = parts(wanted);
    if stem.is_empty() {
        return None;
    }
    let mut known: Vec<&str> = names.iter().map(String::as_str).collect();
    // A scene comes before the pictures that are named after it.
    known.sort_unstable_by_key(|name| (!name.ends_with(".json"), *name));
    let alike = || known.iter().copied().filter(|name| extension.is_empty() || parts(name).1 == extension);
    let stems: Vec<String> = alike().map(|name| parts(name).0).collect();
    let by_stem = closest(&stem, stems.iter().map(String::as_str));
    by_stem.and_then(|stem| alike().find(|name| parts(name).0 == stem)).or_else(|| known.iter().copied().find(|name| parts(name).0 == stem))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_in_a_name_finds_its_file() {
        let names = ["cornell-box.json", "cornell-box.exr", "metals.json", "pawn.ply", "A.PNG"].map(str::to_owned);
        for (wanted, expected) in [
            ("cornel-box.json", Some("cornell-box.json")),
            ("Cornell-Box.json", Some("cornell-box.json")),
            ("cornell-box", Some("cornell-box.json")),
            ("cornell-box.exr", Some("cornell-box.exr")),
            ("metal.json", Some("metals.json")),
            ("prawn.ply", Some("pawn.ply")),
            ("a.png", Some("A.PNG")),
            ("missing.json", None),
            ("pawn.obj", Some("pawn.ply")),
            ("link.ply", None),
            ("", None),
        ] {
            assert_eq!(nearest(wanted, &names), expected, "{wanted:?}");
        }
    }
}
