//! Mesh files: OBJ, PLY and STL, by content, to [`MeshData`].
//!
//! To add a format: a file beside `ply.rs`, a variant in `Format`, its first bytes and its extension below, an arm in `read_as`.

mod obj;
mod obj_check;
mod ply;
mod ply_row;
mod stl;
mod token;
mod write;

use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::file::open;
use crate::shape::mesh_data::MeshData;
use crate::{Error, Fault, Result};

/// What a reader of one format found, before cleaning.
#[derive(Default)]
struct Found {
    mesh: MeshData,
    /// Sentences that begin with the file's name.
    warnings: Vec<String>,
    /// Normals of the file that gave no direction; the mesh has zeros for them.
    directionless: usize,
}

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, which nothing marks.
    Obj,
    Ply,
    Stl,
}

impl Format {
    const ALL: [Format; 3] = [Format::Obj, Format::Ply, Format::Stl];

    fn extension(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
        }
    }

    /// The format that a file's name tells of.
    fn of_name(path: &Path) -> Option<Format> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        Format::ALL.into_iter().find(|format| format.extension() == extension)
    }
}

/// Reads, cleans and checks the mesh in a file; returns it with warnings, sentences that begin with `name`.
///
/// The content decides the format (a PLY file begins with the line `ply`), then the extension.
///
/// # Errors
/// [`Error::Invalid`] where the file is missing, not a regular file, of another format, malformed or without a
/// triangle; [`Error::Limit`] where it holds more than pt can number; [`Error::Io`] where it cannot be read.
pub fn load(path: &Path, name: &str) -> Result<(MeshData, Vec<String>)> {
    let mut file = BufReader::new(open(path, name)?);
    let content = format_of_content(&mut file).map_err(|e| Error::io(name, e))?;
    let mut warnings = Vec::new();
    let format = match (content, Format::of_name(path)) {
        (Format::Obj, None) => return Err(invalid(name, "unknown mesh format: expected an .obj, .ply or .stl file")),
        (Format::Obj, Some(Format::Ply)) => return Err(invalid(name, "not a PLY file: its first line is not \"ply\"")),
        // Its reader tells best what an STL lacks.
        (Format::Obj, Some(named)) => named,
        (content, named) => {
            if named != Some(content) {
                let title = content.extension().to_uppercase();
                warnings.push(format!("{name}: read as {title}, which its content says it is"));
            }
            content
        }
    };
    let (mesh, more) = read_as(format, file, name)?;
    warnings.extend(more);
    Ok((mesh, warnings))
}

/// As [`load`], from any source (bytes in memory: `io::Cursor`).
pub fn read(mut source: impl BufRead + Seek, name: &str) -> Result<(MeshData, Vec<String>)> {
    let content = format_of_content(&mut source).map_err(|e| Error::io(name, e))?;
    read_as(content, source, name)
}

fn read_as(format: Format, source: impl BufRead + Seek, name: &str) -> Result<(MeshData, Vec<String>)> {
    let found = match format {
        Format::Obj => obj::read(source, name)?,
        Format::Ply => ply::read(source, name)?,
        Format::Stl => stl::read(source, name)?,
    };
    let mut warnings = found.warnings;
    let (mesh, more) = found.mesh.usable(found.directionless, name)?;
    warnings.extend(more);
    Ok((mesh, warnings))
}

/// As [`format_of`]; leaves the source at its beginning.
fn format_of_content(source: &mut (impl BufRead + Seek)) -> io::Result<Format> {
    let mut start = Vec::new();
    source.by_ref().take(LOOK).read_to_end(&mut start)?;
    let size = source.seek(SeekFrom::End(0))?;
    source.rewind()?;
    Ok(format_of(&start, size))
}

/// So much of a file is looked at to recognise it (bytes).
const LOOK: u64 = 1 << 10;

/// The format of a file that begins with `start` and has `size` bytes: PLY where its first line is `ply`, STL where its size or its
/// first words say so, else OBJ, which nothing marks.
pub fn format_of(start: &[u8], size: u64) -> Format {
    if matches!(&start[..start.len().min(4)], b"ply\n" | b"ply\r" | b"ply " | b"ply") {
        Format::Ply
    } else if stl::is(&start[..start.len().min(LOOK as usize)], size) {
        Format::Stl
    } else {
        Format::Obj
    }
}

fn invalid(name: &str, message: impl Into<String>) -> Error {
    Error::invalid(Fault::new(message).in_file(name))
}
