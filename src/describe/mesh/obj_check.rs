//! Checks an OBJ file statement by statement, and passes on a text that has only correct statements for triangles.
//!
//! tobj gives no line numbers, accepts `nan`, `1e39`, faces of two vertices and polylines as faces, loses material names
//! without their library, refuses line continuations, and misaligns normals where some faces have none. Its input is therefore
//! reduced to checked statements `v x y z`, `vt u v`, `vn x y z` and `f`; names and groups are kept here.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Write};

use super::Source;
use super::token::{finite, name, number, shown};
use crate::shape::mesh_data::MeshPart;
use crate::{Fault, MAX_FAULTS};

/// The longest statement of an OBJ file, in bytes. (A polygon of a million corners needs 24 MB.)
const MAX_STATEMENT: u64 = 1 << 28;

/// The amount of text that is passed on at once, in bytes.
const BLOCK: usize = 1 << 15;

/// The largest number of kinds of unknown statements that the warning names.
const MAX_NAMED: usize = 8;

/// The kinds of indices in a corner `vertex/texture coordinate/normal`.
const KINDS: [(&str, &str); 3] = [("vertex", "vertices"), ("texture coordinate", "texture coordinates"), ("normal", "normals")];

/// A reader that yields the checked text. Its fields have what else the file contains.
pub struct Checked<'a> {
    source: &'a mut dyn Source,
    name: &'a str,
    /// Whether every corner gets a texture coordinate and a normal. Index 1 of each is then zero, for corners without.
    padded: bool,
    statement: Vec<u8>,
    passed: Vec<u8>,
    served: usize,
    /// The number of the line on which the current statement begins.
    line: usize,
    /// The number of the line on which the next statement begins.
    next_line: usize,
    /// The numbers of vertices, texture coordinates and normals so far.
    counts: [u64; 3],
    group: Option<String>,
    material: Option<String>,
    /// The faults so far, each with its line.
    pub faults: Vec<Fault>,
    /// The error at which reading failed and the text ended, if it did.
    pub failure: Option<io::Error>,
    /// The parts of the mesh so far, by group and material name.
    pub parts: Vec<MeshPart>,
    /// The number of triangles so far.
    pub triangles: u64,
    /// The number of faces so far.
    pub faces: u64,
    /// The number of faces that have texture coordinates, and of those that have normals.
    pub faces_with: [u64; 2],
    /// The number of normals without a direction. Zeros are passed on for them.
    pub directionless: usize,
    /// The keywords of ignored statements, with the number of each.
    pub ignored: BTreeMap<String, usize>,
}

impl<'a> Checked<'a> {
    /// Starts reading a source; `name` is the file's name for messages.
    pub fn new(source: &'a mut dyn Source, name: &'a str, padded: bool) -> Self {
        let passed = if padded { b"vt 0 0\nvn 0 0 0\n".to_vec() } else { Vec::new() };
        Checked {
            source,
            name,
            padded,
            statement: Vec::new(),
            passed,
            served: 0,
            line: 0,
            next_line: 1,
            counts: [0; 3],
            group: None,
            material: None,
            faults: Vec::new(),
            failure: None,
            parts: Vec::new(),
            triangles: 0,
            faces: 0,
            faces_with: [0; 2],
            directionless: 0,
            ignored: BTreeMap::new(),
        }
    }

    /// Whether some faces have texture coordinates or normals and others do not. tobj would misalign them.
    pub fn is_mixed(&self) -> bool {
        self.faces_with.iter().any(|&with| with != 0 && with != self.faces)
    }

    /// Checks statements until a block of text is ready, the file ends, or there are [`MAX_FAULTS`] faults.
    fn advance(&mut self) -> io::Result<()> {
        let mut statement = std::mem::take(&mut self.statement);
        self.passed.clear();
        self.served = 0;
        while self.passed.len() < BLOCK && self.faults.len() < MAX_FAULTS && self.read_statement(&mut statement)? {
            let passed = self.passed.len();
            let text = str::from_utf8(&statement).map_or_else(|_| String::from_utf8_lossy(&statement), Cow::Borrowed);
            if let Err(message) = self.check(&text) {
                self.faults.push(Fault::new(message).in_file(self.name).at_line(self.line));
            }
            if !self.faults.is_empty() {
                self.passed.truncate(passed);
            }
        }
        self.statement = statement;
        Ok(())
    }

    /// Reads one statement, joining lines that end in a backslash (comments never continue). Returns false at the end of the file.
    fn read_statement(&mut self, statement: &mut Vec<u8>) -> io::Result<bool> {
        statement.clear();
        self.line = self.next_line;
        loop {
            let room = (MAX_STATEMENT + 1).saturating_sub(statement.len() as u64);
            let read = (&mut *self.source).take(room).read_until(b'\n', statement)?;
            if statement.len() as u64 > MAX_STATEMENT {
                self.faults = vec![Fault::new("a line of more than 256 MiB").in_file(self.name).at_line(self.line)];
                return Ok(false);
            }
            self.next_line += 1;
            let text = statement.trim_ascii_end();
            let continues = text.ends_with(b"\\") && !text.trim_ascii_start().starts_with(b"#");
            if read == 0 || !continues {
                return Ok(!statement.is_empty());
            }
            let joined = text.len() - 1;
            statement.truncate(joined);
            statement.push(b' ');
        }
    }

    /// Checks one statement and passes it on, or keeps the name that it sets.
    fn check(&mut self, statement: &str) -> Result<(), String> {
        let statement = statement.trim_start_matches(|c: char| c.is_ascii_whitespace() || (c == '\u{feff}' && self.line == 1));
        let keyword = statement.split_ascii_whitespace().next().unwrap_or_default();
        let numbers = || without_comment(&statement[keyword.len()..]);
        let name = || Some(name(statement[keyword.len()..].trim_ascii())).filter(|s| !s.is_empty());
        match keyword {
            "v" => return self.vertex(numbers().split_ascii_whitespace()),
            "vt" => return self.texture_coordinate(numbers().split_ascii_whitespace()),
            "vn" => return self.normal(numbers().split_ascii_whitespace()),
            "f" => return self.face(numbers()),
            "g" | "o" => self.group = name(),
            "usemtl" => self.material = name(),
            // Smoothing groups are not needed: the file has normals where it is smooth.
            "" | "s" | "mtllib" => {}
            comment if comment.starts_with('#') => {}
            _ if self.ignored.len() < MAX_NAMED => *self.ignored.entry(shown(keyword)).or_default() += 1,
            _ => *self.ignored.entry("others".to_string()).or_default() += 1,
        }
        Ok(())
    }

    /// Checks `v x y z`. Further numbers, the weight `w` of curves or a colour, are ignored.
    fn vertex<'w>(&mut self, mut words: impl Iterator<Item = &'w str>) -> Result<(), String> {
        self.counts[0] += 1;
        self.passed.push(b'v');
        for axis in ["x", "y", "z"] {
            let word = words.next().ok_or_else(|| format!("a vertex needs x, y and z, but {axis} is missing"))?;
            finite(word).map_err(|why| format!("{axis}: {why}"))?;
            self.pass(" ", word);
        }
        words.try_for_each(|word| finite(word).map(drop))?;
        self.passed.push(b'\n');
        Ok(())
    }

    /// Checks `vt u`, `vt u v` or `vt u v w`. A missing v is 0, w is ignored.
    fn texture_coordinate<'w>(&mut self, mut words: impl Iterator<Item = &'w str>) -> Result<(), String> {
        self.counts[1] += 1;
        let u = words.next().ok_or("a texture coordinate needs u")?;
        let v = words.next().unwrap_or("0");
        for (axis, word) in [("u", u), ("v", v)] {
            finite(word).map_err(|why| format!("{axis}: {why}"))?;
        }
        self.pass("vt ", u);
        self.pass(" ", v);
        self.passed.push(b'\n');
        Ok(())
    }

    /// Checks `vn x y z`. A normal without a direction (zero, nan, `-1.#IND`) becomes zero, and the triangle flat.
    fn normal<'w>(&mut self, mut words: impl Iterator<Item = &'w str>) -> Result<(), String> {
        self.counts[2] += 1;
        let mut normal = [("", 0.0); 3];
        for (axis, entry) in ["x", "y", "z"].into_iter().zip(&mut normal) {
            let word = words.next().ok_or_else(|| format!("a normal needs x, y and z, but {axis} is missing"))?;
            *entry = (word, number(word).map_err(|why| format!("{axis}: {why}"))?);
        }
        let has_direction = normal.iter().all(|n| n.1.is_finite()) && normal.iter().any(|n| n.1 != 0.0);
        self.directionless += usize::from(!has_direction);
        self.passed.extend_from_slice(b"vn");
        normal.iter().for_each(|n| self.pass(" ", if has_direction { n.0 } else { "0" }));
        self.passed.push(b'\n');
        Ok(())
    }

    /// Checks `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`, all of the same form. n corners make a fan of n − 2 triangles.
    fn face(&mut self, numbers: &str) -> Result<(), String> {
        let mut corners = 0_u64;
        let mut has = [false; 2];
        self.passed.push(b'f');
        for word in numbers.split_ascii_whitespace() {
            let [vertex, uv, normal] = self.corner(word)?;
            if corners > 0 && has != [uv.is_some(), normal.is_some()] {
                return Err(format!("corner {} is written {}, unlike those before it", corners + 1, shown(word)));
            }
            (has, corners) = ([uv.is_some(), normal.is_some()], corners + 1);
            if self.padded {
                // Index 1 is the zero of the padding, so that the file's own begin at 2.
                let [vertex, uv, normal] = [vertex.unwrap_or(1), uv.map_or(1, |i| i + 1), normal.map_or(1, |i| i + 1)];
                write!(self.passed, " {vertex}/{uv}/{normal}").map_err(|e| e.to_string())?;
            }
        }
        if !self.padded {
            self.pass(" ", numbers.trim_ascii());
        }
        self.passed.push(b'\n');
        if corners < 3 {
            return Err(format!("a face with {corners} corner{}, at least 3 are needed", if corners == 1 { "" } else { "s" }));
        }
        self.faces += 1;
        self.faces_with[0] += u64::from(has[0]);
        self.faces_with[1] += u64::from(has[1]);
        self.add_to_part(corners - 2)
    }

    /// Parses the indices of a corner. They count from 1 and are known to exist.
    fn corner(&self, word: &str) -> Result<[Option<u64>; 3], String> {
        let mut corner = [None; 3];
        let mut rest = Some(word);
        for (kind, index) in corner.iter_mut().enumerate() {
            let Some(fields) = rest else { break };
            // Half of the time for a large file is spent here, and `split` is slower on such short texts than this loop.
            let slash = fields.bytes().position(|b| b == b'/');
            let field = &fields[..slash.unwrap_or(fields.len())];
            rest = slash.map(|slash| &fields[slash + 1..]);
            if !field.is_empty() || kind == 0 {
                *index = Some(self.resolve(field, kind)?);
            }
        }
        match rest {
            None => Ok(corner),
            Some(_) => Err(format!("corner {} has more than vertex/texture coordinate/normal", shown(word))),
        }
    }

    /// Converts an index of the file, which counts from 1 forwards or from −1 backwards, to one that counts from 1. It may refer only to
    /// statements above.
    fn resolve(&self, field: &str, kind: usize) -> Result<u64, String> {
        let ((one, many), count) = (KINDS[kind], self.counts[kind]);
        let index: i64 = field.parse().map_err(|_| format!("expected a {one} index, found {}", shown(field)))?;
        let from_one = if index < 0 { (count + 1).checked_sub(index.unsigned_abs()) } else { Some(index as u64) };
        match from_one {
            Some(i) if (1..=count).contains(&i) => Ok(i),
            _ if index == 0 => Err(format!("{one} index 0, but indices count from 1 (or from -1 backwards)")),
            _ => Err(format!("{one} index {index}, but only {count} {many} so far")),
        }
    }

    fn add_to_part(&mut self, triangles: u64) -> Result<(), String> {
        self.triangles += triangles;
        // The number of corners, three for each triangle, must fit a u32 for tobj and for the mesh.
        let end = u32::try_from(self.triangles).ok().filter(|n| n.checked_mul(3).is_some());
        let end = end.ok_or("more than 2^32 corners")?;
        match self.parts.last_mut() {
            Some(part) if part.group == self.group && part.material == self.material => part.triangles.end = end,
            last => {
                let start = last.map_or(0, |part| part.triangles.end);
                self.parts.push(MeshPart { material: self.material.clone(), group: self.group.clone(), triangles: start..end });
            }
        }
        Ok(())
    }

    fn pass(&mut self, before: &str, word: &str) {
        self.passed.extend_from_slice(before.as_bytes());
        self.passed.extend_from_slice(word.as_bytes());
    }
}

impl Read for Checked<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Checked<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.served == self.passed.len() {
            // tobj would lose the error.
            self.advance().unwrap_or_else(|error| self.failure = Some(error));
        }
        Ok(&self.passed[self.served..])
    }

    fn consume(&mut self, count: usize) {
        self.served += count;
    }
}

/// The text before the first word that begins with `#`. A `#` within a word, as in `-1.#IND`, does not begin a comment.
fn without_comment(numbers: &str) -> &str {
    let is_comment = |&at: &usize| numbers[..at].ends_with(|c: char| c.is_ascii_whitespace());
    let end = numbers.match_indices('#').map(|(at, _)| at).find(is_comment);
    &numbers[..end.unwrap_or(numbers.len())]
}
