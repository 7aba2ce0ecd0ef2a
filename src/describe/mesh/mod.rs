//! Mesh files: OBJ and PLY, by content, to [`MeshData`].
//!
//! To add a format: a file beside `ply.rs`, a variant in `Format`, its first bytes and its extension below, an arm in `read_as`.

mod obj;
mod obj_check;
mod ply;
mod ply_row;
mod token;
mod write;

use std::io::{self, BufRead, BufReader, Read, Seek};
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

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Obj,
    Ply,
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
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let extension_says = match extension.as_str() {
        "obj" => Some(Format::Obj),
        "ply" => Some(Format::Ply),
        _ => None,
    };
    let mut warnings = Vec::new();
    match (content, extension_says) {
        (Format::Obj, None) => {
            return Err(invalid(name, "unknown mesh format: expected an .obj file, or a .ply file that begins with the line \"ply\""));
        }
        (Format::Obj, Some(Format::Ply)) => return Err(invalid(name, "not a PLY file: its first line is not \"ply\"")),
        (Format::Ply, Some(Format::Obj) | None) => warnings.push(format!("{name}: read as PLY, which its first line says it is")),
        _ => {}
    }
    let (mesh, more) = read_as(content, file, path.parent(), name)?;
    warnings.extend(more);
    Ok((mesh, warnings))
}

/// As [`load`], from any source (bytes in memory: `io::Cursor`); libraries of materials are not looked for.
pub fn read(mut source: impl BufRead + Seek, name: &str) -> Result<(MeshData, Vec<String>)> {
    let content = format_of_content(&mut source).map_err(|e| Error::io(name, e))?;
    read_as(content, source, None, name)
}

fn read_as(format: Format, source: impl BufRead + Seek, beside: Option<&Path>, name: &str) -> Result<(MeshData, Vec<String>)> {
    let found = match format {
        Format::Obj => obj::read(source, beside, name)?,
        Format::Ply => ply::read(source, name)?,
    };
    let mut warnings = found.warnings;
    let (mesh, more) = found.mesh.usable(found.directionless, name)?;
    warnings.extend(more);
    Ok((mesh, warnings))
}

/// PLY where the first line is `ply`, else OBJ (which has no magic); leaves the source at its beginning.
fn format_of_content(source: &mut (impl BufRead + Seek)) -> io::Result<Format> {
    let mut start = Vec::new();
    source.by_ref().take(4).read_to_end(&mut start)?;
    source.rewind()?;
    Ok(if matches!(&start[..], b"ply\n" | b"ply\r" | b"ply " | b"ply") { Format::Ply } else { Format::Obj })
}

fn invalid(name: &str, message: impl Into<String>) -> Error {
    Error::invalid(Fault::new(message).in_file(name))
}
