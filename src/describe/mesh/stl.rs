//! STL files, binary or ASCII: triangles that each have their own corners. The file's normals are ignored, since the corners give them.
//!
//! A binary file has a header of 80 bytes, the number of triangles (u32), and for each triangle twelve f32 (normal, then corners) and
//! two bytes. Many binary files begin with `solid` as ASCII files do, so that the size decides. (The crate stl_io decides by that
//! word, and its messages have no line numbers.)

use std::collections::HashMap;
use std::io::{BufRead, Read, SeekFrom};

use glam::Vec3;

use super::Source;
use super::token::{finite, shown};
use super::{Found, invalid};
use crate::shape::mesh_data::MeshPart;
use crate::{Error, Fault, Result};

/// The size of the binary header with the number of triangles, in bytes.
const HEADER: u64 = 84;
/// The size of each triangle in a binary file, in bytes.
const ROW: usize = 50;

/// Whether a file that begins with `start` and has `size` bytes is an STL.
pub fn is(start: &[u8], size: u64) -> bool {
    let text = start.to_ascii_lowercase();
    let has = |word: &[u8]| text.windows(word.len()).any(|bytes| bytes == word);
    is_binary(start, size) || is_solid(start) && (has(b"facet") || has(b"endsolid"))
}

/// Whether the size of the file fits the number of triangles in its binary header.
fn is_binary(start: &[u8], size: u64) -> bool {
    count(start).is_some_and(|count| HEADER + u64::from(count) * ROW as u64 == size)
}

fn count(start: &[u8]) -> Option<u32> {
    start.get(80..84)?.try_into().ok().map(u32::from_le_bytes)
}

fn is_solid(start: &[u8]) -> bool {
    let words = start.trim_ascii_start();
    words.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && words.get(5).is_none_or(u8::is_ascii_whitespace)
}

/// Reads an STL file.
///
/// # Errors
/// [`Error::Invalid`] with the line (ASCII) or the triangle's number; [`Error::Limit`] beyond 2³² − 1 vertices; [`Error::Io`] where the
/// source cannot be read.
pub(super) fn read(source: &mut dyn Source, name: &str) -> Result<Found> {
    let io = |e| Error::io(name, e);
    let size = source.seek(SeekFrom::End(0)).map_err(io)?;
    source.rewind().map_err(io)?;
    let mut start = vec![];
    (&mut *source).take(HEADER).read_to_end(&mut start).map_err(io)?;
    let mut corners = Corners { found: Found::default(), known: HashMap::new(), name };
    if is_solid(&start) && !is_binary(&start, size) {
        source.rewind().map_err(io)?;
        read_ascii(source, name, &mut corners)?;
    } else {
        read_binary(source, &start, size, &mut corners)?;
    }
    corners.finish()
}

fn read_binary(source: &mut dyn Source, start: &[u8], size: u64, corners: &mut Corners) -> Result<()> {
    let name = corners.name;
    let Some(count) = count(start) else { return Err(invalid(name, "no STL: neither \"solid\" nor a binary header of 84 bytes")) };
    let follow = size.saturating_sub(HEADER);
    if follow < u64::from(count) * ROW as u64 {
        return Err(invalid(
            name,
            format!("no whole STL: the header promises {count} triangles of {ROW} bytes, but {follow} bytes follow"),
        ));
    }
    for i in 0..count {
        let mut row = [0; ROW];
        source.read_exact(&mut row).map_err(|e| Error::io(name, e))?;
        let (numbers, _) = row[12..48].as_chunks::<4>();
        let numbers: [f32; 9] = std::array::from_fn(|k| f32::from_le_bytes(numbers[k]));
        if let Some(wrong) = numbers.iter().find(|x| !x.is_finite()) {
            return Err(invalid(name, format!("triangle {i}: a coordinate that is not finite ({wrong})")));
        }
        let (places, _) = numbers.as_chunks::<3>();
        corners.add([places[0], places[1], places[2]].map(Vec3::from))?;
    }
    if follow > u64::from(count) * ROW as u64 {
        corners.found.warnings.push(format!("{name}: data after the last triangle ignored"));
    }
    Ok(())
}

/// Reads the ASCII form: `vertex x y z`, three for each `facet`, in upper or lower case.
fn read_ascii(source: &mut dyn Source, name: &str, corners: &mut Corners) -> Result<()> {
    let mut open = vec![];
    for (i, line) in source.lines().enumerate() {
        let fault = |message: String| Error::invalid(Fault::new(message).in_file(name).at_line(i + 1));
        let line = match line {
            Ok(line) => line,
            Err(e) if e.kind() == std::io::ErrorKind::InvalidData => return Err(fault("not UTF-8".to_owned())),
            Err(e) => return Err(Error::io(name, e)),
        };
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words.first().map(|word| word.to_ascii_lowercase()).as_deref() {
            Some("vertex") => open.push(vertex(&words[1..]).map_err(fault)?),
            Some("endfacet") => {
                let triangle = <[Vec3; 3]>::try_from(std::mem::take(&mut open));
                corners.add(triangle.map_err(|found| fault(format!("a facet of {} vertices, expected 3", found.len())))?)?;
            }
            None | Some("solid" | "facet" | "outer" | "endloop" | "endsolid") => {}
            Some(_) => return Err(fault(format!("expected facet, vertex or endsolid, found {}", shown(words[0])))),
        }
    }
    if open.is_empty() { Ok(()) } else { Err(invalid(name, "the file ends within a facet")) }
}

fn vertex(words: &[&str]) -> Result<Vec3, String> {
    let &[x, y, z] = words else { return Err(format!("a vertex of {} numbers, expected x, y and z", words.len())) };
    Ok(Vec3::new(finite(x)?, finite(y)?, finite(z)?))
}

/// Collects triangles, and merges equal corners to one vertex.
struct Corners<'n> {
    found: Found,
    /// The index of each vertex, by the bits of its position.
    known: HashMap<[u32; 3], u32>,
    name: &'n str,
}

impl Corners<'_> {
    fn add(&mut self, places: [Vec3; 3]) -> Result<()> {
        let positions = &mut self.found.mesh.positions;
        let vertices = places.map(|p| {
            // Adding 0 turns −0 into 0.
            *self.known.entry((p + 0.0).to_array().map(f32::to_bits)).or_insert_with(|| {
                positions.push(p);
                (positions.len() - 1) as u32
            })
        });
        self.found.mesh.triangles.push(vertices);
        if u32::try_from(self.found.mesh.triangles.len().max(self.found.mesh.positions.len())).is_err() {
            return Err(Error::Limit(Fault::new("more than 2^32 - 1 vertices or triangles").in_file(self.name)));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Found> {
        if self.found.mesh.triangles.is_empty() {
            return Err(invalid(self.name, "no faces"));
        }
        self.found.mesh.parts = vec![MeshPart { triangles: 0..self.found.mesh.triangles.len() as u32, ..MeshPart::default() }];
        Ok(self.found)
    }
}
