//! Reads [`MeshData`] from mesh files: OBJ, PLY and STL, recognised by content.
//!
//! To add a format, write a file beside `ply.rs`, a variant of `Format` with its first bytes and its extension, and an arm in
//! `read_as`.

mod obj;
mod obj_check;
mod ply;
mod ply_row;
pub mod points;
mod stl;
mod token;
mod write;

use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::file::open;
use crate::shape::mesh_data::MeshData;
use crate::{Error, Fault, Result};

/// What a mesh is read from: a file, or bytes in memory. The readers of formats take it as `&mut dyn Source`, and are compiled once.
trait Source: BufRead + Seek {}

impl<T: BufRead + Seek> Source for T {}

/// A mesh as the reader of one format returns it, before it is cleaned.
#[derive(Default)]
struct Found {
    mesh: MeshData,
    /// Sentences that begin with the file's name.
    warnings: Vec<String>,
    /// The number of normals in the file without a direction. They are zero in the mesh.
    directionless: usize,
}

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ. Its files have no characteristic first bytes.
    Obj,
    /// Polygon File Format, ASCII or binary.
    Ply,
    /// Stereolithography, ASCII or binary.
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

    /// The format of a file by the extension of its name.
    fn of_name(path: &Path) -> Option<Format> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        Format::ALL.into_iter().find(|format| format.extension() == extension)
    }
}

/// Reads, cleans and checks the mesh in a file. Returns it with warnings, which are sentences that begin with `name`.
///
/// The content decides the format (a PLY file begins with the line `ply`); where it does not, the extension does.
///
/// # Errors
/// [`Error::Invalid`] where the file is missing, not a regular file, of another format, malformed or without a
/// triangle; [`Error::Limit`] where it has more than 2³² − 1 vertices or triangles; [`Error::Io`] where it cannot be read.
pub fn load(path: &Path, name: &str) -> Result<(MeshData, Vec<String>)> {
    let mut file = BufReader::new(open(path, name)?);
    let content = format_of_content(&mut file).map_err(|e| Error::io(name, e))?;
    let mut warnings = Vec::new();
    let format = match (content, Format::of_name(path)) {
        (Format::Obj, None) => return Err(invalid(name, "unknown mesh format: expected an .obj, .ply or .stl file")),
        (Format::Obj, Some(Format::Ply)) => return Err(invalid(name, "not a PLY file: its first line is not \"ply\"")),
        // The STL reader gives the best message about a file that is no STL.
        (Format::Obj, Some(named)) => named,
        (content, named) => {
            if named != Some(content) {
                let title = content.extension().to_uppercase();
                warnings.push(format!("{name}: read as {title}, which its content says it is"));
            }
            content
        }
    };
    let (mesh, more) = read_as(format, &mut file, name)?;
    warnings.extend(more);
    Ok((mesh, warnings))
}

/// Reads a mesh as [`load`] does, from any source; for bytes in memory use `io::Cursor`. The content alone decides the format.
///
/// # Errors
/// Those of [`load`].
pub fn read(mut source: impl BufRead + Seek, name: &str) -> Result<(MeshData, Vec<String>)> {
    let content = format_of_content(&mut source).map_err(|e| Error::io(name, e))?;
    read_as(content, &mut source, name)
}

fn read_as(format: Format, source: &mut dyn Source, name: &str) -> Result<(MeshData, Vec<String>)> {
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

/// Recognises the format of a source as [`format_of`] does, and leaves the source at its beginning.
fn format_of_content(source: &mut dyn Source) -> io::Result<Format> {
    let mut start = Vec::new();
    (&mut *source).take(LOOK).read_to_end(&mut start)?;
    let size = source.seek(SeekFrom::End(0))?;
    source.rewind()?;
    Ok(format_of(&start, size))
}

/// The number of bytes at the beginning of a file that are read to recognise its format.
const LOOK: u64 = 1 << 10;

/// Recognises the format of a file that begins with `start` and has `size` bytes: PLY where the first line is `ply`, STL where the size
/// or the first words fit, and otherwise OBJ, whose files have no characteristic first bytes.
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
