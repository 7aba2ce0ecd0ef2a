//! MTL: the materials of a library, read line by line. (The reader of the crate tobj reports no lines and does not know `Ke`.)

use std::collections::BTreeMap;
use std::path::Path;

use super::ImportContext;
use crate::error::{Error, Fault, Result};

/// A material as the library has it; `None` stands for a missing statement.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Entry {
    /// `Kd`.
    pub diffuse: Option<[f64; 3]>,
    /// `Ks`.
    pub specular: [f64; 3],
    /// `Ns`.
    pub exponent: f64,
    /// `Ke`: W·m⁻²·sr⁻¹.
    pub emission: [f64; 3],
    /// Opacity: `d`, or 1 − `Tr`.
    pub opacity: Option<f64>,
    /// Index of refraction, `Ni`.
    pub eta: Option<f64>,
    /// Transmission filter, `Tf`.
    pub filter: Option<[f64; 3]>,
    /// `illum`, the model of illumination.
    pub illum: u32,
    /// Roughness, `Pr`.
    pub roughness: Option<f64>,
    /// Metalness, `Pm`.
    pub metallic: Option<f64>,
    /// Map of the diffuse colour, `map_Kd`: a file, as the scene names it.
    pub diffuse_map: Option<String>,
    /// Map of the opacity, `map_d`: a file.
    pub opacity_map: Option<String>,
    /// Normal map, `norm`: a file.
    pub normal_map: Option<String>,
}

impl Entry {
    /// Returns whether the material emits light.
    pub fn emits(&self) -> bool {
        self.emission.iter().any(|e| *e > 0.0)
    }
}

/// Words that each option of a map takes. `-s u v w`, of which the last two may be missing, is recognised by its numbers.
const OPTIONS: &[&str] = &["-blendu", "-blendv", "-bm", "-boost", "-cc", "-clamp", "-imfchan", "-mm", "-o", "-s", "-t", "-texres", "-type"];

/// Reads a library.
///
/// - `file`: its name in the scene; its maps lie beside it
///
/// # Errors
/// `Invalid`: a value that is not a number, with its line.
pub fn read(bytes: &[u8], file: &str, context: &ImportContext) -> Result<BTreeMap<String, Entry>> {
    let text = String::from_utf8_lossy(bytes);
    let mut entries: BTreeMap<String, Entry> = BTreeMap::new();
    let mut current: Option<(String, Entry)> = None;
    for (i, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let at = |message: String| Fault::new(message).in_file(file).at_line(i + 1);
        if keyword == "newmtl" {
            entries.extend(current.replace((rest.trim().to_owned(), Entry::default())));
        } else if let Some((_, entry)) = &mut current {
            match entry.take(keyword, rest.trim(), file).map_err(|message| Error::invalid(at(message)))? {
                Taken::Known => {}
                Taken::Option(option) => context.note(at(format!("{keyword}: the option {option} is left out"))),
                Taken::Unknown => context.note(at(format!("{keyword} is left out"))),
            }
        }
    }
    entries.extend(current);
    Ok(entries)
}

enum Taken {
    Known,
    Unknown,
    /// A map is used, but this option is ignored.
    Option(String),
}

impl Entry {
    fn take(&mut self, keyword: &str, rest: &str, file: &str) -> Result<Taken, String> {
        match keyword {
            "Kd" => self.diffuse = Some(color(rest)?),
            "Ks" => self.specular = color(rest)?,
            "Ke" => self.emission = color(rest)?,
            "Tf" => self.filter = Some(color(rest)?),
            "Ns" => self.exponent = number(rest)?,
            "Ni" => self.eta = Some(number(rest)?),
            "d" => self.opacity = Some(number(rest.trim_start_matches("-halo").trim())?),
            "Tr" => self.opacity = Some(1.0 - number(rest)?),
            "Pr" => self.roughness = Some(number(rest)?),
            "Pm" => self.metallic = Some(number(rest)?),
            "illum" => self.illum = number(rest)? as u32,
            "map_Kd" => return Ok(map(rest, file, &mut self.diffuse_map)),
            "map_d" => return Ok(map(rest, file, &mut self.opacity_map)),
            "norm" => return Ok(map(rest, file, &mut self.normal_map)),
            // Factor of ambient light. Here indirect light is computed instead.
            "" | "Ka" => {}
            comment if comment.starts_with('#') => {}
            _ => return Ok(Taken::Unknown),
        }
        Ok(Taken::Known)
    }
}

fn number(text: &str) -> Result<f64, String> {
    let word = text.split_whitespace().next().unwrap_or_default();
    word.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0).ok_or_else(|| {
        let shown: String = word.chars().filter(|c| !c.is_control()).take(40).collect();
        format!("expected a number of at least 0, found {shown:?}")
    })
}

/// Three numbers, or one for a grey.
fn color(text: &str) -> Result<[f64; 3], String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    match words.as_slice() {
        ["spectral" | "xyz", ..] => Err(format!("expected red, green and blue, found {:?}", words[0])),
        [_, _, _, ..] => Ok([number(words[0])?, number(words[1])?, number(words[2])?]),
        _ => Ok([number(text)?; 3]),
    }
}

/// File name, which may contain spaces, after options.
fn map(rest: &str, file: &str, slot: &mut Option<String>) -> Taken {
    let mut name = rest;
    let mut left_out = None;
    while let Some((option, after)) = name.split_once(char::is_whitespace).filter(|(word, _)| OPTIONS.contains(word)) {
        left_out.get_or_insert_with(|| option.to_owned());
        name = after.trim_start();
        // Values of an option: words such as `on`, or numbers.
        while let Some((_, more)) = name.split_once(char::is_whitespace).filter(|(word, _)| is_value(word)) {
            name = more.trim_start();
        }
    }
    let folder = Path::new(file).parent().and_then(Path::to_str).filter(|folder| !folder.is_empty());
    let name = name.replace('\\', "/");
    *slot = Some(folder.map_or_else(|| name.clone(), |folder| format!("{folder}/{name}")));
    left_out.map_or(Taken::Known, Taken::Option)
}

fn is_value(word: &str) -> bool {
    word.parse::<f64>().is_ok() || matches!(word, "on" | "off" | "r" | "g" | "b" | "m" | "l" | "z" | "sphere")
}
