//! PLY files, ASCII or binary in either byte order, read with the crate ply-rs-bw.
//!
//! Two elements are read: `vertex` with x y z, [nx ny nz], [u v | s t | texture_u texture_v] and `[red green blue [alpha]]`; and `face`
//! with a list `vertex_indices` or `vertex_index`. Polygons become fans of triangles, which is right for convex polygons. Messages
//! count elements from 0, as indices do.

use std::io::{self, BufRead, ErrorKind, Read, SeekFrom};

use glam::{Vec2, Vec3, Vec4};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};

use super::Source;
use super::ply_row::{Row, full_channel, is_indices, slots};
use super::{Found, invalid};
use crate::format::decoded;
use crate::shape::mesh_data::MeshPart;
use crate::{Error, Fault, Result};

/// The longest header, in bytes.
const MAX_HEADER: u64 = 1 << 20;

/// Reads a PLY file.
///
/// # Errors
/// [`Error::Invalid`] with the line (ASCII) or the element's number; [`Error::Limit`] beyond 2³² − 1 elements; [`Error::Io`] where the
/// source cannot be read. A header that promises more than the file can hold is refused before memory is allocated for it.
pub(super) fn read(source: &mut dyn Source, name: &str) -> Result<Found> {
    let (header, mut body) = opened(source, name, &["vertex", "face"])?;
    let is_index_list = |(name, property): (&String, &ply_rs_bw::ply::PropertyDef)| {
        is_indices(name) && matches!(&property.data_type, PropertyType::List(_, item) if is_integer(item))
    };
    if header.elements["face"].properties.iter().filter(|&p| is_index_list(p)).count() != 1 {
        return Err(invalid(name, "face needs one integer list vertex_indices (or vertex_index)"));
    }
    let mut found = Found::default();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => body.read_vertices(element, &mut found)?,
            "face" => body.read_faces(element, header.elements["vertex"].count, &mut found)?,
            _ => body.read_rows(element, |_| Ok(()))?,
        }
    }
    if found.mesh.triangles.is_empty() {
        return Err(invalid(name, "no faces"));
    }
    let end = u32::try_from(found.mesh.triangles.len()).map_err(|_| Error::Limit(Fault::new("more than 2^32 triangles").in_file(name)))?;
    found.mesh.parts = vec![MeshPart { triangles: 0..end, ..MeshPart::default() }];
    if body.has_more().map_err(|e| Error::io(name, e))? {
        found.warnings.push(format!("{name}: data after the last element ignored"));
    }
    Ok(found)
}

/// Reads the header of a PLY file, and returns it with the data after it.
///
/// - `needed`: elements that the file must have; `vertex` is one of them
///
/// # Errors
/// Those of [`read`] about the header.
pub(super) fn opened<'a>(source: &'a mut dyn Source, name: &'a str, needed: &[&str]) -> Result<(Header, Body<'a>)> {
    let size = source.seek(SeekFrom::End(0)).and_then(|size| source.rewind().map(|()| size)).map_err(|e| Error::io(name, e))?;
    let text = header_text(source, name)?;
    let header = header(&text, name)?;
    check_header(&header, needed, size.saturating_sub(text.len() as u64), name)?;
    let line = text.iter().filter(|&&b| b == b'\n').count();
    let body = Body { source, name, encoding: header.encoding, line, row_text: Vec::new(), parser: Parser::new() };
    Ok((header, body))
}

/// Reads the bytes up to and including the line `end_header`.
fn header_text(source: &mut dyn Source, name: &str) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    let mut source = source.take(MAX_HEADER);
    loop {
        let start = text.len();
        if source.read_until(b'\n', &mut text).map_err(|e| Error::io(name, e))? == 0 {
            let is_ply = text.starts_with(b"ply");
            let message = if is_ply { "the header has no line \"end_header\"" } else { "not a PLY file: its first line is not \"ply\"" };
            return Err(invalid(name, message));
        }
        if text[start..].trim_ascii() == b"end_header" {
            return Ok(text);
        }
    }
}

/// Parses the header. Duplicate names are refused, because ply-rs-bw would keep only the last and misread the data.
fn header(text: &[u8], name: &str) -> Result<Header> {
    let text = String::from_utf8_lossy(text);
    let fault = |line: usize, message: String| Error::invalid(Fault::new(message).in_file(name).at_line(line));
    let mut seen: Vec<(&str, Vec<&str>)> = Vec::new();
    for (line, words) in text.lines().enumerate().map(|(i, line)| (i + 1, line.split_ascii_whitespace().collect::<Vec<_>>())) {
        let twice = match words[..] {
            ["element", element, ..] => {
                let twice = seen.iter().any(|known| known.0 == element);
                seen.push((element, Vec::new()));
                twice
            }
            ["property", .., property] => seen.last_mut().is_some_and(|(_, known)| {
                let twice = known.contains(&property);
                known.push(property);
                twice
            }),
            _ => false,
        };
        if twice {
            return Err(fault(line, format!("{} {} comes twice", words[0], words[words.len() - 1])));
        }
    }
    let parsed = Parser::<Row>::new().read_header(&mut Reader::new(text.as_bytes()));
    parsed.map_err(|e| match e.line() {
        Some(line) => fault(line, format!("not a PLY header line: {}", text.lines().nth(line - 1).unwrap_or_default().trim_end())),
        None => invalid(name, sentence(&e)),
    })
}

/// Checks that the header has the elements that are needed, and positions, and that its counts are possible in `size` bytes.
fn check_header(header: &Header, needed: &[&str], size: u64, name: &str) -> Result<()> {
    for &element in needed {
        let count = header.elements.get(element).ok_or_else(|| invalid(name, format!("no element {element}")))?.count;
        if u32::try_from(count).is_err() {
            return Err(Error::Limit(Fault::new(format!("{count} {element} elements, at most 2^32 - 1 are possible")).in_file(name)));
        }
    }
    let missing = slots(&header.elements["vertex"]).into_iter().zip(["x", "y", "z"]).find(|(has, _)| !has);
    if let Some((_, axis)) = missing {
        return Err(invalid(name, format!("vertex has no property {axis}")));
    }
    let mut least = 0;
    for element in header.elements.values() {
        least += element.count as u128 * smallest_row(element, header.encoding, name)?;
    }
    // The last ascii value needs no separator.
    if least > u128::from(size) + u128::from(header.encoding == Encoding::Ascii) {
        let promised: Vec<_> = header.elements.values().map(|e| format!("{} {}", e.count, e.name)).collect();
        let message = format!("the header promises {} elements, at least {least} bytes, but {size} follow", promised.join(", "));
        return Err(invalid(name, message));
    }
    Ok(())
}

/// The smallest size of one row of an element, in bytes: with empty lists, and in ASCII with one digit and one separator per value.
fn smallest_row(element: &ElementDef, encoding: Encoding, name: &str) -> Result<u128> {
    if element.properties.is_empty() && element.count > 0 {
        return Err(invalid(name, format!("element {} has no properties", element.name)));
    }
    let mut bytes = 0;
    for (property, definition) in &element.properties {
        let scalar = match &definition.data_type {
            PropertyType::List(count, _) if !is_integer(count) => {
                return Err(invalid(name, format!("the length of list {property} is no integer")));
            }
            PropertyType::List(scalar, _) | PropertyType::Scalar(scalar) => scalar,
        };
        bytes += if encoding == Encoding::Ascii { 2 } else { size_of_scalar(scalar) };
    }
    Ok(bytes)
}

fn is_integer(scalar: &ScalarType) -> bool {
    !matches!(scalar, ScalarType::Float | ScalarType::Double)
}

fn size_of_scalar(scalar: &ScalarType) -> u128 {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The data after the header, which is read row by row.
pub(super) struct Body<'a> {
    source: &'a mut dyn Source,
    name: &'a str,
    encoding: Encoding,
    /// The number of the line that was read last (ASCII only).
    line: usize,
    row_text: Vec<u8>,
    parser: Parser<Row>,
}

impl Body<'_> {
    fn read_vertices(&mut self, element: &ElementDef, found: &mut Found) -> Result<()> {
        let has = slots(element);
        let (has_normals, has_uvs, has_colors) = (has[3..6] == [true; 3], has[6..8] == [true; 2], has[8..11] == [true; 3]);
        let (full, has_alpha) = (full_channel(element), has[11]);
        found.mesh.positions.reserve_exact(element.count);
        self.read_rows(element, |row| {
            let used = row.numbers.iter().zip(["x", "y", "z", "nx", "ny", "nz", "u", "v"]).enumerate();
            // A normal that is not finite is no error: `directionless` counts it.
            let mut wrong = used.filter(|(i, (number, _))| !number.is_finite() && (*i < 3 || (*i > 5 && has_uvs)));
            if let Some((_, (number, slot))) = wrong.next() {
                return Err(format!("{slot} is not a finite f32 ({number})"));
            }
            found.mesh.positions.push(Vec3::from(row.position()));
            if has_uvs {
                found.mesh.uvs.push(Vec2::from(row.uv()));
            }
            if has_colors {
                let [r, g, b, a] = row.color();
                found.mesh.colors.push(linear_color([r, g, b, if has_alpha { a } else { full.unwrap_or(1.0) }], full));
            }
            if has_normals {
                let normal = Vec3::from(row.normal());
                let has_direction = normal.is_finite() && normal != Vec3::ZERO;
                found.directionless += usize::from(!has_direction);
                found.mesh.normals.push(if has_direction { normal } else { Vec3::ZERO });
            }
            Ok(())
        })
    }

    /// Reads the faces. n corners make a fan of n − 2 triangles.
    fn read_faces(&mut self, element: &ElementDef, vertices: usize, found: &mut Found) -> Result<()> {
        let triangles = &mut found.mesh.triangles;
        triangles.reserve_exact(element.count);
        self.read_rows(element, |row| {
            if let Some(index) = row.indices().find(|&i| !usize::try_from(i).is_ok_and(|i| i < vertices)) {
                return Err(format!("vertex index {index}, but there are {vertices} vertices"));
            }
            let mut corners = row.indices().map(|i| i as u32);
            let (count, first, second) = (corners.len(), corners.next(), corners.next());
            let (Some(first), Some(mut previous), true) = (first, second, count > 2) else {
                return Err(format!("{count} corners, at least 3 are needed"));
            };
            for corner in corners {
                triangles.push([first, previous, corner]);
                previous = corner;
            }
            Ok(())
        })
    }

    /// Passes each row of an element to `take`, and adds the position in the file to its error message.
    pub(super) fn read_rows(&mut self, element: &ElementDef, mut take: impl FnMut(Row) -> Result<(), String>) -> Result<()> {
        for i in 0..element.count {
            let row = match self.encoding {
                Encoding::Ascii => self.read_line(element, i)?,
                Encoding::BinaryLittleEndian => {
                    self.parser.read_little_endian_element(&mut self.source, element).map_err(|e| self.binary_error(e, element, i))?
                }
                Encoding::BinaryBigEndian => {
                    self.parser.read_big_endian_element(&mut self.source, element).map_err(|e| self.binary_error(e, element, i))?
                }
            };
            take(row).map_err(|message| self.fault(element, i, message))?;
        }
        Ok(())
    }

    /// Reads the next line that is not blank.
    fn read_line(&mut self, element: &ElementDef, i: usize) -> Result<Row> {
        loop {
            self.row_text.clear();
            self.line += 1;
            if self.source.read_until(b'\n', &mut self.row_text).map_err(|e| Error::io(self.name, e))? == 0 {
                return Err(invalid(self.name, format!("the file ends after {i} of {} {} elements", element.count, element.name)));
            }
            if !self.row_text.trim_ascii().is_empty() {
                break;
            }
        }
        let line = String::from_utf8_lossy(&self.row_text);
        Row::from_line(&line, element).map_err(|message| self.fault(element, i, message))
    }

    fn binary_error(&self, error: ParseError, element: &ElementDef, i: usize) -> Error {
        match error.kind() {
            ErrorKind::UnexpectedEof => {
                invalid(self.name, format!("the file ends within {} {i}, {} were promised", element.name, element.count))
            }
            ErrorKind::InvalidInput | ErrorKind::InvalidData => self.fault(element, i, sentence(&error)),
            _ => Error::io(self.name, error.into()),
        }
    }

    fn fault(&self, element: &ElementDef, i: usize, message: String) -> Error {
        let fault = Fault::new(format!("{} {i}: {message}", element.name)).in_file(self.name);
        Error::invalid(if self.encoding == Encoding::Ascii { fault.at_line(self.line) } else { fault })
    }

    pub(super) fn has_more(&mut self) -> io::Result<bool> {
        let rest = self.source.fill_buf()?;
        Ok(if self.encoding == Encoding::Ascii { !rest.trim_ascii().is_empty() } else { !rest.is_empty() })
    }
}

/// Converts a colour of the file to linear values from 0 to 1. Values beyond are clamped; a colour with NaN becomes 0.
///
/// - `full`: the value that [`full_channel`] returns
fn linear_color([r, g, b, a]: [f32; 4], full: Option<f32>) -> Vec4 {
    let share = |x: f32| f64::from(x / full.unwrap_or(1.0)).clamp(0.0, 1.0);
    let linear = |x: f32| if full.is_some() { decoded(share(x)) } else { share(x) };
    let color = Vec4::from([linear(r), linear(g), linear(b), share(a)].map(|x| x as f32));
    if color.is_nan() { Vec4::ZERO } else { color }
}

/// The first line of the parser's message, in lower case.
fn sentence(error: &ParseError) -> String {
    error.to_string().lines().next().unwrap_or_default().trim_end_matches('.').to_lowercase()
}
