//! The line-numbered check of an OBJ file: only triangles' statements that are right pass on, as a text of their own.
//!
//! tobj parses OBJ well but says no line, takes `nan`, `1e39`, two-vertex faces and polylines as faces, loses material
//! names without their library, refuses line continuations, and misaligns normals where some faces have none. So its
//! input is this: `v x y z`, `vt u v`, `vn x y z` and `f`, each checked, names and groups kept here.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Write};

use super::token::{finite, name, number, shown};
use crate::shape::mesh_data::MeshPart;
use crate::{Fault, MAX_FAULTS};

/// A statement longer than this is no OBJ (a million-gon needs 24 MB).
const MAX_STATEMENT: u64 = 1 << 28;

/// So much text passes at once.
const BLOCK: usize = 1 << 15;

/// So many kinds of unknown statements are told apart.
const MAX_NAMED: usize = 8;

/// The kinds of indices in a corner `vertex/texture coordinate/normal`.
const KINDS: [(&str, &str); 3] = [("vertex", "vertices"), ("texture coordinate", "texture coordinates"), ("normal", "normals")];

/// Reads as the checked text; what else it saw is in its fields.
pub struct Checked<'a, R> {
    source: R,
    name: &'a str,
    /// Give every corner a texture coordinate and a normal: index 1 of each is then zero, for those without.
    padded: bool,
    statement: Vec<u8>,
    passed: Vec<u8>,
    served: usize,
    /// The lines on which this statement and the next begin.
    line: usize,
    next_line: usize,
    /// Vertices, texture coordinates and normals so far.
    counts: [u64; 3],
    group: Option<String>,
    material: Option<String>,
    pub faults: Vec<Fault>,
    /// Reading failed; the text ended there.
    pub failure: Option<io::Error>,
    pub parts: Vec<MeshPart>,
    pub triangles: u64,
    pub faces: u64,
    /// Faces that have texture coordinates, and normals.
    pub faces_with: [u64; 2],
    /// Normals without direction; zeros pass on for them.
    pub directionless: usize,
    /// Statements that draw no triangles, with how often they came.
    pub ignored: BTreeMap<String, usize>,
}

impl<'a, R: BufRead> Checked<'a, R> {
    pub fn new(source: R, name: &'a str, padded: bool) -> Self {
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

    /// Some faces have texture coordinates or normals and some have not: tobj would misalign them.
    pub fn is_mixed(&self) -> bool {
        self.faces_with.iter().any(|&with| with != 0 && with != self.faces)
    }

    /// Checks statements until a block of them has passed, or the file ends, or the patience.
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

    /// Reads one statement, joining lines that end in a backslash (comments never continue); false at the end.
    fn read_statement(&mut self, statement: &mut Vec<u8>) -> io::Result<bool> {
        statement.clear();
        self.line = self.next_line;
        loop {
            let room = (MAX_STATEMENT + 1).saturating_sub(statement.len() as u64);
            let read = self.source.by_ref().take(room).read_until(b'\n', statement)?;
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

    /// Checks one statement, and passes it on or remembers it.
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
            // Smoothing groups: the normals of the file say it already.
            "" | "s" | "mtllib" => {}
            comment if comment.starts_with('#') => {}
            _ if self.ignored.len() < MAX_NAMED => *self.ignored.entry(shown(keyword)).or_default() += 1,
            _ => *self.ignored.entry("others".to_string()).or_default() += 1,
        }
        Ok(())
    }

    /// `v x y z`, and ignored: the weight `w` of curves, or a colour.
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

    /// `vt u`, `vt u v` or `vt u v w`; v is 0 where it is missing, w is ignored.
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

    /// `vn x y z`; one without direction (zero, nan, `-1.#IND`) becomes zero, that is flat.
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

    /// `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`, all alike; n corners make a fan of n − 2 triangles.
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
                // Index 1 is the zero, so that the file's own begin at 2.
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

    /// The indices of a corner, from 1 and known to exist.
    fn corner(&self, word: &str) -> Result<[Option<u64>; 3], String> {
        let mut corner = [None; 3];
        let mut rest = Some(word);
        for (kind, index) in corner.iter_mut().enumerate() {
            let Some(fields) = rest else { break };
            // A plain loop: `split` is made for longer texts, and this is half of the time of a large file.
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

    /// From 1 forwards, from −1 backwards; only what stands above can be named.
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
        // Three corners each must stay countable in u32, for tobj and for the mesh.
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

impl<R: BufRead> Read for Checked<'_, R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Checked<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.served == self.passed.len() {
            // tobj would forget which error it was.
            self.advance().unwrap_or_else(|error| self.failure = Some(error));
        }
        Ok(&self.passed[self.served..])
    }

    fn consume(&mut self, count: usize) {
        self.served += count;
    }
}

/// Up to a word that begins with `#` (names are not asked: they may contain it, as `-1.#IND` does).
fn without_comment(numbers: &str) -> &str {
    let is_comment = |&at: &usize| numbers[..at].ends_with(|c: char| c.is_ascii_whitespace());
    let end = numbers.match_indices('#').map(|(at, _)| at).find(is_comment);
    &numbers[..end.unwrap_or(numbers.len())]
}
